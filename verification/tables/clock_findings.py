"""Wrong clocks of measured uplift: how often they are found, and how often a right clock is refused.

python -m verification.tables.clock_findings [--pairs 20]

Passages. Simulated by the reference simulator, at 160 to 320 km/h, with one or two pantographs. The thresholds of
`clock_join` were chosen on the cases of CHOSEN, with other random numbers. Two of the cases of HELD_OUT had been seen
by a prototype, and a shorter run with the same seed came first; the thresholds did not change after it.

Measurement. One to four masts of the analysis section with 50 to 500 samples per second; white noise of 0.2 to 1 mm,
a slow wave of 2 mm, a zero error of up to 5 mm, a gain error of up to 5 % and steps of 0.1 mm. The file begins 2 to
20 s before the record, and ends as much later. The seed of a case is (50321, number of the case).

Conditions. `right, stated`: the stated offset is right to its uncertainty of 10 ms. `right, searched`: the join
`passage` with an error of up to 20 s of 30 s. The others are errors of a stated offset, and the passage of a train
that is 1 or 3 % faster, whose clock is searched: one pantograph at one mast cannot show it.
"""

import argparse
from collections import Counter
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from pantocheck.conformance.cases.catalogue import LIBRARY
from pantocheck.conformance.cases.library import load_entry
from pantocheck.conformance.records.clock_join import Clock
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.source_alignment import Alignment, SourceSamples, align_source, extend_train
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator

SEED = 50321
CHOSEN = (
    "en50318-2002/250",
    "en50318-2018/ac-simple/275-twin",
    "en50318-2018/ac-simple/320",
    "en50318-2018/ac-stitched/320",
    "generic/direct-current/160",
    "generic/twin-contact/200",
)
HELD_OUT = (
    "en50318-2002/300",
    "en50318-2018/ac-simple/275",
    "en50318-2018/ac-simple/320-twin",
    "en50318-2018/ac-stitched/275",
    "generic/two-strips",
)
STATED_S, SEARCHED_S, FASTER = 0.01, 30.0, (1.01, 1.03)


class Condition(NamedTuple):
    """State of the clock."""

    error: float = 0.0
    """Error of the stated offset [s]."""
    kind: str = "time"
    faster: float = 1.0
    """Speed of the train at the masts over that of the record."""


def list_conditions(record: Record, random: np.random.Generator) -> dict[str, Condition]:
    """Conditions of one pair of files."""
    sign = random.choice([-1.0, 1.0])
    late = {"1 s": 1.0, "0.36 s (100 ppm for an hour)": 0.36, "0.2 s": 0.2, "10 s": 10.0}
    found = {
        "right, stated": Condition(random.uniform(-STATED_S, STATED_S)),
        "right, searched": Condition(random.uniform(-20.0, 20.0), "passage"),
        **{f"wrong by {name}": Condition(sign * error) for name, error in late.items()},
    }
    if record.pantographs > 1:
        spacing = float(record.position[0, 0] - record.position[1, 0])
        found["wrong by one pantograph"] = Condition(sign * spacing / record.speed)
        for faster in FASTER:
            found[f"train {100 * (faster - 1):.0f} % faster, searched"] = Condition(0.0, "passage", faster)
    return found


def measure(record: Record, condition: Condition, random: np.random.Generator) -> SourceSamples:
    """Uplift at masts as it is measured; the true offset is 0."""
    start, end = record.evaluated
    supports, uplifts = record.support_position, record.support_uplift
    assert supports is not None
    assert uplifts is not None
    inside = np.flatnonzero((supports >= start - 0.5) & (supports <= end + 0.5))
    chosen = np.sort(random.choice(inside, size=random.integers(1, min(4, inside.size) + 1), replace=False))
    quiet, rate = random.uniform(2, 20), random.choice([50.0, 100.0, 200.0, 500.0])
    time = np.arange(record.time[0] - quiet, record.time[-1] + quiet, 1 / rate)
    noise, rows = random.uniform(2e-4, 1e-3), []
    middle = float(np.interp(supports[inside].mean(), record.position[0], record.time))
    for row in np.nan_to_num(uplifts[chosen]):
        passed = np.interp(middle + condition.faster * (time - middle), record.time, row, left=0.0, right=0.0)
        wander = 2e-3 * np.sin(2 * np.pi * time / random.uniform(5, 30) + random.uniform(0, 6))
        measured = random.uniform(0.95, 1.05) * passed + wander + random.uniform(-5e-3, 5e-3)
        rows.append(np.round(measured + random.normal(0, noise, time.size), 4))
    clock = Clock(condition.error, STATED_S if condition.kind == "time" else SEARCHED_S)
    return SourceSamples("mast", condition.kind, time, supports[chosen], np.array(rows), clock)


def run_case(name: str, number: int, pairs: int) -> Iterator[tuple[str, Alignment]]:
    """Conditions and alignments of the pairs of a case."""
    outcome = ReferenceSimulator().run_unrefined(load_entry(LIBRARY.find_id(name)))
    record = outcome.record
    train = extend_train(record.time, record.position, record.speed)
    random = np.random.default_rng((SEED, number))
    for _ in range(pairs):
        for condition, values in list_conditions(record, random).items():
            yield condition, align_source(measure(record, values, random), train)


def print_table(pairs: int) -> None:
    """Print the outcomes by condition, for the chosen and for the held-out cases."""
    print("| clock | cases | pairs | confirmed | named as wrong | no passage found | offset outside its uncertainty |")
    print("| :-- | :-- | --: | --: | --: | --: | --: |")
    for label, names in (("chosen", CHOSEN), ("held out", HELD_OUT)):
        states: dict[str, Counter[str]] = {}
        for number, name in enumerate(names):
            for condition, found in run_case(name, number + len(CHOSEN) * (label == "held out"), pairs):
                counter = states.setdefault(condition, Counter())
                counter.update([found.state])
                confirmed = found.state == "confirmed"
                counter["outside"] += confirmed and abs(found.clock.offset) > found.clock.uncertainty
        for condition, counter in states.items():
            total = sum(counter[state] for state in ("confirmed", "contradicted", "unconfirmed"))
            counts = (counter[state] for state in ("confirmed", "contradicted", "unconfirmed", "outside"))
            print(f"| {condition} | {label} | {total} | {' | '.join(map(str, counts))} |")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=20, help="pairs of files of each case")
    print_table(parser.parse_args().pairs)

"""Planted defects of measured lines: found, missed and false alarms of `runs assess`.

python -m verification.tables.network_detection [--seed 1] [--segments 12] [--out DIR]

With --out, simulated segments are kept and used again.

Lines. The reference simulator passes the line AC simple at 275 km/h over segments of 40 spans (2.2 km), which are
joined to one line. Every segment has its own irregularity of the contact wire (density 1e-5, 1e-6 and 1e-8 m3 at 0.02,
0.1 and 0.5 1/m) and dropper lengths (uniform within 3 mm). Every third segment has no defect. The others have, in
turn: one dropper 12 mm too long, which carries almost nothing; a mass of 8 kg on the contact wire (hard spot); all
droppers of one span 30 mm too long (soft spot); a tension of the contact wire that is 20 % too low in all spans.

Runs. Four dates. Every run has noise of 2 N, a gain error of up to 1 % and a zero error of up to 1 N. In addition: the
second run has a zero that drifts to -25 N, the third one a gap of 0.4 s without force, and the fourth one holds every
second sample (half rate).

Counts. A defect of a place is found if a place is listed within 60 m, a tension if half of its sections are listed
with an unusual standard deviation, a zero if two passages of its run have an unusual mean, a gap if its section has
no value, a half rate if the import remarks it. Other places, sections and runs are false alarms.
"""

import argparse
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np
import tomli_w

from pantocheck.conformance.cases.catalogue import LIBRARY
from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.cases.library import load_entry
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.measured_table import MeasuredTable, TableColumn
from pantocheck.conformance.core.parquet_table import write_parquet_table
from pantocheck.conformance.network.network_assessment import AssessmentTask, assess_network
from pantocheck.conformance.network.run_collection import import_files, list_refused, list_runs, open_collection
from pantocheck.conformance.results.network_format import NetworkResults
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator

CASE, SPEED_KM_H = "en50318-2018/ac-simple/275", 275.0
SPAN_M, FIRST, SPANS, BEHIND, DROPPERS = 55.0, 13, 40, 8, 9
LENGTH_KM = SPANS * SPAN_M / 1000
RATE, STEP_M = 500.0, 0.05
LINE_DEFECTS = ("dropper", "hard spot", "soft spot", "tension")
RUN_DEFECTS = ("none", "drifting zero", "gap", "half rate")
ZERO_KM = 11.0
NEAR_KM = 0.06

Truth = list[tuple[str, float]]
"""Kind and kilometre of each planted defect of the line."""


def choose_defect(number: int) -> str:
    """Defect of a segment."""
    return "none" if number % 3 == 2 else LINE_DEFECTS[(number - number // 3) % len(LINE_DEFECTS)]


def simulate_segment(number: int, random: np.random.Generator) -> tuple[RealArray, float]:
    """Unfiltered force of one segment every `STEP_M`, and the distance of its defect from its start [km]."""
    kind, spans = choose_defect(number), FIRST + SPANS + BEHIND
    span = int(random.integers(FIRST + 4, FIRST + SPANS - 6))
    lengths = random.uniform(-0.003, 0.003, (spans, DROPPERS))
    place = span * SPAN_M + SPAN_M / 2
    changes = [
        f"line.geometry.spans={spans}",
        f"evaluated_spans=[{FIRST}, {FIRST + SPANS - 1}]",
        f"compared_spans=[{FIRST - 2}, {FIRST + SPANS - 1}]",
        f"line.contact_wire.irregularity={{frequency_1_m=[0.02, 0.1, 0.5], density_m3=[1e-5, 1e-6, 1e-8], "
        f"seed={random.integers(2**31)}}}",
    ]
    if kind == "dropper":
        dropper = int(random.integers(2, DROPPERS - 2))
        lengths[span, dropper] += 0.012
        place = span * SPAN_M + 4.5 + 5.75 * dropper
    elif kind == "soft spot":
        lengths[span] += 0.03
    elif kind == "hard spot":
        changes.append(f"line.point_mass=[{{x_m={place}, wire='contact_wire', mass_kg=8.0}}]")
    elif kind == "tension":
        changes.append("line.variation.contact_wire.tension_change_share=-0.2")
    changes.append(f"line.variation.droppers.length_change_m={np.round(lengths, 5).tolist()}")
    record = ReferenceSimulator().run_unrefined(load_entry(LIBRARY.find_id(CASE), parse_changes(changes))).record
    assert record is not None
    start = (FIRST - 1) * SPAN_M
    x = start + np.arange(0, SPANS * SPAN_M, STEP_M)
    return np.interp(x, record.position[0], record.force[0]), (place - start) / 1000


def recall_segment(number: int, seed: int, folder: Path) -> tuple[RealArray, float]:
    """Segment of a seed, from the folder if it was simulated before."""
    path = folder / f"segment-{seed}-{number}.npz"
    if not path.exists():
        force, place = simulate_segment(number, np.random.default_rng((37, seed, number)))
        np.savez(path, force=force, place=place)
    with np.load(path) as kept:
        return kept["force"], float(kept["place"])


def write_runs(folder: Path, force: RealArray, random: np.random.Generator) -> list[Path]:
    """Logger files of four runs over a line, each with its sidecar."""
    paths = []
    for day, defect in enumerate(RUN_DEFECTS, 1):
        time = np.arange(0, force.size * STEP_M / (SPEED_KM_H / 3.6), 1 / RATE)
        x = SPEED_KM_H / 3.6 * time
        measured = np.interp(x, STEP_M * np.arange(force.size), force) * random.uniform(0.99, 1.01)
        measured += random.uniform(-1, 1) + random.normal(0, 2, time.size)
        if defect == "drifting zero":
            measured -= 25 * time / time[-1]
        elif defect == "gap":
            measured[time.size // 2 : time.size // 2 + round(0.4 * RATE)] = np.nan
        elif defect == "half rate":
            measured[1::2] = measured[: 2 * (time.size // 2) : 2]
        path = folder / f"run{day}.parquet"
        names = (("Zeit", "s"), ("km", "km"), ("Kraft", "N"))
        columns = tuple(TableColumn(name, unit=unit) for name, unit in names)
        write_parquet_table(
            path, MeasuredTable(path.name, np.column_stack([time, ZERO_KM + x / 1000, measured]), columns)
        )
        keys = ("time_s", "position_1_m", "force_1_N")
        sidecar = {
            **{"schema": "pantocheck.record/1", "file": path.name, "speed_km_h": SPEED_KM_H, "pantographs": 1},
            **{"filter_applied_Hz": "none", "evaluated_m": [0.0, float(x[-1])]},
            "columns": {key: {"column": name} for key, (name, _) in zip(keys, names, strict=True)},
            "track": {"zero_km": ZERO_KM, "kilometres": "increasing"},
        }
        text = tomli_w.dumps(sidecar) + f'\n[measurement]\nline = "1"\ntrack = "1"\ndate = 2026-04-{7 * day:02d}\n'
        path.with_suffix(".toml").write_text(text, encoding="utf-8")
        paths.append(path)
    return paths


def count_line_defects(results: NetworkResults, truth: Truth) -> tuple[Counter[str], Counter[str], Counter[str]]:
    """Planted and found defects of the line by kind, and false alarms."""
    planted, found, false = Counter[str](), Counter[str](), Counter[str](places=0, sections=0)
    unusual = [x for x in results.unusual if x.run is None]
    for kind, km in truth:
        planted[kind] += 1
        if kind == "tension":
            hits = {x.section.from_km for x in unusual if km <= x.section.from_km < km + LENGTH_KM - 1e-6}
            found[kind] += len(hits) >= 1
        else:
            found[kind] += any(abs(place.km - km) <= NEAR_KM for place in results.places)
    places = [km for kind, km in truth if kind != "tension"]
    tensions = [km for kind, km in truth if kind == "tension"]
    for place in results.places:
        known = any(abs(place.km - km) <= NEAR_KM for km in places) or any(
            km - NEAR_KM <= place.km <= km + LENGTH_KM + NEAR_KM for km in tensions
        )
        false["places"] += not known
    for value in unusual:
        low, high = value.section.from_km - NEAR_KM, value.section.to_km + NEAR_KM
        known = any(low <= km <= high for km in places) or any(km < high and km + LENGTH_KM > low for km in tensions)
        false["sections"] += not known
    return planted, found, false


def count_run_defects(results: NetworkResults, days: dict[str, int]) -> tuple[Counter[str], Counter[str]]:
    """Found defects of the runs, and false alarms; `days` are the numbers of the runs by their names."""
    found, false = Counter[str](), Counter[str](runs=0)
    means = Counter(days[x.run] for x in results.unusual if x.run is not None and x.quantity == "mean_force_N")
    found["drifting zero"] += means[2] >= 2
    known = [(group.values["mean_force_N"].passages, group.passages) for group in results.groups]
    found["gap"] += any(evaluated < passages for evaluated, passages in known)
    found["half rate"] += any(days[run] == 4 for run in results.suspicious)
    false["runs"] += sum(count >= 2 for day, count in means.items() if day != 2)
    false["runs"] += sum(days[run] not in (3, 4) for run in results.suspicious)
    return found, false


def print_table(seed: int, segments: int, folder: Path) -> None:
    """Print the outcome of one line with its four runs."""
    random = np.random.default_rng((37, seed))
    simulated = [recall_segment(number, seed, folder) for number in range(segments)]
    truth: Truth = []
    for number, (_, place) in enumerate(simulated):
        if (kind := choose_defect(number)) != "none":
            truth.append((kind, ZERO_KM + LENGTH_KM * number + (0.0 if kind == "tension" else place)))
    files = write_runs(folder, np.concatenate([force for force, _ in simulated]), random)
    runs = folder / "runs"
    with open_collection(runs):
        assert all(item.state != "refused" for item in import_files(files, runs, None))
    by = ("section", "speed", "direction", "pantograph")
    task = AssessmentTask(load_profile("acceptance-ac"), "secondary", by, LENGTH_KM / 2)
    results = assess_network(list_runs(runs), list_refused(runs), task, lambda *_: None)
    planted, found, false = count_line_defects(results, truth)
    days = {run.facts.run: run.facts.date.day // 7 for run in list_runs(runs)}
    run_found, run_false = count_run_defects(results, days)
    km = len(files) * segments * LENGTH_KM
    print("| seed | defect | planted | found | missed |")
    print("| :-- | :-- | --: | --: | --: |")
    rows = [*planted.items(), *((kind, 1) for kind in RUN_DEFECTS[1:])]
    for kind, number in rows:
        hits = (found + run_found)[kind]
        print(f"| {seed} | {kind} | {number} | {hits} | {number - hits} |")
    for kind, count in {**false, **run_false}.items():
        print(f"| {seed} | false alarms: {kind}, per 1,000 km of runs | {km:.0f} km | {1000 * count / km:.1f} | |")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--segments", type=int, default=12, help="segments of 2.2 km")
    parser.add_argument("--out", type=Path, help="folder for the files; default: a temporary one")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        place = given.out or Path(temporary)
        place.mkdir(parents=True, exist_ok=True)
        print_table(given.seed, given.segments, place)

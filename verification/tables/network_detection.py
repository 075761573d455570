"""Planted defects of measured lines: found, missed and false alarms of `runs assess`, with its speed and memory.

python -m verification.tables.network_detection [--seeds 1 2] [--lines 11] [--out DIR]

With --out, the data set is kept: logger files, truth.json, the collection and its assessment; simulated segments are
used again. Of two seeds, thresholds were chosen on the first one; the second one is counted once, after all choices.

Segments. The reference simulator passes the line AC simple at 275 km/h over segments of 40 spans (2.2 km), 21 of each
seed. Every segment has its own irregularity of the contact wire (density 1e-5, 1e-6 and 1e-8 m3 at 0.02, 0.1 and
0.5 1/m) and dropper lengths (uniform within 3 mm). Every third seven of segments is even: a tenth of this density, and
1 mm. Of seven segments, three have four local defects: two droppers 12 mm too long, which carry nothing like broken
ones; a mass of 8 kg on the contact wire (hard spot); all droppers of one span 30 mm too long (soft spot). One has a
tension of the contact wire that is 20 % too low, one a contact wire worn by 25 % of its cross-section, and two have no
defect.

Lines. Each has 14 segments (30.8 km) in random order; every third line is even. A line uses a segment once, or twice if
it is even, and the lines of a seed share them: new passages differ in the measurement alone.

Runs. Eight dates per line. Every run has noise of 2 N, a gain error of up to 1 % and a zero error of up to 1 N. Every
second run has a force sensor below a head of 7.5 kg and an accelerometer with noise of 0.1 m/s2. Two runs have no
other defect. The others have: a zero that drifts to -25 N; a gap of 0.4 s without force; every second sample held
(half rate); kilometres that are 250 m too high; a force 1 s late against the kilometres; the force of another place,
half a line away.

Counts. A local defect is found if a place is listed within 60 m, a tension or wear if one of its sections is listed
with an unusual standard deviation, a zero if two passages of its run have an unusual mean, a gap if its section has no
value, a half rate if the import remarks it, a misplaced run if its offset is listed within 5 m (another place: without
an offset) for most of the run. Other places, sections and runs are false alarms.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import tomli_w

from pantocheck.conformance.cases.catalogue import LIBRARY
from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.cases.library import load_entry
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.measured_table import MeasuredTable, TableColumn
from pantocheck.conformance.core.parquet_table import write_parquet_table
from pantocheck.conformance.network.run_collection import list_runs
from pantocheck.conformance.results.network_format import NetworkResults
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator

CASE, SPEED_KM_H = "en50318-2018/ac-simple/275", 275.0
SPAN_M, FIRST, SPANS, BEHIND, DROPPERS = 55.0, 13, 40, 8, 9
LENGTH_KM = SPANS * SPAN_M / 1000
RATE, STEP_M = 500.0, 0.05
SEGMENTS, LINE_SEGMENTS = 21, 14
HEAD_KG = 7.5
PLAN = ("local", "none", "local", "tension", "local", "wear", "none")
"""Defects of successive segments."""

LOCAL_DEFECTS = ("dropper", "hard spot", "soft spot", "dropper")
RUN_DEFECTS = ("none", "drifting zero", "gap", "half rate", "wrong kilometre", "wrong clock", "another place", "none")
OFFSETS_M = {"wrong kilometre": 250.0, "wrong clock": SPEED_KM_H / 3.6, "another place": None}
ZERO_KM = 11.0
NEAR_KM = 0.06
DENSITIES_M3 = (1e-5, 1e-6, 1e-8)
"""Irregularity of the contact wire of a rough segment; a tenth of it in an even one."""

Truth = list[tuple[str, float]]
"""Kind and place [km] of each planted defect of the line; the start of a segment for its tension or wear."""


def simulate_segment(number: int, random: np.random.Generator) -> tuple[RealArray, RealArray, Truth]:
    """Unfiltered force and acceleration of the head every `STEP_M`, and defects by distance from the start [km]."""
    kind, spans, start = PLAN[number % len(PLAN)], FIRST + SPANS + BEHIND, (FIRST - 1) * SPAN_M
    length_m, share = (0.001, 0.1) if is_even(number) else (0.003, 1.0)
    lengths = random.uniform(-length_m, length_m, (spans, DROPPERS))
    changes = [
        f"line.geometry.spans={spans}",
        f"evaluated_spans=[{FIRST}, {FIRST + SPANS - 1}]",
        f"compared_spans=[{FIRST - 2}, {FIRST + SPANS - 1}]",
        f"line.contact_wire.irregularity={{frequency_1_m=[0.02, 0.1, 0.5], "
        f"density_m3={[share * density for density in DENSITIES_M3]}, seed={random.integers(2**31)}}}",
    ]
    truth: Truth = []
    if kind == "local":
        for i, defect in enumerate(random.permutation(LOCAL_DEFECTS)):
            span = FIRST + 3 + 10 * i + int(random.integers(0, 4))
            place = span * SPAN_M + SPAN_M / 2
            if defect == "dropper":
                dropper = int(random.integers(1, DROPPERS - 1))
                lengths[span, dropper] += 0.012
                place = span * SPAN_M + 4.5 + 5.75 * dropper
            elif defect == "soft spot":
                lengths[span] += 0.03
            else:
                place = span * SPAN_M + float(random.uniform(5, 50))
                changes.append(f"line.point_mass=[{{x_m={place}, wire='contact_wire', mass_kg=8.0}}]")
            truth.append((str(defect), (place - start) / 1000))
    elif kind != "none":
        truth.append((kind, 0.0))
        change = "line.variation.contact_wire.tension_change_share=-0.2"
        worn = f"line.contact_wire.change=[{{from_m=0, to_m={spans * SPAN_M}, wear_share=0.25}}]"
        changes.append(change if kind == "tension" else worn)
    changes.append(f"line.variation.droppers.length_change_m={np.round(lengths, 5).tolist()}")
    record = ReferenceSimulator().run_unrefined(load_entry(LIBRARY.find_id(CASE), parse_changes(changes))).record
    assert record is not None
    x = start + np.arange(0, SPANS * SPAN_M, STEP_M)
    rise = np.gradient(np.gradient(record.contact_height[0], 1 / record.rate), 1 / record.rate)
    force, acceleration = (np.interp(x, record.position[0], values) for values in (record.force[0], rise))
    return force, acceleration, truth


def recall_segment(number: int, seed: int, folder: Path) -> tuple[RealArray, RealArray, Truth]:
    """Segment of a seed, from the folder if it was simulated before."""
    path = folder / f"segment-{seed}-{number}.npz"
    if not path.exists():
        force, rise, truth = simulate_segment(number, np.random.default_rng((37, seed, number)))
        signals = {"force": force.astype(np.float32), "acceleration": rise.astype(np.float32)}
        np.savez(path, kinds=[x for x, _ in truth], km=[x for _, x in truth], **signals)
    with np.load(path) as kept:
        truth = list(zip(map(str, kept["kinds"]), map(float, kept["km"]), strict=True))
        return kept["force"].astype(float), kept["acceleration"].astype(float), truth


def is_even(number: int) -> bool:
    """Whether a segment is of the even kind: every third seven of segments."""
    return number // len(PLAN) % 3 == 2


def build_lines(seed: int, count: int, folder: Path) -> Iterator[tuple[RealArray, RealArray, Truth]]:
    """Force and acceleration of the lines of a seed every `STEP_M`, with their defects by kilometre."""
    segments = [recall_segment(number, seed, folder) for number in range(SEGMENTS)]
    even = [number for number in range(SEGMENTS) if is_even(number)]
    rough = [number for number in range(SEGMENTS) if not is_even(number)]
    for line in range(count):
        random = np.random.default_rng((37, seed, 1000 + line))
        numbers = random.permutation(2 * even if line % 3 == 2 else rough)
        force, rise = (np.concatenate([segments[number][part] for number in numbers]) for part in (0, 1))
        truth = [
            (f"{kind}, even line" if line % 3 == 2 else kind, ZERO_KM + LENGTH_KM * place + km)
            for place, number in enumerate(numbers)
            for kind, km in segments[number][2]
        ]
        yield force, rise, truth


def write_runs(folder: Path, line: int, force: RealArray, rise: RealArray, random: np.random.Generator) -> None:
    """Write the logger files of the runs over a line, each with its sidecar."""
    for day, defect in enumerate(RUN_DEFECTS, 1):
        time = np.arange(0, force.size * STEP_M / (SPEED_KM_H / 3.6), 1 / RATE)
        x = SPEED_KM_H / 3.6 * time
        there = x + x[-1] / 2 if defect == "another place" else x - (OFFSETS_M.get(defect) or 0.0)
        true, moved = (np.interp(there % x[-1], STEP_M * np.arange(force.size), part) for part in (force, rise))
        measured = true * random.uniform(0.99, 1.01) + random.uniform(-1, 1) + random.normal(0, 2, time.size)
        sensors = day % 2 == 0
        if sensors:
            measured += HEAD_KG * moved
            moved = moved + random.normal(0, 0.1, time.size)
        if defect == "drifting zero":
            measured -= 25 * time / time[-1]
        elif defect == "gap":
            measured[time.size // 2 : time.size // 2 + round(0.4 * RATE)] = np.nan
        elif defect == "half rate":
            for values in (measured, moved):
                values[1::2] = values[: 2 * (time.size // 2) : 2]
        path = folder / f"line{line}-run{day}.parquet"
        names = (("Zeit", "s"), ("km", "km"), ("Kraft", "N"), *([("Beschleunigung", "m/s2")] if sensors else []))
        columns = tuple(TableColumn(name, unit=unit) for name, unit in names)
        values = [time, ZERO_KM + x / 1000, measured, *([moved] if sensors else [])]
        write_parquet_table(path, MeasuredTable(path.name, np.column_stack(values), columns))
        head = {"mass_kg": HEAD_KG, "acceleration": {"column": "Beschleunigung"}}
        contact = {"sum": [{"column": "Kraft"}], "head": [head]} if sensors else {"column": "Kraft"}
        sidecar = {
            **{"schema": "pantocheck.record/1", "file": path.name, "speed_km_h": SPEED_KM_H, "pantographs": 1},
            **{"filter_applied_Hz": "none", "evaluated_m": [0.0, float(x[-1])]},
            "columns": {"time_s": {"column": "Zeit"}, "position_1_m": {"column": "km"}, "force_1_N": contact},
            "track": {"zero_km": ZERO_KM, "kilometres": "increasing"},
        }
        text = tomli_w.dumps(sidecar) + f'\n[measurement]\nline = "{line}"\ntrack = "1"\ndate = 2026-04-{3 * day:02d}\n'
        path.with_suffix(".toml").write_text(text, encoding="utf-8")


class Cost(NamedTuple):
    """Cost of a command."""

    processor_s: float
    largest_MB: float
    """Largest memory; not less than that of this program."""


def run_command(*arguments: object) -> Cost:
    """Run a command of the suite in a process of its own."""
    command = [sys.executable, "-m", "pantocheck", *map(str, arguments)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode in (0, 1, 2), command
    return Cost(usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)


def is_wide(kind: str) -> bool:
    """Whether a defect is that of a whole segment."""
    return kind.partition(",")[0] in PLAN


def count_line_defects(results: NetworkResults, line: int, truth: Truth) -> tuple[Counter[str], ...]:
    """Planted and found defects of a line by kind, and false alarms."""
    planted, found, false = Counter[str](), Counter[str](), Counter[str](places=0, sections=0)
    unusual = [x.section for x in results.unusual if x.run is None and x.section.line == str(line)]
    places = [place.km for place in results.places if place.line == str(line)]
    wide = [(km - NEAR_KM, km + LENGTH_KM + NEAR_KM) for kind, km in truth if is_wide(kind)]
    local = [(km - NEAR_KM, km + NEAR_KM) for kind, km in truth if not is_wide(kind)]
    for kind, km in truth:
        planted[kind] += 1
        if is_wide(kind):
            found[kind] += any(km - 1e-6 <= section.from_km < km + LENGTH_KM - 1e-6 for section in unusual)
        else:
            found[kind] += any(abs(place - km) <= NEAR_KM for place in places)
    # A wave behind a defect disturbs the next spans.
    touched = [*wide, *((low - NEAR_KM, high + 2 * NEAR_KM) for low, high in local)]
    false["places"] += sum(not any(low <= place <= high for low, high in touched) for place in places)
    false["sections"] += sum(
        not any(x.from_km < high and x.to_km > low for low, high in [*wide, *local]) for x in unusual
    )
    return planted, found, false


def count_run_defects(results: NetworkResults, line: int, days: dict[str, int]) -> tuple[Counter[str], Counter[str]]:
    """Found defects of the runs of a line, and false alarms; `days` are the numbers of its runs by their names."""
    found, false = Counter[str](), Counter[str](runs=0)
    kinds = {run: RUN_DEFECTS[day - 1] for run, day in days.items()}
    groups = [group for group in results.groups if group.section.line == str(line)]
    misplaced = [x for x in results.misplaced if x.run in kinds]
    means = Counter(kinds[x.run] for x in results.unusual if x.run in kinds and x.quantity == "mean_force_N")
    remarked = {kinds[run] for run in results.suspicious if run in kinds}
    known = [(group.values["mean_force_N"].passages, group.passages) for group in groups]
    found["drifting zero"] += means["drifting zero"] >= 2
    found["gap"] += any(evaluated < passages for evaluated, passages in known)
    found["half rate"] += "half rate" in remarked
    length = max(group.section.to_km for group in groups) - ZERO_KM
    for kind, offset in OFFSETS_M.items():
        parts = [x for x in misplaced if kinds[x.run] == kind and _is_near(x.offset_m, offset)]
        found[kind] += sum(x.to_km - x.from_km for x in parts) > length / 2
    named = {kinds[x.run] for x in misplaced}
    # The gap ends in zero offsets; other values of misplaced runs are unusual rightly.
    false["runs"] += len(named - set(OFFSETS_M)) + len(remarked - {"gap", "half rate"})
    false["runs"] += sum(count >= 2 for kind, count in means.items() if kind not in ("drifting zero", *OFFSETS_M))
    return found, false


def _is_near(one: float | None, other: float | None) -> bool:
    return one is other if one is None or other is None else abs(one - other) <= 5.0


def count_seed(seed: int, lines: int, folder: Path) -> tuple[list[Counter[str]], list[Cost]]:
    """Planted, found and false findings of the lines of a seed, and the cost of import and assessment."""
    here = folder / f"seed-{seed}"
    here.mkdir(exist_ok=True)
    truths: list[Truth] = []
    for line, (force, rise, truth) in enumerate(build_lines(seed, lines, folder)):
        write_runs(here, line, force, rise, np.random.default_rng((37, seed, 2000 + line)))
        truths.append(truth)
    (here / "truth.json").write_text(json.dumps({"lines": truths, "runs": RUN_DEFECTS}), encoding="utf-8")
    files = sorted(here.glob("*.parquet"))
    runs, net = here / "runs", here / "net"
    costs = [run_command("runs", "import", *files, "--out", runs)]
    given = ("--profile", "acceptance-ac", "--section-km", LENGTH_KM / 2)
    costs.append(run_command("runs", "assess", runs, *given, "--out", net))
    results = NetworkResults.model_validate_json((net / "network.json").read_text(encoding="utf-8"))
    assert not results.refused
    total = [Counter[str](), Counter[str](), Counter[str]()]
    stored = list(list_runs(runs))
    for line, truth in enumerate(truths):
        days = {run.facts.run: run.facts.date.day // 3 for run in stored if run.facts.line == str(line)}
        planted, found, false = count_line_defects(results, line, truth)
        run_found, run_false = count_run_defects(results, line, days)
        parts = (planted + Counter(run_found.keys()), found + run_found, Counter({**false, **run_false}))
        for sums, part in zip(total, parts, strict=True):
            sums.update(part)
    return total, costs


def print_tables(seeds: Sequence[int], lines: int, folder: Path) -> None:
    """Print the outcome of all seeds, and the cost of the commands."""
    track = lines * LINE_SEGMENTS * LENGTH_KM
    run_km = len(RUN_DEFECTS) * track
    rows, costs = [], []
    for number, seed in enumerate(seeds):
        half = "chosen" if number == 0 else "held out"
        (planted, found, false), parts = count_seed(seed, lines, folder)
        rows += [
            f"| {kind} | {half} | {count} | {found[kind]} | {count - found[kind]} |" for kind, count in planted.items()
        ]
        for kind, count in false.items():
            rate = 1000 * count / (run_km if kind == "runs" else track)
            rows.append(
                f"| false {kind} | {half} | {run_km if kind == 'runs' else track:.0f} km | {count} | {rate:.1f} |"
            )
        for name, cost in zip(("import", "assess"), parts, strict=True):
            speed = 60 * run_km / cost.processor_s
            costs.append(
                f"| {name} | {half} | {run_km:.0f} | {cost.processor_s:.0f} | {speed:.0f} | {cost.largest_MB:.0f} |"
            )
    print("| defect or false alarm | half | planted | found | missed, or per 1,000 km |")
    print("| :-- | :-- | --: | --: | --: |", *rows, sep="\n", end="\n\n")
    print("| command | half | km of runs | processor time [s] | km per minute of it | largest memory [MB] |")
    print("| :-- | :-- | --: | --: | --: | --: |", *costs, sep="\n")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--lines", type=int, default=11, help="lines of 30.8 km of each seed")
    parser.add_argument("--out", type=Path, help="folder for the data set; default: a temporary one")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        place = given.out or Path(temporary)
        place.mkdir(parents=True, exist_ok=True)
        print_tables(given.seeds, given.lines, place)

"""Coverage of the intervals of a mass drop in the field: frequencies, damping ratios, coefficients of damping.

python -m verification.tables.field_coverage RECORDS.csv [--records 30] [--rows ROW ...]

Records. `field_records` simulates drops on three lines, whose tensions differ from the stated ones by 1 % (standard
deviation), with 2 to 5 sensors, 2 to 4 minutes and white noise of 3 mm/s2. A record of a row is identified up to
6.2 Hz; its damping is fitted on the line as stated. RECORDS.csv has one row for each record. Records that it holds are
not repeated, so that a run can be continued, and a larger number of records adds to those of a smaller one. Rows with
fewer than 1,000 intervals are run with more records; their number depends on that of the intervals, not on shares.

Seeds. Record r of the row with number k in `ROWS` has the seed (50333, k, r), with r = 0, 1, 2 ... It is on line r
modulo 3, and has 2 + (r // 3) modulo 4 sensors. This rule was recorded before the first run with these seeds, and no
other seed enters the table. The program was tried with the seed 50332.

Truth. Reported and true modes form pairs by the smallest sum of all distances; the largest distance of a pair is 6 mHz
or four standard deviations, and the sum counts shares of it. A reported mode without a true one is spurious. Every
certain mode with a true one, and every determined coefficient, gives an interval. The width ratio is the median over
records of the median half-width over the smallest correct one (`field_bound`). An observable mode has a bound on its
damping ratio below 0.5 %. Rows are not pooled. Outcomes as in verification/tables/interval_share.py.
"""

import argparse
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.damping_results import build_damping_results
from pantocheck.conformance.drops.identify import identify_modes
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.model import Kind
from verification.tables.field_bound import COVERED, TERMS, SmallestWidths, compute_smallest_widths
from verification.tables.field_records import (
    ELEMENT,
    LINES,
    Disturbance,
    FieldRecord,
    build_line,
    draw_layout,
    make_record,
)
from verification.tables.interval_share import SHARE_COLUMNS, IntervalShare, append_row, print_table, read_rows

SEED = 50333
HIGHEST = 6.2
"""Highest frequency of a reported mode [Hz]."""
TENSION_SCATTER = 0.01
"""Standard deviation of the tensions about the stated ones [-]."""
NEAR_HZ, NEAR_STD = 0.006, 4.0
"""Largest distance of a reported mode from a true one: the larger of both [Hz, standard deviations]."""
OBSERVABLE = 0.005
"""Bound on the damping ratio of an observable mode, as a share of the ratio [-]."""
TRUE_PER_SPURIOUS = 10
"""Fewest observable modes for each spurious one."""
QUANTITIES = ("frequency", "ratio", "coefficient")
LABELS = ("frequency", "damping ratio", "coefficients")

LIGHT, MEDIUM, HEAVY = (20.0, 40.0), (60.0, 60.0), (100.0, 100.0)
"""Bounds of the mass [kg]."""
WIND, STRONG, COLOURED, CLOCK = 1.0, 10 / 3, 5.0, 50e-6
"""Ambient motion of 3 and 10 mm/s2 and coloured noise of 15 mm/s2, over white noise of 3 mm/s2; rate of a clock [-]."""
ROWS: dict[str, tuple[Disturbance, tuple[float, float]]] = {
    "none": (Disturbance(), LIGHT),
    "ambient motion 3 mm/s2": (Disturbance(WIND), LIGHT),
    "ambient motion 10 mm/s2": (Disturbance(STRONG), LIGHT),
    "clocks 50 ppm": (Disturbance(clock=CLOCK), LIGHT),
    "coloured noise 15 mm/s2": (Disturbance(coloured=COLOURED), LIGHT),
    "ambient 3 mm/s2, clocks": (Disturbance(WIND, clock=CLOCK), LIGHT),
    "ambient 3 mm/s2, coloured, clocks": (Disturbance(WIND, COLOURED, CLOCK), LIGHT),
    "60 kg": (Disturbance(), MEDIUM),
    "100 kg": (Disturbance(), HEAVY),
}
"""Disturbances and masses; the number of a row counts from 0."""

Row = Mapping[str, str]
Intervals = list[tuple[float, float, float]]
"""Error, half-width and smallest correct half-width of each interval."""


class MatchedModes(NamedTuple):
    """Reported modes beside the true ones."""

    reported: NDArray[np.int64]
    true: NDArray[np.int64]
    """Numbers of the pairs."""
    spurious: NDArray[np.int64]
    """Numbers of reported modes without a true one."""


def match_true_modes(modes: Sequence[Mode], frequency: NDArray[np.float64]) -> MatchedModes:
    """Pair reported modes with true frequencies [Hz]."""
    found = np.array([mode.frequency_Hz for mode in modes])
    std = np.array([mode.frequency_std_Hz or 0.0 for mode in modes])
    distance = np.abs(found[:, None] - frequency) / np.maximum(NEAR_HZ, NEAR_STD * std)[:, None]
    reported, true = linear_sum_assignment(np.minimum(distance, 1.0))
    near = distance[reported, true] < 1.0
    reported, true = reported[near], true[near]
    return MatchedModes(reported, true, np.setdiff1d(np.arange(found.size), reported))


def make_field_record(name: str, number: int) -> FieldRecord:
    """Record of a row."""
    disturbance, mass = ROWS[name]
    random = np.random.default_rng((SEED, list(ROWS).index(name), number))
    line = list(LINES)[number % len(LINES)]
    factors = 1 + TENSION_SCATTER * random.standard_normal(2)
    layout = draw_layout(random, line, 2 + number // len(LINES) % 4, mass)
    places = (layout.drop[1], *(x for _, x in layout.sensors))
    return make_record(random, build_line(line, tuple(factors.tolist()), places), layout, disturbance)


def measure_record(name: str, number: int) -> dict[str, object]:
    """Row of the store for one record; a refused record has the reason and no intervals."""
    field, begin = make_field_record(name, number), time.process_time()
    row: dict[str, object] = {
        "disturbance": name,
        "record": number,
        "sensors": len(field.record.channels),
        "duration_s": round(field.record.duration, 1),
        "mass_kg": round(field.record.drop.mass or 0.0, 1),
        "slack_s": round(field.taut - (field.record.drop.trigger_nominal or 0.0), 1),
    }
    modes: Sequence[Mode] = ()
    refused = ""
    try:
        modes = identify_modes((field.record,), HIGHEST)[0].modes
    except InputError as problem:
        refused = " ".join(str(problem).split())
    seconds = time.process_time() - begin
    poles, widths = field.line.poles, compute_smallest_widths(field, HIGHEST)
    frequency, ratio = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    pairs = match_true_modes(modes, frequency)
    inside = frequency[: widths.ratio.size] < HIGHEST
    observable = np.flatnonzero(inside & (widths.ratio / COVERED < OBSERVABLE * ratio[: inside.size]))
    certain = [(modes[i], int(j)) for i, j in zip(pairs.reported, pairs.true, strict=True) if modes[i].certain]
    found = {
        "frequency": [
            (mode.frequency_Hz - frequency[j], COVERED * (mode.frequency_std_Hz or 0.0), widths.frequency[j])
            for mode, j in certain
        ],
        "ratio": [
            (mode.damping_ratio - ratio[j], COVERED * mode.damping_ratio_std, widths.ratio[j]) for mode, j in certain
        ],
        "coefficient": list(compare_coefficients(modes, field, widths)),
    }
    row |= {
        "refused": refused,
        "identification_s": round(seconds, 1),
        "observable": observable.size,
        "observable_found": len({j for _, j in certain} & set(observable.tolist())),
        "modes": len(modes),
        "certain": sum(mode.certain for mode in modes),
        "spurious": pairs.spurious.size,
        "certain_spurious": sum(modes[i].certain for i in pairs.spurious),
    }
    for quantity in QUANTITIES:
        row |= {f"{quantity}_{key}": value for key, value in summarise(found[quantity]).items()}
    return row


def compare_coefficients(
    modes: Sequence[Mode], field: FieldRecord, widths: SmallestWidths
) -> Iterator[tuple[float, float, float]]:
    """Intervals of the determined coefficients of a fit on the line as stated; none if it is refused."""
    try:
        results = build_damping_results(modes, field.line.stated, ELEMENT, "modes")
    except InputError:
        return
    for c in results.coefficients:
        if c.determined and (c.kind, c.matrix) in TERMS:
            true = getattr(field.line.stated.rayleigh(Kind(c.kind)), f"{c.matrix}_coefficient")
            middle, half = (c.low_95 + c.high_95) / 2, (c.high_95 - c.low_95) / 2
            yield middle - true, half, widths.coefficients[c.kind, c.matrix]


def summarise(intervals: Intervals) -> dict[str, object]:
    """Number of intervals, and of those that contain the truth; largest error over half-width; median width ratio."""
    if not intervals:
        return {"intervals": 0, "contained": 0, "largest_error": "", "width_ratio": ""}
    error, half, smallest = np.abs(np.array(intervals)).T
    return {
        "intervals": len(intervals),
        "contained": int(np.sum(error <= half)),
        "largest_error": f"{np.max(error / half):.3g}",
        "width_ratio": f"{np.median(half / smallest):.4g}",
    }


def describe_shares(rows: Sequence[Row], name: str) -> Iterator[list[str]]:
    """Table rows of a disturbance, one for each quantity."""
    refused = sum(bool(row["refused"]) for row in rows)
    for quantity, label in zip(QUANTITIES, LABELS, strict=True):
        used = [row for row in rows if int(row[f"{quantity}_intervals"])]
        cells = [name, f"{len(rows)}", f"{refused}", label]
        if not used:
            yield [*cells, "0", *(["-"] * 5)]
            continue
        count, contained = (sum(int(row[f"{quantity}_{key}"]) for row in used) for key in ("intervals", "contained"))
        ratio = float(np.median([float(row[f"{quantity}_width_ratio"]) for row in used]))
        share = IntervalShare(count, contained, ratio)
        largest = COVERED * max(float(row[f"{quantity}_largest_error"]) for row in used)
        yield [*cells, share.text, f"{largest:.1f}", share.outcome]


def describe_modes(rows: Sequence[Row], name: str) -> list[str]:
    """Table row of the modes of a disturbance, over the records that were not refused."""
    used = [row for row in rows if not row["refused"]]
    if not used:
        return [name, "0", *(["-"] * 6)]
    observable, found, modes, spurious, certain = (
        sum(int(row[key]) for row in used)
        for key in ("observable", "observable_found", "modes", "spurious", "certain_spurious")
    )
    many = sum(TRUE_PER_SPURIOUS * int(row["spurious"]) > int(row["modes"]) - int(row["spurious"]) for row in used)
    seconds = [float(row["identification_s"]) for row in used]
    cells = (len(used), f"{100 * found / observable:.1f}", modes, spurious, many, certain, f"{np.mean(seconds):.1f}")
    return [name, *map(str, cells)]


def main() -> None:
    """Measure the records that the store lacks, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path, metavar="RECORDS.csv")
    parser.add_argument("--records", type=int, default=30, help="records of each row; default: %(default)s")
    parser.add_argument("--rows", nargs="+", choices=ROWS, default=list(ROWS), help="rows that are run; default: all")
    options = parser.parse_args()
    done = {(row["disturbance"], int(row["record"])) for row in read_rows(options.results)}
    for number in range(options.records):
        for name in options.rows:
            if (name, number) not in done:
                append_row(options.results, measure_record(name, number))
    stored = read_rows(options.results)
    by_name = {name: [row for row in stored if row["disturbance"] == name] for name in ROWS}
    heads = ["disturbance", "records", "refused", "quantity", SHARE_COLUMNS, "largest error [sd]", "outcome"]
    print_table(heads, (cells for name, rows in by_name.items() for cells in describe_shares(rows, name)))
    heads = ["disturbance", "records", "observable modes found [%]", "modes", "spurious"]
    heads += ["records with more than 1 in 10", "certain and spurious", "processor time [s]"]
    print_table(heads, (describe_modes(rows, name) for name, rows in by_name.items()))


if __name__ == "__main__":
    main()

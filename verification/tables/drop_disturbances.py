"""Disturbances of one record with known modes, T1, one at a time.

python -m verification.tables.drop_disturbances FOLDER [--seeds 3] [--first 0] [--only ROW]

FOLDER has T1.h5 and truth.json. Seed s disturbs run s + 1 of T1, which has three and begins again, as `ROWS` says;
the signals are those of the review of commit 326dbcb4. Modes are identified up to 6.2 Hz. The 34 observable modes
below 6.1 Hz give the intervals; a mode of the line, vertical or lateral, is not spurious. Two more drops are
simulated on the line of T1, because the elements of T1 are stiffer than the line: one of 100 kg, and one of 40 kg,
whose damping is fitted on line files with wrong tensions.
"""

import argparse
import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.damping_results import build_damping_results
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.identify import identify_modes
from pantocheck.conformance.line.line_parameters import MECHANICAL, scale_line
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.model import Kind
from verification.tables.field_bound import COVERED, TERMS
from verification.tables.field_coverage import HIGHEST, match_true_modes
from verification.tables.field_records import (
    ELEMENT,
    LINES,
    Disturbance,
    FieldRecord,
    Layout,
    build_line,
    make_coloured_noise,
    make_record,
    move_by_wind,
    read_by_clocks,
)
from verification.tables.interval_share import print_table

ROWS = {
    "none": Disturbance(),
    "ambient motion of 3 mm/s2": Disturbance(wind=0.003),
    "ambient motion of 10 mm/s2": Disturbance(wind=0.01),
    "clocks off by +50, -50, +50 ppm": Disturbance(clock=50e-6),
    "coloured noise of 15 mm/s2": Disturbance(coloured=0.015),
}
"""Disturbances; ambient motion and coloured noise in [m/s2]."""
SCORED_HZ = 6.1
"""Upper end of the modes that give intervals [Hz]."""
TENSION_ERRORS = (0.0, 0.009, 0.02)
"""Errors of the tension of the contact wire in a line file; those of the messenger wire are the opposite [-]."""
LIGHT_KG, HEAVY_KG, SEED = 40.0, 100.0, 50334
SENSORS = (("CW", 195.75), ("CW", 144.0), ("MW", 272.25), ("MW", 96.75))
PLACE = ("CW", 212.25)
"""Sensors and drop of T1."""


def disturb(record: DropRecord, disturbance: Disturbance, truth: list[dict], seed: int) -> DropRecord:
    """Record with a disturbance of its vertical channels."""
    random, vertical = np.random.default_rng((SEED, seed)), list(record.along("z"))
    signals, n = record.signals.copy(), record.signals.shape[0]
    if disturbance.clock:
        rates = disturbance.clock * np.repeat([0.0, 1.0, -1.0, 1.0], signals.shape[1] // len(vertical))
        signals = read_by_clocks(signals, rates, np.zeros(rates.size), record.rate)
    if disturbance.wind:
        shape = np.array([mode["shape_re"] for mode in truth]).T
        omega, ratio = 2 * np.pi * np.array([(mode["f_record_hz"], mode["zeta"] / (2 * np.pi)) for mode in truth]).T
        poles = omega * (-ratio + 1j * np.sqrt(1 - ratio**2))
        signals[:, vertical] += move_by_wind(poles, shape, random, n, disturbance.wind, record.rate)[0]
    if disturbance.coloured:
        signals[:, vertical] += make_coloured_noise(random, n, len(vertical), disturbance.coloured, record.rate)
    return replace(record, signals=signals)


def simulate_drop(mass: float, seed: int) -> FieldRecord:
    """Drop of a mass [kg] on the line of T1, in calm air."""
    line = build_line(next(iter(LINES)), (1.0, 1.0), (PLACE[1], *(x for _, x in SENSORS)))
    layout = Layout(mass, PLACE, SENSORS, 124.0 / 60)
    return make_record(np.random.default_rng((SEED, seed, round(mass))), line, layout, Disturbance())


def list_true_modes(field: FieldRecord) -> dict:
    """True modes of a simulated drop, in the form of truth.json; all count as observable."""
    modes = [
        {"f_hz": abs(pole) / (2 * np.pi), "f_record_hz": abs(pole) / (2 * np.pi), "zeta": -pole.real / abs(pole)}
        for pole in field.line.poles
    ]
    return {"vertical_modes": [mode | {"observable": True} for mode in modes], "lateral_modes": []}


def try_identification(record: DropRecord) -> tuple[Mode, ...] | str:
    """Modes, or the reason why the record is refused."""
    try:
        return identify_modes((record,), HIGHEST)[0].modes
    except InputError as problem:
        return str(problem)


def score_modes(modes: tuple[Mode, ...], truth: dict) -> tuple[RealArray, int, int]:
    """Errors of frequency and damping ratio in standard deviations, (2, n); spurious and certain spurious modes."""
    known = [*truth["vertical_modes"], *truth["lateral_modes"]]
    pairs = match_true_modes(modes, np.array([mode.get("f_record_hz", mode["f_hz"]) for mode in known]))
    errors = [
        (
            (modes[i].frequency_Hz - known[j]["f_record_hz"]) / (modes[i].frequency_std_Hz or np.inf),
            (modes[i].damping_ratio - known[j]["zeta"]) / modes[i].damping_ratio_std,
        )
        for i, j in zip(pairs.reported, pairs.true, strict=True)
        if known[j].get("observable") and known[j]["f_hz"] < SCORED_HZ and modes[i].certain and not modes[i].lateral
    ]
    certain = sum(modes[i].certain for i in pairs.spurious)
    return np.array(errors).reshape(-1, 2).T, pairs.spurious.size, certain


def describe_identifications(records: Sequence[DropRecord], truth: dict, name: str) -> list[str]:
    """Table row of a disturbance, over its seeds."""
    found = [modes for record in records if not isinstance(modes := try_identification(record), str)]
    cells = [name, f"{len(records) - len(found)} of {len(records)}"]
    if not found:
        return [*cells, *(["-"] * 7)]
    scores = [score_modes(modes, truth) for modes in found]
    errors = np.hstack([errors for errors, _, _ in scores])
    shares = (f"{100 * np.mean(np.abs(row) <= COVERED):.0f}" for row in errors)
    largest = f"{np.abs(errors).max():.1f}"
    counts = (
        ", ".join(str(value) for value in values)
        for values in zip(*((len(m), s, c) for m, (_, s, c) in zip(found, scores, strict=True)), strict=True)
    )
    return [*cells, f"{errors.shape[1]}", *shares, largest, *counts]


def describe_fits(modes: list[tuple[Mode, ...]], error: float) -> Iterator[str]:
    """Cells of the fits of the damping on a line file with wrong tensions."""
    stated = build_line(next(iter(LINES)), (1.0, 1.0), ()).stated
    line = scale_line(stated, MECHANICAL[:2], (1 + error, 1 - error))
    contained, errors, states = 0, [], []
    for found in modes:
        results = build_damping_results(found, line, ELEMENT, "modes")
        states.append(results.line.state)
        for c in results.coefficients:
            if (c.kind, c.matrix) in TERMS:
                true = getattr(stated.rayleigh(Kind(c.kind)), f"{c.matrix}_coefficient")
                contained += c.low_95 <= true <= c.high_95
                errors.append(abs(c.value / true - 1))
    yield f"{100 * error:+.1f} / {-100 * error:+.1f}"
    yield f"{contained} of {len(errors)}"
    yield f"{100 * min(errors):.1f} to {100 * max(errors):.1f}"
    yield ", ".join(dict.fromkeys(states))


def main() -> None:
    """Disturb, identify and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seeds", type=int, default=3, help="number of seeds; default: %(default)s")
    parser.add_argument("--first", type=int, default=0, help="first seed; default: %(default)s")
    parser.add_argument("--only", choices=ROWS, help="print the row of one disturbance")
    options = parser.parse_args()
    truth = json.loads((options.folder / "truth.json").read_text())["tests"]["T1"]
    runs = read_drop_records(options.folder / "T1.h5")
    seeds = range(options.first, options.first + options.seeds)
    heads = ["disturbance", "refused", "intervals", "frequency contained [%]", "damping contained [%]"]
    heads += ["largest error [sd]", "modes", "spurious", "certain and spurious"]
    vertical = truth["vertical_modes"]
    rows = [
        describe_identifications([disturb(runs[s % len(runs)], ROWS[name], vertical, s) for s in seeds], truth, name)
        for name in ([options.only] if options.only else ROWS)
    ]
    if options.only:
        print_table(heads, rows)
        return
    heavy = [simulate_drop(HEAVY_KG, seed) for seed in range(options.seeds)]
    known = list_true_modes(heavy[0])
    rows.append(describe_identifications([field.record for field in heavy], known, f"drop of {HEAVY_KG:g} kg"))
    print_table(heads, rows)
    light = [try_identification(simulate_drop(LIGHT_KG, seed).record) for seed in range(options.seeds)]
    modes = [found for found in light if not isinstance(found, str)]
    heads = ["tensions of the line file [%]", "coefficients contained", "errors [%]", "state of the line"]
    print_table(heads, (list(describe_fits(modes, error)) for error in TENSION_ERRORS))


if __name__ == "__main__":
    main()

"""Coverage of the joint fit of line and damping: lines with wrong tensions and droppers, and noise as stated.

python -m verification.tables.line_coverage RESULTS.csv [--lines 200] [--scenario planted|clamps]

Every line has six unequal spans. Its tensions differ by -3 to +3 % from the line file, three droppers have half their
stiffness, and all other properties scatter by their stated tolerances. Its modes up to 6 Hz at four sensors have the
noise of the measurement and a scatter of the line model. `clamps`: the line file lacks the masses of the dropper
clamps. Fits that RESULTS.csv holds already are not repeated.
"""

import argparse
import csv
from collections.abc import Iterator
from dataclasses import replace
from itertools import accumulate
from pathlib import Path

import numpy as np
import scipy

from pantocheck.conformance import open_case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.drops.damping_results import FitOptions, build_damping_results
from pantocheck.conformance.drops.mode_groups import assign_groups
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_parameters import MECHANICAL, scale_line
from pantocheck.conformance.results.damping_format import DampingResults
from pantocheck.conformance.results.identified_modes import Mode, SensorShape
from pantocheck.model import Catenary, Kind, Rayleigh, discretise
from pantocheck.model.modal.modes import compute_modes_below, damping_ratios, deflection_at

SPANS = (63.0, 63.0, 58.5, 63.0, 54.0, 63.0)
SENSORS = (("CW", 195.75), ("CW", 144.0), ("MW", 272.25), ("MW", 96.75))
WIRES = {"CW": "contact wire", "MW": "messenger wire"}
ELEMENT, HIGHEST = 0.75, 6.0
DAMPING = {Kind.CONTACT_WIRE: Rayleigh(0.055, 5e-5), Kind.MESSENGER_WIRE: Rayleigh(0.075, 8e-5)}
TENSION_ERROR = 0.03
TOLERANCES = np.array([0.02, 0.02, 0.1, 0.1, 0.1, 0.05])
"""Stated tolerances of `MECHANICAL` [-]."""
NOISE, SCATTER = {"frequency": 5e-5, "ratio": 0.003}, {"frequency": 2e-4, "ratio": 0.005, "shape": 0.01}
"""Relative standard deviations of the measurement, and of the line model."""
CLAMPS = (0.195, 0.165)
"""Masses of the clamps on messenger and contact wire [kg]."""


def build_line() -> Catenary:
    """Line of unequal spans with the data of Vo Van et al. (2015), as its file states it."""
    line = open_case("vovan2015/mass-drop/printed").case.line
    catenary = build_catenary(line)
    ends, moved = np.array(line.geometry.span_limits), np.array([0.0, *accumulate(SPANS)])

    def move(parts: tuple) -> tuple:
        return tuple(replace(part, position=float(np.interp(part.position, ends, moved))) for part in parts)

    clamps = {"upper_clamp_mass": CLAMPS[0], "lower_clamp_mass": CLAMPS[1]}
    return replace(
        catenary,
        wires=tuple(replace(wire, end=float(moved[-1]), stagger=None) for wire in catenary.wires),
        droppers=tuple(replace(dropper, **clamps) for dropper in move(catenary.droppers)),
        steady_arms=move(catenary.steady_arms),
        messenger_supports=move(catenary.messenger_supports),
        damping=DAMPING,
        modal_damping=(),
    )


def plant_errors(line: Catenary, random: np.random.Generator) -> tuple[Catenary, RealArray]:
    """Built line, and the factors of its properties on the stated ones."""
    factors = 1 + TOLERANCES * random.standard_normal(len(MECHANICAL))
    factors[:2] = 1 + random.uniform(-TENSION_ERROR, TENSION_ERROR, 2)
    built = scale_line(line, MECHANICAL, factors.tolist())
    wrong = set(random.choice(len(line.droppers), 3, replace=False).tolist())
    droppers = (
        replace(dropper, stiffness=(dropper.stiffness or 0.0) / 2) if number in wrong else dropper
        for number, dropper in enumerate(built.droppers)
    )
    return replace(built, droppers=tuple(droppers)), factors


def measure_modes(line: Catenary, random: np.random.Generator) -> tuple[Mode, ...]:
    """Modes of a line with the noise of the measurement and the scatter of the line model."""
    mesh = discretise(line, ELEMENT, tuple(x for _, x in SENSORS))
    modes = compute_modes_below(mesh, HIGHEST)
    ratios = damping_ratios(mesh, modes)
    rows = [deflection_at(mesh, modes, mesh.mesh.row_of[WIRES[wire], "z"], x) for wire, x in SENSORS]
    found = []
    for frequency, ratio, shape in zip(modes.frequency, ratios, np.array(rows).T, strict=True):
        errors = [
            np.hypot(NOISE[key], SCATTER[key]) * float(random.standard_normal()) for key in ("frequency", "ratio")
        ]
        noisy = shape / shape[np.abs(shape).argmax()] + SCATTER["shape"] * random.standard_normal(len(SENSORS))
        sensors = (
            SensorShape(sensor=number, wire=wire, position_m=x, re=float(value), im=0.0, std=1e-3)
            for number, ((wire, x), value) in enumerate(zip(SENSORS, noisy, strict=True), 1)
        )
        found.append(
            Mode(
                frequency_Hz=float(frequency) * (1 + errors[0]),
                frequency_std_Hz=NOISE["frequency"] * float(frequency),
                damping_ratio=float(ratio) * (1 + errors[1]),
                damping_ratio_std=NOISE["ratio"] * float(ratio),
                sensor_shape=tuple(sensors),
            )
        )
    return assign_groups(found, len(SPANS))


def fit_planted(line: Catenary, stated: Catenary, seed: int) -> tuple[DampingResults, RealArray]:
    """Fit of one line with planted errors, and its true factors; the line file is `stated`."""
    random = np.random.default_rng(seed)
    built, factors = plant_errors(line, random)
    options = FitOptions(tolerances=np.diag(TOLERANCES**2))
    return build_damping_results(measure_modes(built, random), stated, ELEMENT, "modes", options), factors


def list_intervals(results: DampingResults, factors: RealArray) -> Iterator[tuple[str, float, float, float]]:
    """Name, lower end, value and upper end of every unknown over its true value."""
    for row, true in zip(results.properties, factors, strict=False):
        yield row.name, row.low_95 / true, row.factor / true, row.high_95 / true
    for c in results.coefficients:
        true = getattr(DAMPING[Kind(c.kind)], f"{c.matrix}_coefficient")
        yield f"{c.kind}_{c.matrix}_coefficient", c.low_95 / true, c.value / true, c.high_95 / true


def print_coverage(path: Path) -> None:
    """Table of the coverage of each unknown, with its Clopper-Pearson interval."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    table = []
    for name in dict.fromkeys(row["name"] for row in rows):
        own = np.array([[float(row[key]) for key in ("low", "value", "high")] for row in rows if row["name"] == name])
        inside = int(np.sum((own[:, 0] <= 1) & (own[:, 2] >= 1)))
        sure = scipy.stats.binomtest(inside, len(own)).proportion_ci()
        error, width = np.sqrt(np.mean((own[:, 1] - 1) ** 2)), np.median(own[:, 2] - own[:, 0]) / 2
        table.append(
            [
                name.replace("_", " "),
                f"{len(own)}",
                f"{100 * inside / len(own):.1f} ({100 * sure.low:.1f} to {100 * sure.high:.1f})",
                f"{100 * width:.2f}",
                f"{width / (1.96 * error):.2f}",
            ]
        )
    contradicted = {row["seed"] for row in rows if row["state"] == "contradicted"}
    open_groups = {row["seed"] for row in rows if int(row["unexplained"])}
    count = len({row["seed"] for row in rows})
    print(
        "| unknown | intervals | contain the truth [%] | half-width [%] | over 1.96 rms error |\n|---|--:|--:|--:|--:|"
    )
    for cells in table:
        print(f"| {' | '.join(cells)} |")
    print(f"\n{len(contradicted)} of {count} lines contradicted; {len(open_groups)} with an unexplained group")


def main() -> None:
    """Fit the lines that the file does not hold, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path)
    parser.add_argument("--lines", type=int, default=200)
    parser.add_argument("--scenario", choices=("planted", "clamps"), default="planted")
    options = parser.parse_args()
    line = build_line()
    bare = tuple(replace(dropper, upper_clamp_mass=0.0, lower_clamp_mass=0.0) for dropper in line.droppers)
    stated = line if options.scenario == "planted" else replace(line, droppers=bare)
    keys = ["seed", "state", "unexplained", "name", "low", "value", "high"]
    done: set[int] = set()
    if options.results.exists():
        with options.results.open(newline="") as file:
            done = {int(row["seed"]) for row in csv.DictReader(file)}
    else:
        options.results.write_text(",".join(keys) + "\n")
    for seed in sorted(set(range(options.lines)) - done):
        results, factors = fit_planted(line, stated, seed)
        unexplained = sum(not row.explained for row in results.groups)
        with options.results.open("a", newline="") as file:
            for name, *interval in list_intervals(results, factors):
                cells = [f"{value:.6g}" for value in interval]
                csv.writer(file).writerow([seed, results.line.state, unexplained, name, *cells])
    print_coverage(options.results)


if __name__ == "__main__":
    main()

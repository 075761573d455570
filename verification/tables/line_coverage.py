"""Coverage of the joint fit of line and damping: lines with wrong tensions and droppers, and noise as stated.

python -m verification.tables.line_coverage RESULTS.csv [--planted 200] [--clamps 60]

Every line has six unequal spans. Its tensions differ by -3 to +3 % from the line file, three droppers have half their
stiffness, and all other properties scatter by their stated tolerances. Its modes up to 6 Hz at four sensors have the
noise of the measurement and a scatter of the line model. In the scenario `clamps`, the line file lacks the masses of
the dropper clamps. Line s of a scenario has the seed s. RESULTS.csv has one row for each line; lines that it holds are
not repeated. The smallest width with correct coverage is the 95 % quantile of the errors; outcomes as in
verification/tables/interval_share.py.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import accumulate
from pathlib import Path

import numpy as np

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
from verification.tables.interval_share import SHARE_COLUMNS, IntervalShare, append_row, print_table, read_rows

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
SCENARIOS = {"planted": 200, "clamps": 60}
"""Scenarios and their numbers of lines."""


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
    return soften_droppers(scale_line(line, MECHANICAL, factors.tolist()), random), factors


def soften_droppers(line: Catenary, random: np.random.Generator) -> Catenary:
    """Line with half the stiffness in three droppers."""
    wrong = set(random.choice(len(line.droppers), 3, replace=False).tolist())
    droppers = (
        replace(dropper, stiffness=(dropper.stiffness or 0.0) / 2) if number in wrong else dropper
        for number, dropper in enumerate(line.droppers)
    )
    return replace(line, droppers=tuple(droppers))


def measure_modes(line: Catenary, random: np.random.Generator, element: float = ELEMENT) -> tuple[Mode, ...]:
    """Modes of a line with the noise of the measurement and the scatter of the line model."""
    mesh = discretise(line, element, tuple(x for _, x in SENSORS))
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


def fit_row(scenario: str, seed: int) -> dict[str, object]:
    """Row of the store for one line."""
    line = build_line()
    bare = tuple(replace(dropper, upper_clamp_mass=0.0, lower_clamp_mass=0.0) for dropper in line.droppers)
    results, factors = fit_planted(line, line if scenario == "planted" else replace(line, droppers=bare), seed)
    row: dict[str, object] = {"scenario": scenario, "line": seed, "state": results.line.state}
    row["unexplained"] = sum(not group.explained for group in results.groups)
    for name, *interval in list_intervals(results, factors):
        row |= {f"{name}_{key}": f"{value:.6g}" for key, value in zip(("low", "value", "high"), interval, strict=True)}
    return row


def describe_unknowns(rows: Sequence[Mapping[str, str]], scenario: str) -> Iterator[list[str]]:
    """Table rows of a scenario, one for each unknown."""
    names = [key.removesuffix("_value") for key in (rows[0] if rows else ()) if key.endswith("_value")]
    for name in names:
        low, value, high = (np.array([float(row[f"{name}_{key}"]) for row in rows]) for key in ("low", "value", "high"))
        width = float(np.median(high - low)) / 2
        smallest = float(np.quantile(np.abs(value - 1), 0.95))
        share = IntervalShare(len(rows), int(np.sum((low <= 1) & (high >= 1))), width / smallest)
        yield [scenario, name.replace("_", " "), share.text, f"{100 * width:.2f}", share.outcome]


def main() -> None:
    """Fit the lines that the file does not hold, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path, metavar="RESULTS.csv")
    for scenario, count in SCENARIOS.items():
        parser.add_argument(f"--{scenario}", type=int, default=count, help="number of lines; default: %(default)s")
    options = parser.parse_args()
    done = {(row["scenario"], int(row["line"])) for row in read_rows(options.results)}
    for scenario in SCENARIOS:
        for seed in range(getattr(options, scenario)):
            if (scenario, seed) not in done:
                append_row(options.results, fit_row(scenario, seed))
    stored = read_rows(options.results)
    by_name = {scenario: [row for row in stored if row["scenario"] == scenario] for scenario in SCENARIOS}
    heads = ["scenario", "unknown", SHARE_COLUMNS, "half-width [%]", "outcome"]
    print_table(heads, (cells for name, rows in by_name.items() for cells in describe_unknowns(rows, name)))
    for name, rows in by_name.items():
        contradicted = sum(row["state"] == "contradicted" for row in rows)
        unexplained = sum(row["unexplained"] != "0" for row in rows)
        print(f"{name}: {contradicted} of {len(rows)} lines contradicted; {unexplained} with an unexplained group")


if __name__ == "__main__":
    main()

"""Mean contact force of a DSA380 under its applied forces, on a level line and on a gradient (docs/force-law.md).

python -m verification.tables.law_balance [--element 0.5]

On a settled line the pantograph rises by the slope s per length, so that the balance of its momentum is

    mean(F)  =  static + aerodynamic force - c_0 s v - k_0 (mean(z) - z_0),

with base damper c_0, base spring k_0, speed v, and the height z_0 at which the base spring is without force.
"""

import argparse
from dataclasses import dataclass, replace

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.geometry import GradientTable, ListedSpans
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.conformance.runs.uplift_tuning import compute_working_height
from pantocheck.model import DiscretisedLine, discretise

PUBLISHED = {
    200: 102.0067, 225: 112.5447, 250: 124.1063, 275: 136.7765, 300: 150.2277, 325: 165.5950, 350: 181.0144,
    375: 197.8894, 400: 215.3386,
}  # fmt: skip
"""Mean contact force [N] by speed [km/h], simulated by the authors of wang2016 on a line of 48 m spans with
irregularity (trust: secondary)."""
TOLERANCE_N = 0.5
"""Largest difference from the balance of momentum, the tolerance of the case [N]."""
SLOPES = (-0.002, -0.001, 0.001, 0.002)
SPEEDS_ON_SLOPES = (200, 300, 400)


@dataclass(frozen=True)
class MeanForce:
    """Simulated mean contact force and that of the balance of momentum."""

    static: float
    aerodynamic: float
    """Applied forces [N]."""
    balance: float
    """Mean contact force by the balance of momentum [N]."""
    simulated: float
    """Mean contact force over the analysis section [N]."""

    @property
    def difference(self) -> float:
        """Simulated value less that of the balance [N]."""
        return self.simulated - self.balance


def compute_mean_force(case: Case, line: DiscretisedLine, slope: float) -> MeanForce:
    """Mean contact force of the pantograph of a case on a line with one slope.

    Args:
        case: Case with one pantograph and a law of its applied forces.
        line: Line of the case.
        slope: Slope of the contact wire [-].
    """
    (lift,), (file,) = case.lift_forces, case.pantographs
    record = run_passage(case, line, case.file.discretisation).record
    start, end = case.analysis_section
    inside = (record.position[0] >= start) & (record.position[0] < end)
    if file.chain is None or record.contact_height is None:
        raise ValueError("the balance needs a chain and contact heights")
    rise = record.contact_height[0, inside].mean() - compute_working_height(case, line, file, lift.uplift_force)
    base_force = file.chain.damping_N_s_m[0] * slope * case.speed + file.chain.stiffness_N_m[0] * rise
    simulated = float(record.force[0, inside].mean())
    return MeanForce(lift.static_force, lift.aerodynamic_force, lift.uplift_force - base_force, simulated)


def build_line(case: Case, slope: float) -> LineFile:
    """Line of a case whose contact wire rises by a slope over its whole length."""
    if slope == 0:
        return case.line
    geometry = case.line.geometry
    tables = geometry.model_dump(exclude={"span_m", "spans", "provisional"}) | {
        "span_list": [{"length_m": length} for length in geometry.span_lengths],
        "gradient": [GradientTable(from_m=0.0, to_m=geometry.length, slope=slope)],
    }
    return LineFile.model_validate(dict(case.line) | {"geometry": ListedSpans.model_validate(tables)})


def compute_at_speeds(case: Case, slope: float, speeds: tuple[int, ...]) -> dict[int, MeanForce]:
    """Mean contact force by speed [km/h] on the line of a case with a slope."""
    sloped = replace(case, line=build_line(case, slope))
    line = discretise(build_catenary(sloped.line), case.file.discretisation.element_m)
    files = {speed: case.file.model_copy(update={"speed_km_h": float(speed)}) for speed in speeds}
    return {speed: compute_mean_force(replace(sloped, file=file), line, slope) for speed, file in files.items()}


def print_level(case: Case) -> list[MeanForce]:
    """Print the mean contact forces on the level line, with the published column for information."""
    columns = ("km/h", "static [N]", "aerodynamic [N]", "sum [N]", "simulated [N]", "to sum", "published [N]", "to sum")
    print(f"| {' | '.join(columns)} |")
    print("| --: | --: | --: | --: | --: | --: | --: | --: |")
    forces = compute_at_speeds(case, 0.0, tuple(PUBLISHED))
    for speed, force in forces.items():
        total, published = force.static + force.aerodynamic, PUBLISHED[speed]
        numbers = (force.static, force.aerodynamic, total, force.simulated)
        texts = [*(f"{number:.2f}" for number in numbers), f"{force.simulated - total:+.3f}"]
        print(f"| {speed} | {' | '.join(texts)} | {published:.2f} | {published - total:+.2f} |", flush=True)
    return list(forces.values())


def print_slopes(case: Case) -> list[MeanForce]:
    """Print the mean contact forces on slopes, and those of the balance of momentum."""
    print("\n| slope | km/h | applied [N] | balance [N] | simulated [N] | difference [N] |")
    print("| --: | --: | --: | --: | --: | --: |")
    forces = []
    for slope in SLOPES:
        for speed, force in compute_at_speeds(case, slope, SPEEDS_ON_SLOPES).items():
            numbers = (force.static + force.aerodynamic, force.balance, force.simulated)
            texts = [*(f"{number:.2f}" for number in numbers), f"{force.difference:+.3f}"]
            print(f"| {1000 * slope:+g} mm/m | {speed} | {' | '.join(texts)} |", flush=True)
            forces.append(force)
    return forces


def main() -> None:
    """Run and print; end with 1 if a difference exceeds the tolerance."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "--element", type=float, default=0.5, help="element length [m]; the time step is 2 ms per metre"
    )
    element = parser.parse_args().element
    (case,) = select_cases(["force-law/300"])
    mesh = {"element_m": element, "time_step_s": 0.002 * element}
    file = case.file.model_copy(update={"discretisation": case.file.discretisation.model_copy(update=mesh)})
    forces = [*print_level(replace(case, file=file)), *print_slopes(replace(case, file=file))]
    largest = float(np.abs([force.difference for force in forces]).max())
    print(f"\nlargest difference from the balance of momentum: {largest:.3f} N")
    raise SystemExit(0 if largest <= TOLERANCE_N else 1)


if __name__ == "__main__":
    main()

"""Convergence of both formulations with points and elements: constraint, strips, and every contact law.

    python -m verification.formulations.point_convergence CASE [--spacings 0.25 0.125 0.0625]
        [--elements 0.5 0.25 0.125] [--law constraint] [--pantograph FILE] [--spans 5]

Each halving has its row, the last row is their limit.
"""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.pantograph.pantograph_file import ContactTable, PantographFile
from pantocheck.conformance.runs.command_system import build_case_message
from verification.formulations.difference_passage import Quantities, difference_quantities
from verification.formulations.finite_differences import AIMED, find_case, reference_quantities, uplift_forces
from verification.formulations.parallel_wires import merge_parallel_wires

STEP_PER_ELEMENT = 2e-3
"""Time step over the length of an element [s/m]."""


def extrapolate(values: Sequence[float]) -> float:
    """Limit of the values at halved steps, with the order of the last two differences, at most 2.

    Values that oscillate have their limit between them; where the differences do not shrink, it is the last value.
    """
    first, last = values[-2] - values[-3], values[-1] - values[-2]
    ratio = first / last if last else np.inf
    if abs(ratio) <= 1:
        return values[-1]
    return values[-1] + last / (min(ratio, 4.0) - 1)


def print_table(heading: str, steps: Sequence[float], compute: Callable[[float], Quantities]) -> list[float]:
    """Print the values of the first pantograph at every step, and return their limits."""
    print(f"\n| {heading} [m] | {' | '.join(AIMED)} |\n| --: |{' --: |' * len(AIMED)}", flush=True)
    rows = []
    for step in steps:
        quantities = compute(step)
        rows.append([quantities[1, name] for name in AIMED])
        print(f"| {step:g} | {' | '.join(f'{value:.3f}' for value in rows[-1])} |", flush=True)
    limits = [extrapolate(column) for column in zip(*rows, strict=True)]
    print(f"| limit | {' | '.join(f'{value:.3f}' for value in limits)} |", flush=True)
    return limits


def shorten(case: Case, spans: int) -> Case:
    """Case on the first spans of its line, with the second and third one as its section."""
    section = {"evaluated_spans": (2, 3), "compared_spans": None, "start_m": 20.0, "run_out_m": 70.0}
    line = case.line.model_copy(update={"geometry": case.line.geometry.shorten(spans)})
    return replace(case, line=line, file=case.file.model_copy(update=section))


def main() -> None:
    """Run and print."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("case", metavar="CASE")
    options.add_argument("--spacings", type=float, nargs="+", default=(0.25, 0.125, 0.0625))
    options.add_argument("--elements", type=float, nargs="+", default=(0.5, 0.25, 0.125))
    options.add_argument("--law", choices=("spring", "constraint"), default="spring", help="contact of the pantograph")
    options.add_argument("--pantograph", type=Path, help="pantograph file in place of that of the case")
    options.add_argument("--spans", type=int, help="number of spans of a short passage; default: the case itself")
    chosen = options.parse_args()
    case = find_case(chosen.case)
    forces = uplift_forces(case)
    file = read_model(chosen.pantograph, PantographFile, "pantograph") if chosen.pantograph else case.pantographs[0]
    if chosen.law == "constraint":
        file = file.model_copy(update={"contact": ContactTable(law="constraint")})
    case = replace(case, pantographs=(file,) * len(case.pantographs))
    case = case if chosen.spans is None else shorten(case, chosen.spans)
    message = build_case_message(merge_parallel_wires(case))
    points = print_table("points", chosen.spacings, lambda h: difference_quantities(message, h, forces))
    elements = print_table(
        "elements", chosen.elements, lambda h: reference_quantities(case, h, STEP_PER_ELEMENT * h, forces)
    )
    differences = (f"{100 * (a / b - 1):+.2f}" for a, b in zip(points, elements, strict=True))
    print(f"\nPoints against elements [%]: {', '.join(differences)}")


if __name__ == "__main__":
    main()

"""Discretisation error of library cases at the default mesh, for every pantograph (docs/convergence.md).

python -m verification.tables.convergence_of_cases [CASE ...]

The uplift forces are those of the default mesh. The reference has elements and time steps of a quarter.
"""

import argparse
import time

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.model import Catenary, discretise
from verification.speed.passage_lines import ALLOWED_PCT, QUANTITIES, vertical

CASES = (
    "en50318-2002/250",
    "en50318-2002/300",
    "en50318-2018/ac-simple/275",
    "en50318-2018/ac-simple/275-twin",
    "en50318-2018/ac-simple/320",
    "en50318-2018/ac-simple/320-twin",
    "en50318-2018/ac-stitched/275",
)


def compute_values(
    case: Case, built: Catenary, factor: int, forces: tuple[float, ...] | None
) -> tuple[dict[int, dict[str, float]], tuple[float, ...]]:
    """Quantities by pantograph with element and time step divided by a factor, and the uplift forces [N]."""
    default = case.file.discretisation
    mesh = {"element_m": default.element_m / factor, "time_step_s": default.time_step_s / factor}
    discretisation = default.model_copy(update=mesh)
    run = run_passage(case, discretise(built, discretisation.element_m), discretisation, forces)
    values = evaluate_record(run.record, case.file.filter, case.line.geometry.supports).values
    line = values.pop(0)
    quantities = {number: {name: {**line, **own}[name] for name in QUANTITIES} for number, own in values.items()}
    return {n: {name: float(value) for name, value in own.items()} for n, own in quantities.items()}, run.uplift_forces


def print_errors(name: str, case: Case, built: Catenary) -> list[str]:
    """Print the errors of one case and return the quantities above the target."""
    coarse, forces = compute_values(case, built, 1, None)
    fine, _ = compute_values(case, built, 4, forces)
    above = []
    for number, values in fine.items():
        errors = {q: 100 * (coarse[number][q] / value - 1) if value else 0.0 for q, value in values.items()}
        print(f"| {name} | {number} | {' | '.join(f'{error:+.2f}' for error in errors.values())} |", flush=True)
        above += [f"{name}, pantograph {number}: {q} {e:+.2f} %" for q, e in errors.items() if abs(e) > ALLOWED_PCT[q]]
    return above


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("cases", nargs="*", default=CASES, metavar="CASE")
    begin, above = time.process_time(), []
    print(f"| case | pantograph | {' | '.join(QUANTITIES)} |\n| :-- | --: |{' --: |' * len(QUANTITIES)}")
    for identity in parser.parse_args().cases:
        (case,) = (case for case in select_cases([identity]) if case.id == identity)
        built = build_catenary(case.line)
        above += print_errors(identity, case, built)
        if identity == "en50318-2018/ac-simple/320-twin":
            state = discretise(built, case.file.discretisation.element_m).state
            above += print_errors(f"{identity}, vertical plane", case, vertical(case, state))
    print(f"\nAbove the target: {'; '.join(above) or 'none'}.")
    print(f"\n{time.process_time() - begin:.0f} s of process time.")


if __name__ == "__main__":
    main()

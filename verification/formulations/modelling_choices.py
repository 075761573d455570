"""Change of the verified quantities by choices that a case leaves open, or that simulators differ in.

python -m verification.formulations.modelling_choices [CASE ...]

Prints one table per case for docs/verification.md. Every run has the uplift forces of the first one. Extremes are
counted from the mean contact force, as their tolerances are.
"""

import argparse
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from pantocheck.conformance.app.self_test.numerical_faults import leave_out_residual_flexibility
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.grading.case_verification import EXTREMES, RELATIVE
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.model import Catenary, DiscretisedLine, discretise
from pantocheck.model.discretisation.discretised_line import keep_viscous_part

CASES = ("en50318-2002/250", "en50318-2002/300", "en50318-2018/ac-simple/320-twin")
SHOWN = [name for name in (*RELATIVE, *EXTREMES) if not name.startswith(("elasticity", "statistical"))]
Quantities = dict[tuple[int, str], float]
"""Values by pantograph, 0 for the line, and name."""
Runner = Callable[[Case, tuple[float, ...]], Quantities]
"""Run of a case with a choice, at given uplift forces."""


def simulate(
    case: Case,
    forces: tuple[float, ...],
    change_catenary: Callable[[Catenary], Catenary] = lambda catenary: catenary,
    change_line: Callable[[DiscretisedLine], DiscretisedLine] = lambda line: line,
) -> Record:
    """Record of a case whose line is changed before or after its discretisation."""
    discretisation = case.file.discretisation
    line = change_line(discretise(change_catenary(build_catenary(case.line)), discretisation.element_m))
    return run_passage(case, line, discretisation, forces).record


def evaluate(case: Case, record: Record, low_pass: Filter | None = None) -> Quantities:
    """Verified quantities of a record."""
    found = evaluate_record(record, low_pass or case.file.filter, case.line.geometry.supports).values
    return {(owner, name): float(values[name]) for owner, values in found.items() for name in SHOWN if name in values}


def with_filter(**changes: object) -> Runner:
    """Another filter."""
    return lambda case, forces: evaluate(case, simulate(case, forces), case.file.filter.model_copy(update=changes))


def with_catenary(change: Callable[[Catenary], Catenary]) -> Runner:
    """Another description of the line."""
    return lambda case, forces: evaluate(case, simulate(case, forces, change_catenary=change))


def with_line(change: Callable[[DiscretisedLine], DiscretisedLine]) -> Runner:
    """Another treatment of the discretised line."""
    return lambda case, forces: evaluate(case, simulate(case, forces, change_line=change))


def with_mesh(element: float, step: float) -> Runner:
    """Another element length [m] and time step [s]."""

    def run(case: Case, forces: tuple[float, ...]) -> Quantities:
        mesh = case.file.discretisation.model_copy(update={"element_m": element, "time_step_s": step})
        changed = replace(case, file=case.file.model_copy(update={"discretisation": mesh}))
        return evaluate(case, simulate(changed, forces))

    return run


def with_start(shift: float) -> Runner:
    """A start at another place [m]."""

    def run(case: Case, forces: tuple[float, ...]) -> Quantities:
        changed = replace(case, file=case.file.model_copy(update={"start_m": case.start + shift}))
        return evaluate(case, simulate(changed, forces))

    return run


def with_rate(every: int) -> Runner:
    """A record of every n-th sample, after a low-pass at 0.4 of its rate."""

    def run(case: Case, forces: tuple[float, ...]) -> Quantities:
        record = simulate(case, forces)
        low_pass = Filter(order=8, cutoff_Hz=0.4 * record.rate / every)
        force = np.array([low_pass(channel, record.rate) for channel in record.force])
        thinned = {name: getattr(record, name)[:, ::every] for name in ("position", "contact_height", "support_uplift")}
        return evaluate(case, replace(record, time=record.time[::every], force=force[:, ::every], **thinned))

    return run


def soften_arms(catenary: Catenary) -> Catenary:
    """Give an arm the stiffness of the contact wire's tension and angle alone: droppers do not pull at it sideways."""
    wire, arms = catenary.contact_wires[0], []
    for arm in catenary.steady_arms:
        if arm.vertical_stiffness is None and arm.length and wire.stagger is not None:
            span = catenary.steady_arms[1].position - catenary.steady_arms[0].position
            angle = 4 * float(np.abs(np.array(wire.stagger)[..., -1]).max()) / span
            arms.append(replace(arm, vertical_stiffness=wire.tension * angle / arm.length))
        else:
            arms.append(arm)
    return replace(catenary, steady_arms=tuple(arms))


def remove_bending(catenary: Catenary) -> Catenary:
    """Wires as strings: a hundredth of their bending stiffness."""
    wires = tuple(replace(wire, bending_stiffness=0.01 * wire.bending_stiffness) for wire in catenary.wires)
    return replace(catenary, wires=wires)


CHOICES: dict[str, Runner] = {
    "filter of order 4 instead of 6": with_filter(order=4),
    "filter of order 8": with_filter(order=8),
    "causal filter": with_filter(phase="causal"),
    "200 samples per second": with_rate(5),
    "start 10 m later": with_start(10.0),
    "dashpots of slack droppers act": with_line(keep_viscous_part),
    "arm without sideways pull of droppers": with_catenary(soften_arms),
    "wires without bending stiffness": with_catenary(remove_bending),
    "elements of 1 m, 2 ms": with_mesh(1.0, 2e-3),
    "no residual flexibility": with_line(leave_out_residual_flexibility),
}
"""Choices by name."""


def print_table(case: Case) -> None:
    """Print the change of every quantity by every choice [%]; of several pantographs the largest."""
    start = run_passage(
        case, discretise(build_catenary(case.line), case.file.discretisation.element_m), case.file.discretisation
    )
    forces = start.uplift_forces
    base = evaluate(case, start.record)
    print(f"\n### {case.id}\n\n| choice | {' | '.join(SHOWN)} |\n| :-- |{' --: |' * len(SHOWN)}")
    for name, run in CHOICES.items():
        changed = run(case, forces)
        cells = []
        for quantity in SHOWN:
            changes = [
                100 * (changed[owner, known] - value) / abs(value - (base[owner, "mean_force_N"] if extreme else 0.0))
                for (owner, known), value in base.items()
                if known == quantity
                for extreme in [quantity in EXTREMES]
            ]
            cells.append(f"{max(changes, key=abs):+.2f}")
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


def main() -> None:
    """Run and print."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("cases", nargs="*", default=CASES, metavar="CASE")
    names = options.parse_args().cases
    known = {case.id: case for case in select_cases(names)}
    for name in names:
        print_table(known[name])


if __name__ == "__main__":
    main()

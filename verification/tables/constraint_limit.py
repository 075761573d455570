"""Constraint against the limit of a stiff spring, by mesh: the table of docs/contact-laws.md.

    python -m verification.tables.constraint_limit [CASE ...]

Both limits are those of elements of 0.5, 0.25 and 0.125 m. The uplift forces are those of the case with its own spring.
"""

import sys

from pantocheck.conformance.pantograph.pantograph_file import ContactTable
from verification.formulations.finite_differences import AIMED, find_case, reference_quantities, uplift_forces
from verification.formulations.library_passages import PASSAGES
from verification.formulations.point_convergence import STEP_PER_ELEMENT, extrapolate
from verification.tables.input_variations import change_contact

ELEMENTS = (0.5, 0.25, 0.125)
"""Element lengths; the first is that of the cases [m]."""
LAWS = (ContactTable(stiffness_N_m=1e8), ContactTable(law="constraint"))
HEADS = (
    "case (pantograph)",
    "spring of 1e8 N/m, limit [N]",
    "spring, 0.5 m [%]",
    "constraint, 0.5 m [%]",
    "constraint, 0.125 m [%]",
    "constraint, limit [%]",
)


def main(names: list[str]) -> None:
    """Run and print standard deviation and bands of every pantograph, a case as soon as it is known."""
    print(f"| {' | '.join(HEADS)} |\n|---{'|--:' * (len(HEADS) - 1)}|", flush=True)
    for id_ in names or PASSAGES:
        case = find_case(id_)
        forces = uplift_forces(case)
        runs = [
            [reference_quantities(change_contact(case, law), h, STEP_PER_ELEMENT * h, forces) for h in ELEMENTS]
            for law in LAWS
        ]
        for number in range(1, len(forces) + 1):
            spring, constraint = (
                [[run[number, name] for run in runs_of_law] for name in AIMED] for runs_of_law in runs
            )
            limits = [extrapolate(values) for values in spring]
            compared = (
                [values[0] for values in spring],
                [values[0] for values in constraint],
                [values[-1] for values in constraint],
                [extrapolate(values) for values in constraint],
            )
            cells = ["/".join(f"{limit:.2f}" for limit in limits)]
            cells += [_deviations(row, limits) for row in compared]
            which = f" ({number})" if len(forces) > 1 else ""
            print(f"| {id_}{which} | {' | '.join(cells)} |", flush=True)


def _deviations(values: list[float], limits: list[float]) -> str:
    """Deviations of values from their limits [%]."""
    return "/".join(f"{100 * (value / limit - 1):+.2f}" for value, limit in zip(values, limits, strict=True))


if __name__ == "__main__":
    main(sys.argv[1:])

"""Constraint against the limit of a stiff spring, by mesh: the table of docs/contact-laws.md.

    python -m verification.tables.constraint_limit [CASE ...]

Standard deviation, 0-5, 5-20 and 20-50 Hz of every pantograph. Limits are those of elements of 0.5, 0.25 and 0.125 m.
The uplift forces are those of the case with its own spring. The half-width is that of the suite for this mesh.
"""

import sys

from pantocheck.conformance.grading.case_evaluation import discretisation_half_width
from pantocheck.conformance.pantograph.pantograph_file import ContactTable
from verification.formulations.finite_differences import AIMED, find_case, reference_quantities, uplift_forces
from verification.formulations.library_passages import PASSAGES
from verification.formulations.point_convergence import STEP_PER_ELEMENT, extrapolate
from verification.tables.input_variations import change_contact

ELEMENTS = (1.0, 0.5, 0.25, 0.125)
"""Element lengths; the second is that of the cases [m]."""
LAWS = (ContactTable(stiffness_N_m=1e8), ContactTable(law="constraint"))
HEADS = (
    "case",
    "spring of 1e8 N/m, limit [N]",
    "spring, 0.5 m [%]",
    "constraint, 0.5 m [%]",
    "its half-width by mesh [%]",
    "constraint, limit [%]",
)


def main(names: list[str]) -> None:
    """Run and print, a case as soon as it is known; of a case with two pantographs only on request."""
    print(f"| {' | '.join(HEADS)} |\n|---{'|--:' * (len(HEADS) - 1)}|", flush=True)
    for id_ in names or [name for name in PASSAGES if not name.endswith("twin")]:
        case = find_case(id_)
        forces = uplift_forces(case)
        runs = [
            [reference_quantities(change_contact(case, law), h, STEP_PER_ELEMENT * h, forces) for h in ELEMENTS]
            for law in LAWS
        ]
        for number in range(1, len(forces) + 1):
            spring, constraint = ([[run[number, name] for run in law] for name in AIMED] for law in runs)
            limits = [extrapolate(values) for values in spring]
            changes = [
                [100 * (value / limit - 1) for value, limit in zip(row, limits, strict=True)]
                for row in (
                    [values[1] for values in spring],
                    [values[1] for values in constraint],
                    [extrapolate(values) for values in constraint],
                )
            ]
            widths = [100 * discretisation_half_width(*values[:3]) / values[1] for values in constraint]
            cells = ["/".join(f"{change:+.2f}" for change in row) for row in changes]
            cells.insert(2, "/".join(f"{width:.2f}" for width in widths))
            which = f" ({number})" if len(forces) > 1 else ""
            print(
                f"| {id_}{which} | {'/'.join(f'{limit:.2f}' for limit in limits)} | {' | '.join(cells)} |", flush=True
            )


if __name__ == "__main__":
    main(sys.argv[1:])

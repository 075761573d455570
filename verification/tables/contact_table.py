"""Bands of every library passage by contact law, at the mesh of its case: the table of docs/contact-laws.md.

    python -m verification.tables.contact_table [CASE ...]

The uplift forces are those of the case with its own contact spring, so that the law alone changes.
"""

import sys

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.pantograph.pantograph_file import ContactTable
from verification.formulations.finite_differences import reference_quantities, uplift_forces
from verification.formulations.library_passages import PASSAGES
from verification.tables.input_variations import change_contact, list_contacts

STIFFNESSES_KN_M = (20, 100, 200, 1000)
"""Springs in place of that of the case [kN/m]."""
OTHER_PASSAGES = ("force-law/300", "vovan2015/contact-force")
"""Library cases with a train that run on request."""
SHOWN = ("std_force_N", "rms_20_50_N")


def main(names: list[str]) -> None:
    """Run and print, a row as soon as it is known."""
    laws = {f"{k} kN/m": ContactTable(stiffness_N_m=1e3 * k) for k in STIFFNESSES_KN_M} | list_contacts()
    heads = [f"{law} [%]" if number == 0 else law for number, law in enumerate(laws)]
    print(f"| case (pantograph) | its spring [N] | {' | '.join(heads)} |\n|---|---|{'---|' * len(laws)}")
    for id_ in names or (*PASSAGES, *OTHER_PASSAGES):
        case = next(case for case in select_cases([id_]) if case.id == id_)
        forces, mesh = uplift_forces(case), case.file.discretisation
        own = reference_quantities(case, mesh.element_m, mesh.time_step_s, forces)
        changed = [
            reference_quantities(change_contact(case, law), mesh.element_m, mesh.time_step_s, forces)
            for law in laws.values()
        ]
        for number in range(1, len(forces) + 1):
            base = "/".join(f"{own[number, name]:.2f}" for name in SHOWN)
            cells = ("/".join(f"{100 * (v[number, q] / own[number, q] - 1):+.1f}" for q in SHOWN) for v in changed)
            which = f" ({number})" if len(forces) > 1 else ""
            print(f"| {case.id}{which} | {base} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])

"""Bands of every library passage by contact law, at the default mesh: the table of docs/contact-laws.md.

    python -m verification.tables.contact_table [CASE ...]

The uplift forces are those of the case with its own contact spring, so that the law alone changes.
"""

import sys
from dataclasses import replace

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.pantograph.pantograph_file import ContactTable
from verification.formulations.finite_differences import reference_quantities, uplift_forces
from verification.formulations.library_passages import PASSAGES

STIFFNESSES_KN_M = (20, 100, 200, 1000)
"""Springs in place of that of the case [kN/m]."""

COPPER_ON_CARBON = ContactTable(law="hertz", effective_modulus_N_m2=1.1e10, effective_radius_m=0.02)
"""Contact wire of 6 mm radius, E = 120 GN/m2, on a strip of carbon, E = 12 GN/m2, with a crown of 65 mm radius: round
numbers of materials and shapes, not of a product.
"""

SHOWN = ("std_force_N", "rms_0_5_N", "rms_5_20_N", "rms_20_50_N")


def change_contact(case: Case, contact: ContactTable) -> Case:
    """Case with another contact of all pantographs."""
    files = tuple(file.model_copy(update={"contact": contact}) for file in case.pantographs)
    return replace(case, pantographs=files)


def main(names: list[str]) -> None:
    """Run and print, a row as soon as it is known."""
    print("| case | pantograph | contact | " + " | ".join(SHOWN) + " |\n| :-- | --: | :-- |" + " --: |" * len(SHOWN))
    laws = {f"{k} kN/m": ContactTable(stiffness_N_m=1e3 * k) for k in STIFFNESSES_KN_M}
    laws |= {"Hertz": COPPER_ON_CARBON, "constraint": ContactTable(law="constraint")}
    for id_ in names or PASSAGES:
        case = next(case for case in select_cases([id_]) if case.id == id_)
        forces, mesh = uplift_forces(case), case.file.discretisation
        own = reference_quantities(case, mesh.element_m, mesh.time_step_s, forces)
        changed = {
            name: reference_quantities(change_contact(case, law), mesh.element_m, mesh.time_step_s, forces)
            for name, law in laws.items()
        }
        for number in range(1, len(forces) + 1):
            base = " | ".join(f"{own[number, name]:.2f} N" for name in SHOWN)
            print(f"| {case.id} | {number} | its spring | {base} |")
            for name, values in changed.items():
                row = (f"{100 * (values[number, q] / own[number, q] - 1):+.1f} %" for q in SHOWN)
                print(f"| | | {name} | {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])

"""Findings of Table 1 of Vo Van, Balmes and Lorang (2015) by contact: the table of docs/damping-study.md.

    python -m verification.tables.contact_findings

Mesh, mean contact forces and dampings are those of the case; the uplift forces are tuned anew for each contact.
"""

from collections.abc import Mapping
from dataclasses import replace

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.core.verdicts import judge
from pantocheck.conformance.grading.criterion_grading import find_value
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.pantograph.pantograph_file import ContactTable, PantographFile
from pantocheck.conformance.quantities.evaluation import ValuesByOwner
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.studies.vovan2015.damping_change import compare_damping_runs
from verification.tables.input_variations import change_contact, list_contacts, simulate_varied
from verification.tables.table_scenarios import load_study

STIFFNESSES_N_M = {"case": 50e3, "25 kN/m": 25e3, "100 kN/m": 100e3}


def list_cases() -> dict[str, Case]:
    """The case with every contact, its own first, and with a head of two strips."""
    contacts = {name: ContactTable(stiffness_N_m=k) for name, k in STIFFNESSES_N_M.items()} | list_contacts()
    cases = {name: change_contact(load_study(), contact) for name, contact in contacts.items()}
    strips = read_model(library_folder() / "pantographs/two-strips.toml", PantographFile, "pantograph")
    return cases | {"two strips": replace(load_study(), pantographs=(strips,) * len(load_study().pantographs))}


def find_changes(case: Case, treatment: str | None = None) -> ValuesByOwner:
    """Changes by the updated damping, with a treatment of the discretised line."""
    ((name, initial),) = case.dampings.items()
    pair = ((name, initial), ("updated", case.line.damping))
    return compare_damping_runs(*(_simulate(case.with_damping(*model), treatment) for model in pair)).values


def _simulate(case: Case, treatment: str | None) -> RecordSignals:
    return RecordSignals(simulate_varied(case, treatment).record, case.file.filter, case.line.geometry.supports)


def print_findings(changes: Mapping[str, ValuesByOwner]) -> None:
    """Print the value of each finding by contact; a star marks a finding that is not reproduced."""
    print(f"| finding | printed | {' | '.join(changes)} |\n|---|---|{'--:|' * len(changes)}")
    counts = dict.fromkeys(changes, 0)
    for limit in load_study().limits:
        cells = []
        for contact, values in changes.items():
            value = find_value(limit.target, values)
            met = value is not None and judge(value, limit.lower, limit.upper) == "pass"
            counts[contact] += met
            cells.append("-" if value is None else f"{value:.3g}{'' if met else ' *'}")
        assert limit.finding is not None
        print(f"| {limit.finding.sentence} | {limit.finding.printed} | {' | '.join(cells)} |")
    print(f"| reproduced | | {' | '.join(map(str, counts.values()))} |")


if __name__ == "__main__":
    print_findings({name: find_changes(case) for name, case in list_cases().items()})

"""Quantities of passages with pantographs as FMUs, over those of the built-in pantographs: a table of differences.

`python -m verification.fmu.coupling_table [CASE ...]`; each case runs once per row, without refinement.
"""

import sys
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_parts import read_named_pantograph
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.reference_simulator import UnrefinedSimulator
from verification.fmu.fmu_builder import find_missing_tool, write_fmu_pantograph

CASES = ("en50318-2002/250",)
ROWS: dict[str, dict[str, object]] = {
    "FMI 2.0 co-simulation, rollback": {"version": 2},
    "FMI 3.0 co-simulation, rollback": {"version": 3},
    "FMI 2.0 model exchange": {"version": 2, "interface": "model-exchange"},
    "FMI 3.0 co-simulation, without rollback": {"version": 3, "has_state": False},
    "FMI 2.0 co-simulation, ten internal steps": {"version": 2, "parameters": {"substeps": 10.0}},
}
"""Rows, with their FMUs."""


def state_forces(case: Case) -> Case:
    """Case with its stated uplift forces, without a tuning that would hide differences of the mean."""
    uses = tuple(use.model_copy(update={"target_mean_force_N": None}) for use in case.file.pantograph)
    return replace(case, file=case.file.model_copy(update={"pantograph": uses}))


def compare_quantities(first: CaseResult, second: CaseResult) -> tuple[float, str]:
    """Largest relative difference of a quantity of two results, and its name; zero in both agrees."""
    largest, where = 0.0, ""
    for owner, values in first.quantities.items():
        for name, value in values.items():
            pair = np.atleast_1d(value).astype(float), np.atleast_1d(second.quantities[owner][name]).astype(float)
            difference = float((np.abs(pair[0] - pair[1]) / np.maximum(np.abs(pair[0]), 1e-9)).max())
            if difference >= largest:
                largest, where = difference, f"{name}, pantograph {owner}"
    return largest, where


def main(names: Sequence[str]) -> None:
    """Print the table."""
    if (reason := find_missing_tool()) is not None:
        sys.exit(reason)
    print("| case | FMU | largest difference of a quantity | quantity | energy of the coupling / exchanged work |")
    print("| --- | --- | --- | --- | --- |")
    for case in map(state_forces, select_cases(names or CASES)):
        if case.is_static:
            continue
        source = library_folder() / case.id.rpartition("/")[0] / case.file.pantograph[0].model
        expected = grade_case(case, UnrefinedSimulator().run(case), "secondary")
        for row, keys in ROWS.items():
            with tempfile.TemporaryDirectory() as folder:
                file = read_named_pantograph(write_fmu_pantograph(Path(folder), source, **keys))
                moved = replace(case, pantographs=(file,) * len(case.pantographs))
                found = grade_case(moved, UnrefinedSimulator().run(moved), "secondary")
            difference, quantity = compare_quantities(expected, found)
            energy = max(abs(fmu.energy_J) / fmu.exchanged_J for fmu in found.fmus)
            print(f"| {case.id} | {row} | {100 * difference:.4f} % | {quantity} | {energy:.1e} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])

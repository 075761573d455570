"""Quantities of passages with pantographs as FMUs, over those of the built-in pantographs: a table of differences.

`python -m verification.fmu.coupling_table [CASE ...]`; each case runs once per row, without refinement. The first case
has all rows, and one of the active pantograph of the examples: its skyhook without delay and limit is the damper of the
chain in its file. The other cases have the rows of FMI 3.0.
"""

import shutil
import subprocess
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
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.reference_simulator import UnrefinedSimulator
from verification.fmu.fmu_builder import find_missing_tool, write_fmu_pantograph

CASES = ("en50318-2002/250", "en50318-2018/ac-simple/275-twin", "generic/two-strips")
ACTIVE = Path(__file__).parents[2] / "examples" / "active_pantograph"
ROWS: dict[str, dict[str, object]] = {
    "FMI 2.0 co-simulation, rollback": {"version": 2},
    "FMI 3.0 co-simulation, rollback": {"version": 3},
    "FMI 2.0 model exchange": {"version": 2, "interface": "model-exchange"},
    "FMI 3.0 co-simulation, without rollback": {"version": 3, "has_state": False},
    "FMI 2.0 co-simulation, ten internal steps": {"version": 2, "parameters": {"substeps": 10.0}},
}
"""Rows, with their FMUs."""


def state_forces(case: Case) -> Case:
    """Case with its stated or required forces, without a tuning that would hide differences of the mean."""
    uses = tuple(
        use.model_copy(
            update={"target_mean_force_N": None, "uplift_force_N": use.uplift_force_N or use.target_mean_force_N}
        )
        for use in case.file.pantograph
    )
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


def read_active(folder: Path) -> PantographFile:
    """Active pantograph of the examples, built in a folder, whose skyhook has neither delay nor limit."""
    shutil.copytree(ACTIVE, folder, dirs_exist_ok=True)
    subprocess.run([sys.executable, "build.py"], cwd=folder, check=True)
    file = read_named_pantograph(folder / "fmu.toml")
    assert file.fmu is not None
    return file.model_copy(update={"fmu": file.fmu.model_copy(update={"parameters": {"delay": 0.0, "limit": 1e6}})})


def run_unrefined(case: Case, file: PantographFile | None = None) -> CaseResult:
    """Results of a case on its mesh, with a pantograph file in place of its own."""
    moved = case if file is None else replace(case, pantographs=(file,) * len(case.pantographs))
    return grade_case(moved, UnrefinedSimulator().run(moved), "secondary")


def print_row(case: Case, row: str, expected: CaseResult, found: CaseResult) -> None:
    """Print a row of the table."""
    difference, quantity = compare_quantities(expected, found)
    energy = max(abs(fmu.energy_J) / fmu.exchanged_J for fmu in found.fmus)
    print(f"| {case.id} | {row} | {100 * difference:.4f} % | {quantity} | {energy:.1e} |", flush=True)


def main(names: Sequence[str]) -> None:
    """Print the table."""
    if (reason := find_missing_tool()) is not None:
        sys.exit(reason)
    print("| case | FMU | largest difference of a quantity | quantity | energy of the coupling / exchanged work |")
    print("|---|---|--:|---|--:|")
    moving = [state_forces(case) for case in select_cases(names or CASES) if not case.is_static]
    for number, case in enumerate(moving):
        source = (library_folder() / f"{case.id}.toml").parent / case.file.pantograph[0].model
        expected = run_unrefined(case)
        for row, keys in ROWS.items():
            if number and keys["version"] == 2:
                continue
            with tempfile.TemporaryDirectory() as folder:
                file = read_named_pantograph(write_fmu_pantograph(Path(folder), source, **keys))
                print_row(case, row, expected, run_unrefined(case, file))
        if number == 0:
            with tempfile.TemporaryDirectory() as folder:
                active = read_active(Path(folder))
                expected = run_unrefined(case, active.model_copy(update={"fmu": None}))
                print_row(case, "FMI 2.0 co-simulation, rollback, skyhook", expected, run_unrefined(case, active))


if __name__ == "__main__":
    main(sys.argv[1:])

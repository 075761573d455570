"""The pantographs of `examples/` as FMUs, built as their files say, checked and graded."""

import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from helpers.command_line import pantocheck
from helpers.short_cases import COARSE, change_case, run_unrefined
from pantocheck.conformance.app.self_test.adapter_check import build_short_case
from pantocheck.conformance.app.self_test.fmu_check import check_fmu
from pantocheck.conformance.cases.case_parts import read_named_pantograph
from pantocheck.conformance.core.extras import is_installed
from pantocheck.conformance.execution.plan import Plan, prepare_plan
from pantocheck.conformance.records.record import name_outputs
from pantocheck.conformance.records.record_reading import read_record
from pantocheck.conformance.records.record_writing import write_record
from verification.fmu.fmu_builder import find_missing_tool

EXAMPLES = Path(__file__).parents[3] / "examples"


def test_names_of_outputs_stay_in_their_column() -> None:
    """A name of a stranger must not end a column or a line, or hide another output."""
    names = ["x[1,2]", "x[1;2]", 'a"\nb', "=1+1", "der(v)", "a/b"]
    columns = list(name_outputs([(2, {name: np.zeros(1) for name in names})]))
    assert columns == [
        "fmu 2: x[1_2]", "fmu 2: x[1_2]_", "fmu 2: a__b", "fmu 2: _1_1", "fmu 2: der(v)", "fmu 2: a_b"
    ]  # fmt: skip


@pytest.fixture(scope="module")
def multibody(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the multibody pantograph with its FMU."""
    if (reason := find_missing_tool()) is not None or not is_installed("pythonfmu3"):
        pytest.skip(reason or "PythonFMU3 is not installed")
    folder = shutil.copytree(EXAMPLES / "multibody_pantograph", tmp_path_factory.mktemp("examples") / "multibody")
    options = ["-f", "multibody_pantograph.py", "--handle-state", "--no-external-tool"]
    subprocess.run([sys.executable, "-m", "pythonfmu3", "build", *options], cwd=folder, check=True)
    return folder


@pytest.fixture(scope="module")
def active(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the active pantograph with its FMU."""
    if (reason := find_missing_tool()) is not None:
        pytest.skip(reason)
    folder = shutil.copytree(EXAMPLES / "active_pantograph", tmp_path_factory.mktemp("examples") / "active")
    subprocess.run([sys.executable, "build.py"], cwd=folder, check=True)
    return folder


def test_multibody_pantograph_moves_as_its_two_masses(multibody: Path) -> None:
    """Its angle changes by 1 degree in a passage, and its apparent mass by less than 0.3 %; 1 % is left to the rest."""
    file = read_named_pantograph(multibody / "MultibodyPantograph.fmu")
    check = check_fmu(file, 120.0, 0.01)
    assert check.passed, check.findings
    case = change_case(build_short_case(), mesh=COARSE)
    moved, lumped = (replace(case, pantographs=(one,)) for one in (file, file.model_copy(update={"fmu": None})))
    found, expected = run_unrefined(moved), run_unrefined(lumped)
    assert found.record.state == "consistent"
    assert "PythonFMU3" in found.fmus[0].tool
    spread = "std_force_N"
    assert found.quantities["1"][spread] == pytest.approx(expected.quantities["1"][spread], rel=0.01)


@pytest.mark.parametrize(
    ("pantograph", "verdict", "state"), [("fmu.toml", "pass", "consistent"), ("wrong-sign.toml", "fail", "unconfirmed")]
)
def test_active_pantograph_is_graded_and_its_wrong_sign_fails(
    active: Path, pantograph: str, verdict: str, state: str
) -> None:
    """On a coarse mesh, as in the documentation: at least 58 N; the right sign has 64 N, and the wrong one 51 N."""
    [case] = prepare_plan(Plan(cases=(str(active / "case.toml"),), pantograph=(str(active / pantograph),))).cases
    result = run_unrefined(change_case(case, mesh=COARSE))
    assert (result.verdict, result.record.state) == (verdict, state)
    [output] = result.fmus[0].outputs
    assert (output.name, output.unit) == ("actuator_force", "N")
    assert -50 <= output.lowest < 0 < output.highest <= 50
    assert "actuator_force: " in result.notes[0]


def test_the_check_refutes_a_wrong_sign_by_the_stated_response(active: Path) -> None:
    """The file states the skyhook as a damper."""
    file = read_named_pantograph(active / "fmu.toml")
    assert check_fmu(file, 120.0, 0.01).passed
    wrong = file.model_copy(update={"fmu": file.fmu.model_copy(update={"parameters": {"gain": -60.0}})})
    found = {finding.subject: finding.state for finding in check_fmu(wrong, 120.0, 0.01).findings}
    assert [subject for subject, state in found.items() if state == "wrong"] == ["response"]


def test_outputs_are_columns_of_a_record(active: Path, tmp_path: Path) -> None:
    """The record is read without them; an output that the FMU lacks is named."""
    changes = ("discretisation.element_m=2.0", "discretisation.time_step_s=0.004")
    options = [word for change in changes for word in ("--set", change)]
    path = tmp_path / "record.csv"
    arguments = ("simulate", active / "case.toml", "--pantograph", active / "fmu.toml", *options, "--out", path)
    answer = pantocheck(*arguments)
    assert answer.exit_code == 0, answer.output
    record = read_record(path)[0]
    assert path.read_text("utf-8").splitlines()[0].endswith(",fmu 1: actuator_force")
    force = np.loadtxt(path, delimiter=",", skiprows=1)[:, -1]
    assert force.size == record.time.size
    assert 1 < np.abs(force).max() <= 50
    write_record(tmp_path / "again.h5", record, outputs={"fmu 1: actuator_force": force})
    assert np.array_equal(read_record(tmp_path / "again.h5")[0].force, record.force)
    answer = pantocheck(*arguments, "--set", 'pantograph.fmu.outputs=["force"]')
    assert answer.exit_code != 0
    assert "there is no output 'force'" in " ".join(answer.output.split())

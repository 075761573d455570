"""A pantograph as FMU in a case: the same quantities, two instances, and what never runs it."""

import csv
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from helpers.fmu_fixtures import WriteFmu
from helpers.short_cases import COARSE, change_case, run_unrefined
from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.app.self_test.adapter_check import build_short_case, build_twin_case
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.repetition_check import check_rerun
from pantocheck.conformance.execution.plan import Plan, prepare_plan
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runs.reference_simulator import UnrefinedSimulator
from verification.fmu.coupling_table import compare_quantities


@pytest.mark.parametrize(
    ("version", "has_state", "interface"),
    [
        (3, True, "model-exchange"),
        pytest.param(2, True, "co-simulation", marks=pytest.mark.thorough),
        pytest.param(3, False, "co-simulation", marks=pytest.mark.thorough),
    ],
)
def test_two_chains_as_fmus_give_the_quantities_of_the_built_in_chains(
    write_fmu: WriteFmu, version: int, has_state: bool, interface: str
) -> None:
    """0.05 % of every quantity; without rollback 0.5 % in the long steps of 4 ms, and an eighth of it with half.

    Both pantographs are instances of one FMU, or with FMI 3.0 in front another one with FMI 2.0 follows.
    """
    case = change_case(build_twin_case(), mesh=COARSE)
    file = write_fmu(version=version, has_state=has_state, interface=interface)
    keys = {"has_state": has_state, "interface": interface}
    rear = file if version == 2 else write_fmu(version=2, folder="rear", **keys)
    found = run_unrefined(replace(case, pantographs=(file, rear)))
    assert compare_quantities(run_unrefined(case), found)[0] < (5e-4 if has_state else 5e-3)
    assert [fmu.pantograph for fmu in found.fmus] == [1, 2]
    assert [fmu.sha256 for fmu in found.fmus] == [file.fmu.sha256, rear.fmu.sha256]
    assert [fmu.interface[:5] for fmu in found.fmus] == [f"FMI {version}", "FMI 2"]
    assert all(abs(fmu.energy_J) < 1e-3 * fmu.exchanged_J for fmu in found.fmus)
    assert found.record.state == "consistent"
    assert file.fmu.sha256 in found.notes[0]


@pytest.mark.parametrize("has_state", [True, False])
def test_a_head_with_two_strips_as_fmu_gives_its_quantities(write_fmu: WriteFmu, has_state: bool) -> None:
    """Without rollback 2 % of the band up to 50 Hz in the long steps of 4 ms: the strips are light."""
    file = write_fmu("pantographs/two-strips.toml", has_state=has_state, version=3)
    case = change_case(build_short_case(), mesh=COARSE)
    moved, built_in = (replace(case, pantographs=(one,)) for one in (file, file.model_copy(update={"fmu": None})))
    found = run_unrefined(moved)
    assert compare_quantities(run_unrefined(built_in), found)[0] < (5e-4 if has_state else 2e-2)
    assert found.record.state == "consistent"


def test_an_fmu_with_another_mass_contradicts_its_file(write_fmu: WriteFmu) -> None:
    """The head of the file is a third lighter than that of the FMU: the dynamics check refutes the record."""
    file = write_fmu()
    lighter = file.chain.model_copy(update={"masses_kg": (15.0, 4.8)})
    case = change_case(build_short_case(), mesh=COARSE)
    result = run_unrefined(replace(case, pantographs=(file.model_copy(update={"chain": lighter}),)))
    assert result.verdict == "error"
    assert "contradicts the contact height" in result.reason


def test_the_motion_of_an_fmu_that_is_not_linear_is_not_confirmed(write_fmu: WriteFmu) -> None:
    result = run_unrefined(
        replace(change_case(build_short_case(), mesh=COARSE), pantographs=(write_fmu(is_linear=False),))
    )
    assert result.record.state == "unconfirmed"


def test_the_option_names_an_fmu_and_verify_does_not_run_it(write_fmu: WriteFmu, tmp_path: Path) -> None:
    """`--pantograph model.fmu` finds fmu.toml beside it, and results name the FMU, which `verify --rerun` refuses."""
    file = write_fmu()
    prepared = prepare_plan(Plan(cases=("en50318-2002/250",), pantograph=(str(tmp_path / "fmu" / "model.fmu"),)))
    [case] = prepared.cases
    assert case.pantographs[0].fmu == file.fmu
    assert case.changes == ('pantograph.model = "fmu.toml" (file: "pantograph.toml")',)
    short = replace(change_case(build_short_case(), mesh=COARSE), pantographs=case.pantographs)
    results = run_cases([short], UnrefinedSimulator())
    again = Results.model_validate_json(results.model_dump_json(by_alias=True))
    with pytest.raises(InputError, match=f"SHA-256 {file.fmu.sha256}, whose code is not run here"):
        check_rerun(again)


def test_the_option_needs_named_cases(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no case is named"):
        prepare_plan(Plan(pantograph=("fmu.toml",)))
    with pytest.raises(InputError, match=r"there is no other\.toml or fmu\.toml"):
        prepare_plan(Plan(cases=("en50318-2002/250",), pantograph=(str(tmp_path / "other.fmu"),)))


def test_an_fmu_of_a_case_file_is_not_run_unless_it_is_named(write_fmu: WriteFmu) -> None:
    file = write_fmu()
    unnamed = file.model_copy(update={"fmu": file.fmu.model_copy(update={"model": "model.fmu"})})
    with pytest.raises(Exception, match="Name the pantograph file with --pantograph"):
        run_unrefined(replace(build_short_case(), pantographs=(unnamed,)))


@pytest.mark.parametrize(("gain", "verdict"), [(60.0, "pass"), (-60.0, "fail")])
def test_a_controller_is_graded_and_one_with_a_wrong_sign_fails(write_fmu: WriteFmu, gain: float, verdict: str) -> None:
    """Skyhook damper of 60 N s/m on the frame (Karnopp, Crosby and Harwood 1974), 12 ms late, at most 50 N.

    The passive pantograph has 26.6 N; the limit is 4 % above. The wrong sign takes two thirds of the base damper.
    """
    limit = Limit(quantity="std_force_N", pantograph=1, upper=27.6, trust="own", source="own")
    case = change_case(build_short_case(), mesh=COARSE).without_limits().with_limits((limit,))
    file = write_fmu(is_linear=False, parameters={"skyhook": gain, "delay": 3.0, "limit": 50.0})
    result = run_unrefined(replace(case, pantographs=(file,)))
    [criterion] = [row for row in result.criteria if row.quantity == "std_force_N"]
    assert criterion.verdict == verdict, criterion.value
    assert result.verdict == {"pass": "unconfirmed", "fail": "fail"}[verdict]


def test_a_parameter_of_an_fmu_is_an_axis_of_a_campaign(write_fmu: WriteFmu, tmp_path: Path) -> None:
    """A skyhook of 60 N s/m changes the spread of the force, here by 0.3 N of 27 N."""
    write_fmu(is_linear=False, parameters={"skyhook": 0.0, "delay": 3.0, "limit": 50.0})
    options = ["--pantograph", str(tmp_path / "fmu" / "model.fmu"), "--workers", "1", "--out", str(tmp_path / "runs")]
    changes = ["discretisation.element_m=5.0", "discretisation.time_step_s=0.008"]
    options += [word for change in changes for word in ("--set", change)]
    axis = ["--vary", "pantograph.fmu.parameters.skyhook=0,60"]
    result = CliRunner().invoke(app, ["campaign", "en50318-2002/250", *axis, *options])
    assert result.exit_code == 0, result.output
    with (tmp_path / "runs" / "campaign.csv").open(encoding="utf-8-sig", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["pantograph.fmu.parameters.skyhook"]) for row in rows] == [0.0, 60.0]
    passive, active = (float(row["1.std_force_N"]) for row in rows)
    assert abs(active - passive) > 0.1

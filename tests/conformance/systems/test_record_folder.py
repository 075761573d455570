"""A folder of records as a system."""

from pathlib import Path

import pytest

from helpers.toml_edit import edit_toml
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.records.record_reading import record_digest
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.outcome import Delivered, Skipped
from pantocheck.conformance.systems.record_folder import open_record_folder
from pantocheck.conformance.systems.system_choice import choose_system


def test_record_is_found_by_its_case(case_250: Case, wave: type[Wave], tmp_path: Path) -> None:
    write_record(tmp_path / "deep" / "any name.h5", wave().record(case_250), case_250.id, run={"dt_s": 0.002})
    system = choose_system(f"record:{tmp_path}")
    outcome = system.run(case_250)
    assert outcome.record is not None
    assert outcome.run.dt_s == 0.002
    assert system.name == tmp_path.name


@pytest.mark.parametrize("changed", ["a.csv", "a.toml"])
def test_digest_of_a_record_is_that_of_its_sidecar_and_table(
    two_pantograph_case: Case, wave: type[Wave], tmp_path: Path, changed: str
) -> None:
    record = wave().record(two_pantograph_case)
    sidecar = write_record(tmp_path / "a.csv", record, two_pantograph_case.id)
    edit_toml(sidecar, {"sha256": None})
    outcome = open_record_folder(tmp_path).run(two_pantograph_case)
    assert isinstance(outcome, Delivered)
    facts = CaseEvaluation(two_pantograph_case, outcome).record_facts
    assert facts is not None
    assert facts.digest == outcome.digest == record_digest(sidecar, tmp_path / "a.csv")
    with (tmp_path / changed).open("a") as file:
        file.write("\n")
    assert record_digest(sidecar, tmp_path / "a.csv") != facts.digest


def test_case_without_record_is_skipped(case_250: Case, wave: type[Wave], tmp_path: Path) -> None:
    write_record(tmp_path / "a.csv", wave().record(case_250), "another/case")
    assert open_record_folder(tmp_path).run(case_250) == Skipped("there is no record of this case")


def test_invalid_folder_is_refused(case_250: Case, wave: type[Wave], tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no sidecar in this folder names a case"):
        open_record_folder(tmp_path)
    with pytest.raises(InputError, match="there is no such folder"):
        open_record_folder(tmp_path / "none")
    for name in ("a.csv", "b.csv"):
        write_record(tmp_path / name, wave().record(case_250), case_250.id)
    with pytest.raises(InputError, match=r"b\.toml and a\.toml have the same case en50318-2002/250"):
        open_record_folder(tmp_path)


@pytest.mark.parametrize("text", ["builtins", "record:", "commands:python", ""])
def test_unknown_system_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="there is no such system"):
        choose_system(text)

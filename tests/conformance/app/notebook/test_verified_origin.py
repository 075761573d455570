"""Origin of a report: every number that decides was computed again, or a signature is trusted."""

from pathlib import Path

import pytest

from helpers.graded_wave import Wave
from pantocheck.conformance import verify_report
from pantocheck.conformance.app.notebook.verified_report import _is_repeated
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runs.record_folder import open_record_folder


@pytest.fixture
def recorded(case_250: Case, tmp_path: Path) -> Results:
    """Results of a record in the folder `records`."""
    (tmp_path / "records").mkdir()
    record, system = Wave().record(case_250), {"name": "wave", "version": "1"}
    write_record(tmp_path / "records" / "wave.h5", record, case=case_250.id, system=system, run={})
    return run_cases([case_250], open_record_folder(tmp_path / "records"))


def test_record_shows_the_origin_of_its_case(recorded: Results, tmp_path: Path) -> None:
    path = tmp_path / "results.json"
    path.write_bytes(recorded.to_json())
    unsigned = verify_report(path)
    assert unsigned.origin == "unsigned"
    found = verify_report(path, [tmp_path / "records" / "wave.h5"])
    assert (found.origin, found.state, found.authentic, found.signers) == ("repeated", "consistent", False, ())
    named = [[check for check in report.checks if "option --record" in check.statement] for report in (unsigned, found)]
    assert [len(checks) for checks in named] == [1, 0]


def test_every_case_and_a_step_need_their_own_evidence(recorded: Results) -> None:
    """Nothing repeated shows nothing, and a dossier rests on more than its cases."""
    name = recorded.cases[0].id
    assert _is_repeated(recorded, {name})
    assert not _is_repeated(recorded, {"another"})
    second = recorded.cases[0].model_copy(update={"id": "another"})
    two = recorded.model_copy(update={"cases": [*recorded.cases, second]})
    assert not _is_repeated(two, {name})
    assert _is_repeated(two, {name, "another"})
    assert not _is_repeated(recorded.model_copy(update={"procedure": object()}), {name})
    empty = [recorded.cases[0].model_copy(update={"quantities": {}})]
    assert not _is_repeated(recorded.model_copy(update={"cases": empty}), {name})
    assert not _is_repeated(recorded.model_copy(update={"cases": []}), set())

"""Genuine documents: none is refused, whatever its format and its verdict."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from helpers.case_fixtures import EditedCase
from helpers.command_line import pantocheck
from helpers.graded_wave import render_document
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.cases.limits import own_limits
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.verification import verify_document
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.results.results_format import Results

FORMATS = ["certificate.pdf", "certificate.html", "results.json"]


@pytest.mark.parametrize("name", FORMATS)
def test_document_of_this_version_is_consistent(wave_results: Results, tmp_path: Path, name: str) -> None:
    """A FAIL is consistent, too. Unsigned, it has the exit code 0 only with both options."""
    path = tmp_path / name
    path.write_bytes(render_document(wave_results.to_dict(), name))
    verification = verify_document(path)
    assert verification.consistent, verification.checks
    assert (verification.verdict, verification.cases, verification.criteria) == ("fail", 1, 18)
    if name.endswith(".json"):
        options = ((), ("--any-verdict",), ("--numbers-only",), ("--numbers-only", "--any-verdict"))
        assert [pantocheck("verify", path, *option).exit_code for option in options] == [1, 1, 1, 0]


def test_folder_is_refused_with_the_documents_in_it(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"is a folder, not a regular file\.\n  Name a file: certificate\.pdf"):
        verify_document(tmp_path)
    for name in FORMATS[1:]:
        (tmp_path / name).touch()
    with pytest.raises(InputError) as error:
        verify_document(tmp_path)
    assert f"'{tmp_path / 'certificate.html'}', '{tmp_path / 'results.json'}'" in str(error.value)


@pytest.mark.parametrize(("epoch", "name"), [("0", FORMATS[0]), ("1700000000", FORMATS[1])])
def test_date_of_the_environment_is_read_from_the_document(
    wave_results: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, epoch: str, name: str
) -> None:
    """The date at the verification differs from that of the document, and does not matter."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
    (tmp_path / name).write_bytes(render_document(wave_results.to_dict(), name))
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1800000000")
    assert verify_document(tmp_path / name).consistent


@pytest.mark.parametrize("name", FORMATS[:2])
def test_document_dated_in_the_future_is_found(
    wave_results: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    """The date of a PDF stands in its metadata alone; more than a day ahead of the clock, it is wrong."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "4070908800")
    (tmp_path / name).write_bytes(render_document(wave_results.to_dict(), name))
    [text] = verify_document(tmp_path / name).discrepancies
    assert text.startswith("the document is dated 2099-01-01T00:00:00Z, in the future")


def test_output_has_eighty_columns(wave_results: Results, tmp_path: Path) -> None:
    (tmp_path / "results.json").write_bytes(wave_results.to_json())
    output = pantocheck("verify", tmp_path / "results.json", "--numbers-only").stdout
    first = "consistent: the verdict 'FAIL' follows from the embedded numbers (1 case, 18 criteria). Proved: *"
    assert " ".join(output.split()).startswith(first)
    _, _, unproved = output.partition("\nNot proved:\n")
    statements = ("  * The numbers of these consistency checks", "  * The origin of the document")
    assert all(text in unproved for text in statements)
    assert max(map(len, output.splitlines())) <= 80


def limits_of_a_user(case: Case, _: EditedCase) -> Case:
    return case.with_limits(own_limits([case.limits[0].model_copy(update={"upper": 130.0})]))


def own_case(_: Case, edited_case: EditedCase) -> Case:
    return load_case(edited_case("250.toml", {"id": "own/250"}))


def modified_copy(_: Case, edited_case: EditedCase) -> Case:
    return load_case(edited_case("line.toml", {"contact_wire.tension_N": 21e3}))


@pytest.mark.parametrize("change", [limits_of_a_user, own_case, modified_copy])
def test_other_limits_are_named_and_not_refused(
    case_250: Case, edited_case: EditedCase, wave: Any, tmp_path: Path, change: Callable[[Case, EditedCase], Case]
) -> None:
    """Limits of a user, own cases and modified copies are legitimate; the document states them."""
    results = run_cases([change(case_250, edited_case)], wave())
    (tmp_path / "results.json").write_bytes(results.to_json())
    verification = verify_document(tmp_path / "results.json")
    assert verification.consistent, verification.checks
    assert [check for check in verification.checks if check.outcome == "open"]

"""Administrative data: checked texts, page 1, and no influence on verdicts and digests."""

import hashlib
import io
from pathlib import Path
from typing import Any

import pytest
from pypdf import PdfReader
from typer.testing import CliRunner

from helpers.shown_page import find_facts
from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.app.commands.options import build_options, read_stated_administration
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.ci_reports import render_junit
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.results.administration import read_administration
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.results.results_reading import read_results


def document_facts(results: dict[str, Any]) -> dict[str, str]:
    """Facts on the issuer and on the means of checking."""
    document = build_certificate(Results.model_validate(results))
    return dict((*find_facts(document, "document"), *find_facts(document, "check")))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", r"key report_number: no key is given[\s\S]*Give at least one of report_number, issuer"),
        ('issuer = ""', "at least 1 character"),
        ('remarks = ""', "at least 1 character"),
        (f'issuer = "{"x" * 201}"', "at most 200 characters"),
        (f'remarks = "{"x" * 2001}"', "at most 2000 characters"),
        (r'contact = "a\u202eb"', "key contact: found the character U\\+202E"),
        (r'contact = "a\nb"', "key contact: found the character U\\+000A"),
        (r'remarks = "a\u001b[31m"', "key remarks: found the character U\\+001B"),
        ('isuer = "A"', "did you mean issuer"),
    ],
)
def test_wrong_data_are_refused(content: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "administration.toml"
    path.write_text(content)
    with pytest.raises(InputError, match=f"(?i){message}"):
        read_administration(path)


def test_options_replace_the_plan_key_by_key(tmp_path: Path) -> None:
    plan, file = tmp_path / "plan.toml", tmp_path / "administration.toml"
    plan.write_text('system = "builtin"\n[administration]\nissuer = "A"\nassessor = "C"\nreport_number = "1"')
    file.write_text('issuer = "B"\nreport_number = "2"')
    stated = build_options(plan, administration=read_stated_administration(file, "3")).administration
    assert stated is not None
    assert (stated.issuer, stated.assessor, stated.report_number) == ("B", "C", "3")
    assert build_options(None, administration=read_stated_administration(None, None)).administration is None


def test_run_stores_the_data_without_another_verdict_or_digest(tmp_path: Path) -> None:
    """Results of a run with and without administrative data differ in these data and in times only."""
    record = ["run", "en50318-2002/250", "--system", "record:en50318-2002/known-passing-code", "--formats", "json"]
    named = ["--report-number", "R <7>"]
    plain, stated = (tmp_path / "plain", tmp_path / "stated")
    runner = CliRunner()
    assert runner.invoke(app, [*record, "--out", str(plain)]).exit_code == 1
    result = runner.invoke(app, [*record, *named, "--out", str(stated)])
    assert "Report number: R <7>; Issuer: not stated" in result.stdout
    one, other = (read_results(folder / "results.json").to_dict() for folder in (plain, stated))
    assert other.pop("administration")["report_number"] == "R <7>"
    assert one.pop("administration") is None
    assert one | {"started": None} == other | {"started": None}


def test_page_1_states_data_date_and_digest(results: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """The digest is that of the embedded attachment; with a fixed date, equal results give equal bytes."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    results["administration"] = {"issuer": "Erika", "report_number": None, "remarks": "one\ntwo"}
    facts = document_facts(results)
    assert {key: facts[key] for key in ("Issuer", "Remarks", "Date")} == {
        "Issuer": "Erika",
        "Remarks": "one two",
        "Date": "2023-11-14 22:13:20 UTC",
    }
    content, later = (
        render_pdf(build_certificate(Results.model_validate(results | changes)))
        for changes in ({}, {"started": "2026-11-21T00:00:00Z"})
    )
    assert content == later
    reader = PdfReader(io.BytesIO(content))
    [attachment] = reader.attachments["results.json"]
    assert facts["Digest of the results"] == f"sha256:{hashlib.sha256(attachment).hexdigest()}"
    text = reader.pages[0].extract_text()
    assert "Erika" in text
    assert "pantocheck verify" in text


def test_missing_issuer_is_named_and_data_are_properties_of_junit(
    results: dict[str, Any], hostile: dict[str, Any]
) -> None:
    assert document_facts(results)["Issuer"] == "not stated"
    text = render_junit(Results.model_validate(hostile)).decode()
    assert 'name="administration_report_number" value="&lt;script&gt;alert(1)&lt;/script&gt;"' in text

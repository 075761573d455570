"""Verification: a consistent certificate is accepted, tampering is reported, and other files are refused."""

import io
import json
import random
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
from pypdf import PdfWriter
from pypdf.errors import DependencyError, LimitReachedError
from pypdf.generic import NameObject, StreamObject
from typer.testing import CliRunner

from helpers.example_results import example
from helpers.shown_page import print_certificate
from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents import document_reading
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.documents.verification import verify_document
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.grading.results_building import build_suite
from pantocheck.conformance.pages import pdf
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.results import results_reading as results_file
from pantocheck.conformance.results.results_format import Results


@pytest.fixture
def certificate_file(certificate: bytes, tmp_path: Path) -> Path:
    path = tmp_path / "certificate.pdf"
    path.write_bytes(certificate)
    return path


def test_certificate_of_another_version_is_not_compared_in_full(certificate_file: Path) -> None:
    """Results of another suite and of other software of the pages."""
    found = verify_document(certificate_file)
    assert found.state == "incomplete"
    assert found.discrepancies == ()
    assert (found.verdict, found.cases, found.criteria) == ("fail", 3, 22)


def test_results_of_the_runner_are_consistent(wave: Any, case_250: Case) -> None:
    """Results of the suite's own grading, spectrum and thinned traces included, contradict themselves nowhere."""
    results = run_cases([case_250], wave(), "secondary").to_dict()
    assert len(results["cases"][0]["criteria"]) == 8
    assert find_discrepancies(Results.model_validate(results)) == []


def test_start_and_section_together_can_cause_a_contact_loss(results: dict[str, Any]) -> None:
    """Neither changes the value alone; a smaller uncertainty than that of the components is a contradiction."""
    case = results["cases"][0]
    parts, widths = (case[key]["2"] for key in ("uncertainty_components", "uncertainty"))
    parts["contact_loss_pct"], widths["contact_loss_pct"] = {"start": 0.0, "section": 0.0}, 3e-4
    text = "en50318-2002/250, pantograph 2: uncertainty of contact_loss_pct does not follow from its components"
    assert text not in find_discrepancies(Results.model_validate(results))
    parts["contact_loss_pct"] = {"start": 0.1, "section": 0.0}
    assert text in find_discrepancies(Results.model_validate(results))


def row(results: dict[str, Any], case: int = 0, number: int = 0) -> dict[str, Any]:
    criterion: dict[str, Any] = results["cases"][case]["criteria"][number]
    return criterion


def widen(results: dict[str, Any]) -> None:
    """Give the first criterion an uncertainty of 1 kN, combined as it should be, but without its remark."""
    criterion = row(results)
    key, name = str(criterion["pantograph"]), criterion["quantity"]
    results["cases"][0]["uncertainty_components"].setdefault(key, {})[name] = {"start": 1e3}
    results["cases"][0]["uncertainty"].setdefault(key, {})[name] = 1e3
    criterion.update(components={"start": 1e3}, uncertainty=1e3)


TAMPERINGS = {
    "value": (lambda r: row(r, 1, 1).update(value=33.0), "reported among the quantities"),
    "verdict": (lambda r: row(r, 1, 1).update(verdict="pass"), "verdict 'pass' stated, 'fail' follows"),
    "verdict not counted": (lambda r: row(r, 1, 1).update(verdict="info"), "verdict 'info' stated, 'fail' follows"),
    "provisional counted": (lambda r: row(r, 1, 4).update(verdict="fail"), "verdict 'fail' stated, 'info' follows"),
    "margin": (lambda r: row(r).update(margin=row(r)["margin"] + 1e-6), "margin"),
    "margin gone": (lambda r: row(r).update(margin=None), "margin nothing stated"),
    "limit": (lambda r: row(r).update(upper=118.0), "verdict 'pass' stated, 'fail' follows"),
    "remark on a limit that is not close": (
        lambda r: row(r).update(close=["lies close to a limit"]), "1 remarks on a close limit stated, 0 follow",
    ),
    "another remark on a close limit": (
        lambda r: (widen(r), row(r).update(close=["lies far from every limit"])),
        "1 remarks on a close limit stated, 1 with other texts follow",
    ),
    "component beyond the limit without a remark": (widen, "0 remarks on a close limit stated, 1 follow"),
    "component of another quantity": (
        lambda r: row(r)["components"].update(start=1.0), "components of the uncertainty differ from those reported",
    ),
    "component that is not combined": (
        lambda r: r["cases"][0]["uncertainty_components"]["2"]["std_force_N"].update(start=9.0),
        "pantograph 2: uncertainty of std_force_N does not follow from its components",
    ),
    "combined uncertainty gone": (
        lambda r: r["cases"][0]["uncertainty"]["2"].pop("std_force_N"),
        "pantograph 2: uncertainty of std_force_N does not follow from its components",
    ),
    "smaller uncertainty of a criterion": (lambda r: row(r).update(uncertainty=1e-3), "uncertainty 0.001 stated"),
    "uncertain limit without a remark": (lambda r: row(r).update(limit_uncertainty=1e3), "0 remarks on a close limit"),
    "limits crossed": (lambda r: row(r).update(lower=130.0), "above upper limit"),
    "limits gone": (lambda r: row(r).update(lower=None, upper=None), "no limit"),
    "skip of a known value": (lambda r: row(r).update(verdict="skip", value=None, margin=None), "nothing graded"),
    "case verdict": (lambda r: r["cases"][1].update(criteria_verdict="pass"), "'fail' follows from the criteria"),
    "failed rows removed": (lambda r: r["cases"][1].update(criteria=[]), "'info' follows from the criteria"),
    "suite verdict": (lambda r: r.update(verdict="pass"), "'fail' follows from the cases"),
    "trust": (lambda r: r.update(trust="primary"), "'info' follows"),
    "statistical maximum": (lambda r: set_quantity(r, "statistical_max_N", 190.0), "statistical_max_N 190 stated"),
    "coefficient of variation": (lambda r: set_quantity(r, "cov_50", 0.2), "cov_50 0.2 stated"),
    "mean": (lambda r: set_quantity(r, "mean_force_N", 119.0), "drawn"),
    "deviation": (lambda r: set_quantity(r, "std_force_N", 25.0), "std_force_N 25 stated"),
    "maximum below what is drawn": (lambda r: set_quantity(r, "max_force_N", 165.0), "max_force_N 165 stated"),
    "minimum above what is drawn": (lambda r: set_quantity(r, "min_force_N", 70.0), "min_force_N 70 stated"),
    "quantity of a value gone": (
        lambda r: r["cases"][1]["quantities"]["1"].pop("std_force_N"), "graded, nothing reported among the quantities",
    ),
    "statistics without a curve": (
        lambda r: (r["cases"][0].update(traces={}), set_quantity(r, "statistical_max_N", 190.0)),
        "statistical_max_N 190 stated",
    ),
    "statistics of the rear without a curve": (
        lambda r: (r["cases"][0]["traces"].pop("2"), r["cases"][0]["quantities"]["2"].update(cov_20=0.2)),
        "pantograph 2: cov_20 0.2 stated",
    ),
    "maximum slightly below what is drawn": (lambda r: set_extreme(r, max, 1 - 1e-4), "pantograph 2: max_force_N"),
    "minimum slightly above what is drawn": (lambda r: set_extreme(r, min, 1 + 2e-4), "pantograph 2: min_force_N"),
    "pass without criteria": (
        lambda r: r["cases"][0].update(criteria=[], criteria_verdict="pass", reason="not needed"),
        "verdict 'pass' stated, 'info' follows from the criteria",
    ),
    "unconfirmed without criteria": (
        lambda r: r["cases"][0].update(criteria=[], criteria_verdict="unconfirmed", reason="not needed"),
        "verdict 'unconfirmed' stated, 'info' follows from the criteria",
    ),
    "band": (lambda r: set_quantity(r, "rms_20_50_N", 9.0), "follows from the spectrum"),
}  # fmt: skip


def set_quantity(results: dict[str, Any], name: str, value: float) -> None:
    results["cases"][0]["quantities"]["1"][name] = value


def set_extreme(results: dict[str, Any], extreme: Callable[[list[float]], float], factor: float) -> None:
    """Set an extreme of pantograph 2 to a factor of the drawn one; curves are printed with 2e-5 of their largest."""
    case, name = results["cases"][0], f"{extreme.__name__}_force_N"
    case["quantities"]["2"][name] = factor * extreme(case["traces"]["2"]["force_20_N"])


@pytest.mark.parametrize("name", TAMPERINGS)
def test_tampering_is_reported(results: dict[str, Any], name: str) -> None:
    assert find_discrepancies(Results.model_validate(results)) == []
    tamper, expected = TAMPERINGS[name]
    tamper(results)
    assert any(expected in text for text in find_discrepancies(Results.model_validate(results)))


def test_certificate_made_from_changed_results(results: dict[str, Any], tmp_path: Path) -> None:
    row(results, 1, 1)["verdict"] = "pass"
    results["cases"][1]["verdict"] = "pass"
    (tmp_path / "a.pdf").write_bytes(print_certificate(results))
    found = verify_document(tmp_path / "a.pdf")
    assert len(found.discrepancies) == 3  # the row, its case, the suite


def test_pages_that_contradict_the_embedded_results(
    results: dict[str, Any], passing: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pages of a failing run with the results of a passing one: consistent in themselves, but not with each other."""
    encode_attachment = pdf.encode_attachment
    monkeypatch.setattr(pdf, "encode_attachment", lambda _: encode_attachment(Results.model_validate(passing)))
    (tmp_path / "a.pdf").write_bytes(print_certificate(results))
    found = verify_document(tmp_path / "a.pdf")
    assert found.verdict == "pass"
    assert len(found.discrepancies) == 2
    assert all("PASS" in text for text in found.discrepancies)


def pdf_with(*attachments: tuple[str, bytes], pages: int = 1) -> bytes:
    writer = PdfWriter()
    for _ in range(pages):
        writer.add_blank_page(width=100, height=100)
    for name, content in attachments:
        writer.add_attachment(name, content)
    buffer = io.BytesIO()
    writer.write(buffer)
    return buffer.getvalue()


def test_copies_without_protection_are_refused(tmp_path: Path) -> None:
    for name in ("quantities.csv", "summary.md", "junit.xml", "badge.svg"):
        (tmp_path / name).write_text("case,quantity\n", encoding="utf-8")
        with pytest.raises(InputError, match="a copy of results without protection") as error:
            verify_document(tmp_path / name)
        assert "certificate.pdf, certificate.html, results.json" in str(error.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is neither a PDF nor an HTML page nor JSON"),
        (b"%PDF-1.7\ngarbage", "damaged PDF"),
        (pdf_with(pages=0), "has no pages"),
        (pdf_with(), "holds no attachments named results.json"),
        (pdf_with(("other.json", b"{}")), "holds no attachments named results.json"),
        (pdf_with(("results.json", b"{}"), ("results.json", b"{}")), "2 attachments? named results.json"),
        (pdf_with(("results.json", b"")), "is not valid JSON"),
        (pdf_with(("results.json", b"\xff\xfe\x00")), "is not valid JSON"),
        (pdf_with(("results.json", b"[" * 100_000)), "is not valid JSON"),
        (pdf_with(("results.json", b"[]")), "top level"),
        (pdf_with(("results.json", b"{}")), "key suite"),
    ],
)
def test_other_files_are_refused(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "a.pdf"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        verify_document(path)


@pytest.mark.parametrize(
    ("change", "key"),
    [
        (lambda r: r.update(verdict="maybe"), "key verdict"),
        (lambda r: r.update(schema="other/1"), "key schema"),
        (lambda r: r.pop("cases"), "key cases"),
        (lambda r: row(r).update(value=float("nan")), r"cases\[1\]\.criteria\[1\]\.value"),
        (lambda r: row(r).update(value=10**400), r"cases\[1\]\.criteria\[1\]\.value"),
        (lambda r: row(r).update(value="<script>"), r"cases\[1\]\.criteria\[1\]\.value"),
    ],
)
def test_results_of_another_format_are_refused(
    results: dict[str, Any], tmp_path: Path, change: Callable[[dict[str, Any]], object], key: str
) -> None:
    change(results)
    (tmp_path / "a.pdf").write_bytes(pdf_with(("results.json", json.dumps(results).encode())))
    with pytest.raises(InputError, match=key):
        verify_document(tmp_path / "a.pdf")


def test_missing_and_too_large_files_are_refused(
    certificate_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        verify_document(tmp_path / "none.pdf")
    with pytest.raises(InputError, match="is a folder"):
        verify_document(tmp_path)
    monkeypatch.setattr(results_file, "MAX_RESULTS_BYTES", 1000)
    with pytest.raises(InputError, match=r"attachment results\.json: .* bytes"):
        verify_document(certificate_file)
    monkeypatch.setattr(document_reading, "MAX_DOCUMENT_BYTES", 1000)
    with pytest.raises(InputError, match="bytes"):
        verify_document(certificate_file)


def test_damage_never_ends_in_a_traceback(certificate: bytes, tmp_path: Path) -> None:
    """Either the damage hits nothing that is read, or it is refused by name."""
    path = tmp_path / "a.pdf"
    refused = 0
    for seed in range(8):
        chance = random.Random(seed)
        damaged = bytearray(certificate[: chance.choice([len(certificate), chance.randrange(len(certificate))])])
        for _ in range(chance.choice([1, 20, 2000])):
            damaged[chance.randrange(len(damaged))] = chance.randrange(256)
        path.write_bytes(damaged)
        try:
            verify_document(path)
        except InputError:
            refused += 1
    assert refused >= 2


def test_verify_command(certificate_file: Path, results: dict[str, Any], tmp_path: Path) -> None:
    runner = CliRunner()
    good = runner.invoke(app, ["verify", str(certificate_file)])
    assert (good.exit_code, good.stdout.split(":")[0]) == (1, "consistent in part")
    row(results, 1, 1)["margin"] = 0.5
    (tmp_path / "bad.pdf").write_bytes(print_certificate(results))
    bad = runner.invoke(app, ["verify", str(tmp_path / "bad.pdf")])
    assert bad.exit_code == 1
    assert "en50318-2002/300, std_force_N of pantograph 1: margin 0.5 stated, -0.32" in " ".join(bad.stdout.split())
    none = runner.invoke(app, ["verify", str(tmp_path / "none.pdf")])
    assert none.exit_code == 2
    assert "cannot be read" in none.stderr


@pytest.mark.parametrize("name", ["/JBIG2Decode", "/JPXDecode", "/Crypt", "/NoSuchFilter", "/LZWDecode"])
def test_attachment_behind_another_filter_is_refused(certificate_file: Path, name: str) -> None:
    """Some filters need packages that are not installed; the parser then raises exceptions of its own."""
    writer = PdfWriter(clone_from=certificate_file)
    for item in writer._objects:
        if isinstance(item, StreamObject) and item.get("/Type") == "/EmbeddedFile":
            item[NameObject("/Filter")] = NameObject(name)
    writer.write(certificate_file)
    with pytest.raises(
        InputError, match=r"certificate\.pdf(: is a damaged PDF|, attachment results\.json: is not valid JSON)"
    ):
        verify_document(certificate_file)


@pytest.mark.parametrize("error", [LimitReachedError("limit"), MemoryError(), DependencyError("jbig2dec")])
def test_every_exception_of_the_parser_is_a_message(
    certificate_file: Path, error: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("pypdf.PdfReader", fail)
    with pytest.raises(InputError, match="is a damaged PDF"):
        verify_document(certificate_file)


def test_verifier_is_written_with_its_digest(tmp_path: Path, certificate_file: Path) -> None:
    """The printed digest is that of the file, and of the line on page 1 of a certificate."""
    path = tmp_path / "verifier.html"
    written = CliRunner().invoke(app, ["verify", "--write-verifier", str(path)])
    assert written.exit_code == 0
    digest = sha256(path.read_bytes()).hexdigest()
    assert digest in "".join(written.output.split())
    results = Results.model_validate(example())
    page = render_html(build_certificate(results.model_copy(update={"suite": build_suite()})))
    assert f"SHA-256 {digest}" in page
    assert CliRunner().invoke(app, ["verify"]).exit_code == 2

"""Verifier for a browser: it accepts genuine documents, and finds what `pantocheck verify` finds, without a network."""

import ast
import base64
import copy
import hashlib
import json
import re
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from helpers.verifier_page import Report, Verify
from pantocheck.conformance import documents
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.documents.document_reading import read_certificate
from pantocheck.conformance.documents.verification import verify_certificate
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.criteria_table import describe_criterion
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.page_code import SIGNATURE_LIBRARY, VERIFIER_FOLDER, build_verifier
from pantocheck.conformance.pages.translation import translate
from pantocheck.conformance.pages.verdict_marks import mark_rows
from pantocheck.conformance.pages.words import read_words
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.report_files import LANGUAGES, Language
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runs.record_checks import RECORD_CHECKS
from verification.attacks.forgeries import SEED, Genuine, list_result_forgeries
from verification.attacks.raised_statements import EVERY_CHANGE, STATE_CHANGES

NUMBERS = ("The embedded numbers and verdicts contradict each other.", "Parts that every run writes are missing.")
"""Contradictions of the checks that both verifiers make."""

ONLY_VERIFY = {
    "version of the suite": "suite",
    **dict.fromkeys(("case repeated", "start in the future", "place of a criterion"), "statements"),
    "reason of a criterion": "statements",
    **dict.fromkeys(
        ("limits widened, regraded", "limits widened, other digest", "limits widened and stated"), "remarks"
    ),
    "all forces scaled, regraded": "remarks",
}
"""Kinds that only `verify` finds, and the part of "Not proved" that names them."""

COMPUTED = """(data) => verifyDocument(Uint8Array.from(atob(data), (c) => c.charCodeAt(0))).then(({evaluated}) =>
  Object.fromEntries(Object.entries(evaluated).map(([id, parts]) => [id, Object.fromEntries(
    Object.entries(parts).map(([key, part]) => [key, part.quantities()]))])))"""


def list_outcomes(report: Report, outcome: str) -> list[str]:
    return [check["statement"] for check in report["checks"] if check["outcome"] == outcome]


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["json", "html", "pdf"])
def test_genuine_document_is_consistent_and_unsigned(
    genuine: Genuine, verifier_page: Any, verify: Verify, tmp_path: Path, kind: str
) -> None:
    results = next(list_result_forgeries(genuine, "time of the run", SEED))[1]
    content = {"json": results, "html": genuine.html.encode(), "pdf": genuine.pdf}[kind]
    report = verify(content, f"certificate.{kind}")
    assert report["state"] == "consistent", report["checks"]
    assert report["conclusion"].startswith("UNSIGNED: the numbers are consistent, anyone can have written")
    proved = ["Verdicts, margins, uncertainties and statistics follow from the embedded numbers."]
    printed = "Verdict, digest and [1-9][0-9]* values printed on the page are those of the results."
    found = list_outcomes(report, "proved")
    assert found[:1] == proved
    assert kind != "html" or re.fullmatch(printed, found[1])
    # The same by hand: the chosen file gives a report with the drawing of the force.
    path = tmp_path / f"certificate.{kind}"
    path.write_bytes(content)
    verifier_page.set_input_files("#file", str(path))
    verifier_page.wait_for_selector(".conclusion")
    assert verifier_page.inner_text(".conclusion") == report["conclusion"]
    assert verifier_page.locator("figure polyline").count() == 1
    # On a phone, wide tables and digests do not widen the page.
    verifier_page.set_viewport_size({"width": 390, "height": 800})
    assert verifier_page.evaluate("document.documentElement.scrollWidth") == 390
    # An uncertainty that lacks a component is not zero: the table has the words of the certificate.
    case = Results.model_validate(genuine.results).cases[0]
    errors = [describe_criterion(row, case.uncertainty_basis).error for row in case.criteria]
    shown = verifier_page.locator("table td:nth-child(4)").all_inner_texts()
    assert errors.count("not known") == 1
    assert [text.partition(" ")[0] for text in shown] == [text.partition(" ")[0] for text in errors]


@pytest.mark.thorough
def test_both_verifiers_compute_the_same_statistics(genuine: Genuine, verifier_page: Any) -> None:
    content = base64.b64encode(genuine.pdf).decode()
    for case in genuine.results["cases"]:
        computed = verifier_page.evaluate(COMPUTED, content)[case["id"]]
        for owner, values in computed.items():
            stated = {name: value for name, value in case["quantities"][owner].items() if name in values}
            assert len(stated) == len(values) >= 13
            assert values == pytest.approx(stated, rel=1e-10, abs=1e-12)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", EVERY_CHANGE)
def test_forged_results_have_the_same_outcome(
    genuine: Genuine, bare: Genuine, verify: Verify, tmp_path: Path, kind: str
) -> None:
    """Numbers and missing parts: both verifiers find the forgery, or neither of them."""
    _, content, suffix = next(list_result_forgeries(bare if kind in STATE_CHANGES else genuine, kind, SEED))
    path = tmp_path / f"forged.{suffix}"
    path.write_bytes(content)
    found = {check.statement for check in verify_certificate(read_certificate(path)).checks} & set(NUMBERS)
    report = verify(content, path.name)
    if kind in ONLY_VERIFY:
        assert ONLY_VERIFY[kind] in [check["part"] for check in report["checks"] if check["outcome"] == "open"]
    else:
        assert set(list_outcomes(report, "contradicted")) & set(NUMBERS) == found


PAGE_CHANGES = {
    "value": (r"(data-label=\"Value\"[^>]*>)\d+", r"\g<1>7", "is printed"),
    "digest": ("sha256:[0-9a-f]{64}</dd>", "sha256:0</dd>", "the digest of the results is"),
    "title": ("<title>[^<]*", "<title>PASS", "the title does not print the verdict FAIL"),
    "data": (r'"verdict":"fail"', '"verdict":"pass"', "verdict 'pass' stated"),
}


@pytest.mark.thorough
@pytest.mark.parametrize("kind", PAGE_CHANGES)
def test_changed_page_is_found(genuine: Genuine, verify: Verify, kind: str) -> None:
    pattern, text, message = PAGE_CHANGES[kind]
    changed = re.sub(pattern, text, genuine.html, count=1)
    assert changed != genuine.html
    report = verify(changed.encode(), "certificate.html")
    assert report["state"] == "contradicted"
    assert any(message in line for check in report["checks"] for line in check["details"])


@pytest.mark.thorough
@pytest.mark.parametrize("language", LANGUAGES[1:])
def test_printed_numbers_and_verdicts_are_read_in_every_language(
    genuine: Genuine, verify: Verify, language: Language
) -> None:
    certificate = build_certificate(Results.model_validate(genuine.results))
    page = render_html(replace(certificate, language=language))
    printed = "Verdict, digest and [1-9][0-9]* values printed on the page are those of the results."
    [english] = [text for text in list_outcomes(verify(genuine.html.encode(), "en.html"), "proved") if "page" in text]
    report = verify(page.encode(), "certificate.html")
    assert report["state"] == "consistent", report["checks"]
    assert re.fullmatch(printed, english)
    assert english in list_outcomes(report, "proved")
    words = [translate(word, language).text for word in ("FAIL", "PASS", "Value")]
    forgeries = ((f"<title>{words[0]}", f"<title>{words[1]}"), (rf'(data-label="{words[2]}"[^>]*>)\d+', r"\g<1>7"))
    for pattern, text in forgeries:
        changed = re.sub(pattern, text, page, count=1)
        assert changed != page
        assert verify(changed.encode(), "certificate.html")["state"] == "contradicted"


@pytest.mark.thorough
@pytest.mark.parametrize("content", [b"", b"%PDF-1.7", b"{}", b"<!doctype html><p>", b'{"schema": "other"}', bytes(9)])
def test_other_files_are_refused(verify: Verify, content: bytes) -> None:
    assert verify(content, "file")["state"] == "refused"


@pytest.mark.thorough
def test_bytes_behind_a_pdf_are_found(genuine: Genuine, verify: Verify) -> None:
    report = verify(genuine.pdf + b"\n1 0 obj\n<<>>\nendobj\nstartxref\n1\n%%EOF\n", "certificate.pdf")
    assert "The file was changed after it was written." in list_outcomes(report, "contradicted")
    report = verify(genuine.pdf + b"\n1 0 obj\n<</ByteRange [0 1]>>\nendobj\nstartxref\n1\n%%EOF\n", "certificate.pdf")
    broken = "The signatures cannot be read."
    assert broken in list_outcomes(report, "contradicted")


@pytest.mark.thorough
def test_headings_and_rows_of_the_shown_report(genuine: Genuine, verifier_page: Any, tmp_path: Path) -> None:
    """The heading names a modified copy, verdicts are those of the page, and a forged limit marks its row alone."""
    results = copy.deepcopy(genuine.results)
    case = results["cases"][0]
    case["library"] = "modified"
    row = next(row for row in case["criteria"] if row["verdict"] == "pass")
    row["upper"] += 5.0
    path = tmp_path / "results.json"
    path.write_text(json.dumps(results), "utf-8")
    verifier_page.set_input_files("#file", str(path))
    verifier_page.wait_for_selector("tr.contradicted")
    assert f"(modified copy of {case['id']}): FAIL" in verifier_page.locator("h3").last.inner_text()
    assert "sha256:" in verifier_page.inner_text(".small")
    marked = verifier_page.locator("tr.contradicted")
    assert marked.count() == 1
    assert marked.locator("td").first.inner_text() == f"{QUANTITIES[row['quantity']].label} {row['quantity']}"
    assert verifier_page.locator("h3").last.inner_text().endswith("(contradicted)")
    texts = [mark_rows(entry["verdict"], [Criterion.model_validate(entry)]) for entry in case["criteria"]]
    shown = verifier_page.locator("td:nth-last-child(2)").all_inner_texts()
    words = read_words()["verdict"]
    assert shown == [words[text]["word"] for text in texts]
    assert "PASS, CLOSE" in " ".join(shown)


@pytest.mark.thorough
def test_several_documents_are_all_checked(genuine: Genuine, verifier_page: Any, tmp_path: Path) -> None:
    for name, content in (("a.pdf", genuine.pdf), ("b.html", genuine.html.encode()), ("c.json", b"{}")):
        (tmp_path / name).write_bytes(content)
    verifier_page.set_input_files("#file", [str(path) for path in sorted(tmp_path.iterdir())])
    verifier_page.locator(".conclusion").nth(2).wait_for()
    first = verifier_page.locator("#report > p").first.inner_text()
    assert first == "3 documents, a section for each: a.pdf, b.html, c.json."
    states = [text.partition(":")[0] for text in verifier_page.locator(".conclusion").all_inner_texts()]
    assert states == ["UNSIGNED", "UNSIGNED", "c.json"]


@pytest.mark.thorough
@pytest.mark.parametrize("language", LANGUAGES)
def test_printed_range_of_a_list_is_that_of_the_results(genuine: Genuine, verify: Verify, language: Language) -> None:
    results = copy.deepcopy(genuine.results)
    results["cases"][0]["quantities"].setdefault("0", {})["dropper_length_m"] = [0.53231 + 0.05 * n for n in range(9)]
    page = render_html(replace(build_certificate(Results.model_validate(results)), language=language))
    text = translate("9 values, 0.53231 to 0.93231", language).text
    assert text in page
    for printed, found in (
        (text, False),
        (text.replace("0.53231", "0.53233"), True),
        (text.replace("9 ", "8 ", 1), True),
    ):
        report = verify(page.replace(text, printed).encode(), "certificate.html")
        assert found == any("dropper_length_m:" in line for check in report["checks"] for line in check["details"])


@pytest.mark.thorough
def test_start_and_section_together_can_cause_a_contact_loss(genuine: Genuine, verify: Verify) -> None:
    """As in `verify`: neither changes the value alone; an uncertainty below that of its components contradicts them."""
    for start, found in ((0.0, False), (0.1, True)):
        results = copy.deepcopy(genuine.results)
        parts, widths = (results["cases"][0].setdefault(key, {}) for key in ("uncertainty_components", "uncertainty"))
        parts.setdefault("1", {})["contact_loss_pct"] = {"start": start, "section": 0.0}
        widths.setdefault("1", {})["contact_loss_pct"] = 3e-4
        report = verify(json.dumps(results).encode(), "results.json")
        text = "uncertainty of contact_loss_pct does not follow"
        assert found == any(text in line for check in report["checks"] for line in check["details"])


# Statements of `pantocheck verify`, and the part of the verifier that makes the check or names it as not proved.
COVERED = {
    "Verdicts, margins, uncertainties and statistics follow": "numbers",
    "The embedded numbers and verdicts contradict each other.": "numbers",
    "Parts that every run writes are missing.": "numbers",
    "The document states less than one of the installed version.": "numbers",
    "The file was changed after it was written.": "appended bytes",
    "The file is ": "pages",
    "Texts, figures and metadata": "pages",
    "The document is not the one that its embedded results give.": "pages",
    "The document shows something else than its embedded results.": "pages",
    "The layout of the file was not compared.": "pages",
    "The document has a date in the future.": "pages",
    "The texts are not those of the installed version.": "pages",
    "All texts are those of the installed version.": "pages",
    "Other versions made this document": "pages",
    "The software that made the pages": "pages",
    "The values of the reference simulator": "static values",
    "A signature does not hold": "signatures",
    "The origin of the document.": "signatures",
    "Every signer leads": "signatures",
}
"""Beginnings of statements outside of the modules of `MODULES`."""

MODULES = {"library_check": "library", "repetition_check": "record", "row_check": "record"}
"""Modules all of whose checks the verifier names as one."""

IMPLEMENTED = {"numbers", "appended bytes", "signatures"}


def list_statements(path: Path) -> Iterator[str]:
    """Sentences in the source of a module of checks: texts that begin with a capital and end a statement."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if not (isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("DocumentCheck", "judge_details")):
            continue
        texts = [item.value for item in node.args if isinstance(item, ast.Constant) and isinstance(item.value, str)]
        yield from (text for text in texts if text[:1].isupper())


def test_list_of_unproved_facts_covers_every_check_of_verify() -> None:
    """A new check of `verify` needs a place in the verifier: made by it, or named under "Not proved"."""
    report = (VERIFIER_FOLDER / "document_report.js").read_text("utf-8")
    listed = re.findall(r'^  \["([a-z ]+)", "', report, re.MULTILINE)
    folder = Path(documents.__path__[0])
    for path in sorted(folder.glob("*.py")):
        for text in list_statements(path):
            place = MODULES.get(path.stem) or next(
                (to for start, to in COVERED.items() if text.startswith(start)), None
            )
            assert place is not None, f"{path.name}: {text}"
            assert place in IMPLEMENTED or place in listed, place
    table = (Path(__file__).parents[2] / "docs" / "verify.md").read_text("utf-8")
    documented = re.findall(r"^\| ([a-z ]+) \| [A-Z]", table, re.MULTILINE)
    assert {"numbers", "pages", "library", "origin"} <= set(documented)
    assert set(documented) <= {*listed, *IMPLEMENTED, "missing parts", "origin"}
    assert {"record", "rerun", "revocation"} <= set(listed)
    script = (VERIFIER_FOLDER / "checks.js").read_text("utf-8")
    table = json.loads(script.partition("RECORD_CHECKS = ")[2].partition(";")[0])
    assert table == {
        check.name: [
            [*check.causes],
            {
                part.name: [part.unit, part.side, {**part.thresholds}, *([True] if part.for_filtered else [])]
                for part in check.measures
            },
        ]
        for check in RECORD_CHECKS
    }
    assert list(table) == [check.name for check in RECORD_CHECKS]


def test_verifier_fetches_nothing_and_is_the_same_file_each_time() -> None:
    page = build_verifier("0.1.0", "sha256:1")
    assert page == build_verifier.__wrapped__("0.1.0", "sha256:1")
    assert b"default-src 'none'; script-src 'sha256-" in page
    # The library and its licence are texts of others: the policy of the page forbids requests to them, too.
    library, licence = ((SIGNATURE_LIBRARY / name).read_bytes() for name in ("pkijs.min.js", "LICENSE"))
    assert page.count(library) == page.count(licence) == 1
    assert not re.search(rb"</script|<!--|\beval\b|new Function|fetch\(|XMLHttpRequest", library)
    own = page.replace(library, b"").replace(licence, b"")
    assert b"@" not in re.sub(rb"@media", b"", own)
    assert not re.search(rb"https?://(?!www\.w3\.org/)|fetch\(|XMLHttpRequest|eval\(", own)


def test_library_for_signatures_states_its_packages_and_licences() -> None:
    release = tomllib.loads((SIGNATURE_LIBRARY / "release.toml").read_text("utf-8"))
    digests = {name: hashlib.sha256((SIGNATURE_LIBRARY / name).read_bytes()).hexdigest() for name in release["sha256"]}
    assert digests == release["sha256"]
    assert {path.name for path in SIGNATURE_LIBRARY.iterdir()} == {*digests, "release.toml"}
    making, licences = ((SIGNATURE_LIBRARY / name).read_text("utf-8") for name in ("release.toml", "LICENSE"))
    assert "--" not in licences  # a comment of the page holds it
    for part in release["bundled"]:
        assert f"{part['package']}@{part['version']}" in making
        assert f"{part['package']} {part['version']}\n" in licences

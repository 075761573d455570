"""Words of the verifier for a reader without Python: badges, verdicts that follow, steps of a dossier, languages."""

import copy
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from helpers.example_dossier import CachedSimulator, copy_example, validate_example
from helpers.toml_edit import change_keys
from helpers.verifier_page import Report, Verify
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.page_code import VERIFIER_FOLDER
from pantocheck.conformance.pages.translation import read_sections, translate
from pantocheck.conformance.pages.words import read_words
from pantocheck.conformance.results.report_files import LANGUAGES, Language
from pantocheck.conformance.results.results_format import Results
from verification.attacks.forgeries import Genuine

pytestmark = pytest.mark.thorough


def render(results: dict[str, Any], language: Language) -> str:
    return render_html(replace(build_certificate(Results.model_validate(results)), language=language))


def show(page: Any, path: Path, content: str) -> str:
    """Text of the report on a document."""
    path.write_text(content, "utf-8")
    page.set_input_files("#file", str(path))
    page.wait_for_function("name => document.querySelector('#report h2')?.textContent === name", arg=path.name)
    return str(page.inner_text("#report"))


def list_printed(report: Report) -> list[str]:
    """Contradictions between the page and its results."""
    return [
        line for check in report["checks"] if check["statement"].startswith("The page") for line in check["details"]
    ]


@pytest.mark.parametrize("language", LANGUAGES)
def test_badge_of_every_verdict_is_read(genuine: Genuine, verify: Verify, language: Language) -> None:
    """Title, heading and rows with each verdict agree with the results; another word or symbol does not."""
    marks = {
        name: (mark["symbol"], translate(mark["word"], language).text) for name, mark in read_words()["verdict"].items()
    }
    badge = '<span aria-hidden="true">{}</span> {}</span>'.format
    for name, mark in marks.items():
        results, verdict = copy.deepcopy(genuine.results), "pass" if name == "close" else name
        for part in (results, *results["cases"]):
            part["verdict"] = part["criteria_verdict"] = verdict
        for row in results["cases"][0]["criteria"]:
            row.update(verdict=verdict, close=["a remark"] if name == "close" else [])
        page, other = render(results, language), marks["fail" if name == "error" else "error"]
        assert badge(*mark) in page
        assert list_printed(verify(page.encode(), "page.html")) == [], name
        for forged in (other, (other[0], mark[1]))[: 2 if name == "pass" else 1]:
            lines = list_printed(verify(page.replace(badge(*mark), badge(*forged)).encode(), "page.html"))
            assert any("the verdict" in line for line in lines), (name, forged)


def forge_maximum(results: dict[str, Any]) -> dict[str, Any]:
    """Results whose statistical maximum is lowered until it passes, with everything that a table shows."""
    forged = copy.deepcopy(results)
    [case] = forged["cases"]
    row = next(row for row in case["criteria"] if row["quantity"] == "statistical_max_N")
    row.update(value=205.0, margin=0.5, verdict="pass", close=[])
    case["quantities"]["1"]["statistical_max_N"] = 205.0
    for part in (forged, case):
        part["verdict"] = part["criteria_verdict"] = "pass"
    return forged


def test_verdict_that_follows_stands_beside_a_contradicted_one(
    genuine: Genuine, verifier_page: Any, tmp_path: Path
) -> None:
    text = show(verifier_page, tmp_path / "forged.json", json.dumps(forge_maximum(genuine.results)))
    assert "stated verdict 'PASS, CLOSE'; 'FAIL' follows)" in text.partition("\n\n")[2].partition("\n")[0]
    assert verifier_page.locator("h3").last.inner_text().endswith(": PASS, CLOSE (contradicted: FAIL follows)")
    row = verifier_page.locator("tr.contradicted", has_text="statistical_max_N").locator("td").all_inner_texts()
    computed = next(row for row in genuine.results["cases"][0]["criteria"] if row["quantity"] == "statistical_max_N")
    assert (row[2], row[-2:]) == ("205 N", ["PASS", "FAIL"])
    assert float(row[3].removesuffix(" N")) == pytest.approx(computed["value"], rel=1e-5)  # six digits are shown
    assert "statistical_max_N (Statistical maximum, mean + 3 σ)" in text


def test_force_has_an_axis_and_items_have_numbers(genuine: Genuine, verifier_page: Any, tmp_path: Path) -> None:
    results = copy.deepcopy(genuine.results)
    criteria = results["cases"][0]["criteria"]
    for number, row in enumerate(criteria, 1):
        row.update(pantograph=0, item=number)
    text = show(verifier_page, tmp_path / "items.json", json.dumps(results))
    owners = verifier_page.locator("td:nth-child(2)").all_inner_texts()
    assert owners == [f"line, no. {number}" for number in range(1, len(criteria) + 1)]
    ticks = [float(tick.removesuffix(" N")) for tick in verifier_page.locator(".tick").all_text_contents()]
    assert 3 <= len(ticks) <= 7
    assert ticks == sorted(ticks)
    assert "without limits of its largest and smallest value" in text  # no limit belongs to pantograph 1


def test_open_points_are_worded_as_such(genuine: Genuine, verify: Verify) -> None:
    for content, name in ((genuine.pdf, "a.pdf"), (genuine.html.encode(), "a.html")):
        checks = [check for check in verify(content, name)["checks"] if check["outcome"] == "open"]
        statements = [check["statement"] for check in checks if check["statement"] != "The origin of the document."]
        assert len(statements) >= 12
        assert [text for text in statements if not text.startswith("Whether ")] == []


@pytest.mark.parametrize("language", LANGUAGES[1:])
def test_report_speaks_the_language_of_the_document(
    genuine: Genuine, verify: Verify, verifier_page: Any, tmp_path: Path, language: Language
) -> None:
    """Of genuine and forged pages; details of contradictions may be English, which the report says."""
    script = (VERIFIER_FOLDER / "document_report.js").read_text("utf-8")
    fixed = re.findall(r'"([A-Z][^"]+)\."', script)
    assert len(fixed) > 25
    assert {text for text in fixed if text not in read_sections(language)["verifier"]} == set()
    for content in (genuine.results, forge_maximum(genuine.results)):
        page = render(content, language)
        report = verify(page.encode(), "page.html")
        text = show(verifier_page, tmp_path / f"{content['verdict']}.html", page)
        english = [report["conclusion"], *(check["statement"] for check in report["checks"])]
        english += [
            line for check in report["checks"] if check["outcome"] != "contradicted" for line in check["details"]
        ]
        english += ["Not proved", "Value that follows", "Mean contact force", "Force of pantograph"]
        assert [line for line in english if line in text] == []
        assert not re.search("criteria|verdict '.*follows|anyone", verifier_page.inner_text(".conclusion"))
        assert translate("Mean contact force", language).text in text


@pytest.fixture(scope="module")
def dossier(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Results of the example dossier."""
    folder = tmp_path_factory.mktemp("dossier")
    return validate_example(copy_example(folder / "in"), CachedSimulator(), folder / "out").to_dict()


CHANGES: dict[str, Any] = {
    "verdict": "fail",
    "procedure.steps.0.verdict": "fail",
    "procedure.steps.1.margin": 0.9,
    "procedure.steps.1.criteria.0.value": 50.0,
    "procedure.steps.1.closest": None,
    "procedure.steps.2.unconfirmed": "not confirmed by every run: start",
    "procedure.steps.4.cases": [],
    "procedure.steps.5.state": "not done",
    "procedure.claims.0.name": "another line",
    "procedure.claims.2.claimed": [100.0, 300.0],
    "procedure.claims.2.reason": "a reason",
    "procedure.evidence.1.passed": False,
    "procedure.evidence.1.speed_km_h": 300.0,
    "cases.0.library": "modified",
}


def test_steps_of_a_dossier_follow_in_both_verifiers(
    dossier: dict[str, Any], verify: Verify, verifier_page: Any, tmp_path: Path
) -> None:
    """The same words about every step and claim; the report shows each step with its values."""
    plain = dossier | {"cases": [{**case, "signals": None} for case in dossier["cases"]]}  # no step depends on them
    starts = ("step ", "claim ", "procedure: ", "verdict ")
    for key, value in ({"title": None} | CHANGES).items():
        changed = copy.deepcopy(plain)
        if key != "title":
            change_keys(changed, {key: value})
        expected = [line for line in find_discrepancies(Results.model_validate(changed)) if line.startswith(starts)]
        report = verify(json.dumps(changed).encode(), "results.json")
        found = [line for check in report["checks"] if check["outcome"] == "contradicted" for line in check["details"]]
        assert sorted(line for line in found if line.startswith(starts)) == sorted(expected), key
        assert bool(expected) == (key != "title"), key
    text = show(verifier_page, tmp_path / "dossier.html", render(dossier, "en"))
    steps = verifier_page.locator("h3:has-text('Dossier') + table tr td:first-child").all_inner_texts()
    assert steps == [f"{number} {name}" for number, name in enumerate(read_words()["procedure"].values(), 1)]
    assert "the verdict 'PASS, CLOSE' follows" in text
    names = [row["quantity"] for step in dossier["procedure"]["steps"] for row in step.get("criteria", [])]
    assert len(names) > 5
    assert [name for name in names if name not in text] == []

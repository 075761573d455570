"""Certificate of a dossier: order of the procedure, statement, JUnit, badge, summary, and detection of changes."""

import copy
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from helpers.command_line import pantocheck
from helpers.shown_page import certify, summarise
from helpers.toml_edit import change_keys
from helpers.untranslated import build_pages, find_untranslated
from pantocheck.conformance.core.figure_data import Chart
from pantocheck.conformance.documents.document_reading import parse_html_certificate, parse_pdf_certificate
from pantocheck.conformance.documents.page_check import check_pages
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages import step_sections
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.ci_reports import render_junit
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.markdown import render_markdown
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.pages.scope_page import build_procedure_headline, list_step_reasons
from pantocheck.conformance.pages.two_verdicts import render_badge
from pantocheck.conformance.pages.verdict_marks import count_close
from pantocheck.conformance.results.procedure_format import Procedure
from pantocheck.conformance.results.report_files import LANGUAGES, Language
from pantocheck.conformance.results.results_format import Results

STEPS = [
    "1 Pantograph model",
    "2 Static check of the line model",
    "3 Simulation parameters",
    "4 Reference models",
    "5 Line tests",
    "6 Limits of validity",
]


@pytest.fixture(scope="module")
def content(results: Results) -> dict[str, Any]:
    return results.to_dict()


def list_sections(blocks: tuple[doc.Block, ...]) -> list[doc.Section]:
    """Sections at all levels."""
    found = []
    for block in blocks:
        if isinstance(block, doc.Section):
            found += [block, *list_sections(block.blocks)]
    return found


def count_figures(section: doc.Section) -> int:
    blocks = [block for part in list_sections((section,)) for block in part.blocks]
    return sum(len(block.figures) for block in blocks if isinstance(block, doc.Figures))


def test_certificate_follows_the_procedure(content: dict[str, Any]) -> None:
    """Each step has its section in order, the sections of its cases behind it, and a figure or a drawing."""
    document = certify(content)
    headings = [block.heading for block in document.blocks if isinstance(block, doc.Section)]
    assert [heading for heading in headings if heading in STEPS] == STEPS
    assert headings.index("EN 50318:2002 reference model, 250 km/h") == headings.index(STEPS[3]) + 1
    assert headings[headings.index(STEPS[4]) + 1].startswith("Line test 160-up: example line, 160 km/h")
    steps = {block.heading: block for block in document.blocks if isinstance(block, doc.Section)}
    for heading in STEPS[:2] + STEPS[3:]:
        assert count_figures(steps[heading]) >= 1
    assert document.header.statement == "self-declared conformance report, in the style of EN 50318"
    assert "certified" not in render_markdown(document).lower()


def test_page_1_answers_in_the_order_of_a_certificate(content: dict[str, Any]) -> None:
    """Verdicts of the steps, forces, and the value with the smallest margin of each step; the claimed range."""
    document = certify(content)
    [answers] = [block for block in document.blocks if isinstance(block, doc.Answers)]
    assert [section.anchor for section in answers.sections] == ["tested", "basis", "result", "use", "document", "check"]
    result, use = answers.sections[2], answers.sections[3]
    steps, values = (block for block in result.blocks if isinstance(block, doc.Table))
    assert [row[0].text for row in steps.rows] == STEPS
    assert {row[2] for row in steps.rows} == {"decides the verdict"}
    assert count_figures(result) >= 1
    margins = [step["margin"] for step in content["procedure"]["steps"] if step["margin"] is not None]
    assert len(values.rows) == len(margins) > 2
    shown = [float(str(row[6][1]).replace("−", "-")) for row in values.rows]
    assert shown == pytest.approx(margins, abs=0.006)  # two decimals
    claimed = dict(next(block for block in use.blocks if isinstance(block, doc.Facts)).pairs)
    assert "Speed" in claimed["Shown by runs"]


@pytest.mark.parametrize(
    "language", ["de", *(pytest.param(name, marks=pytest.mark.thorough) for name in ("fr", "it", "es"))]
)
def test_dossier_is_verified_in_its_language_without_english_texts(content: dict[str, Any], language: Language) -> None:
    assert find_untranslated(content) == []
    certificate, _ = build_pages(content, language)
    page = render_html(certificate)
    assert check_pages(parse_html_certificate(page.encode(), "page")).outcome == "proved"
    pdf = parse_pdf_certificate(render_pdf(certificate), "pdf")
    assert check_pages(pdf).outcome == "proved"


def headline(content: dict[str, Any]) -> str:
    results = Results.model_validate(content)
    return build_procedure_headline(results, results.procedure)


def test_headline_names_steps_that_are_missing_or_for_information(content: dict[str, Any]) -> None:
    close = count_close(Results.model_validate(content))
    assert headline(content) == f"6 of 6 required steps pass, {close} values close to a limit."
    changed = copy.deepcopy(content)
    steps = changed["procedure"]["steps"]
    change_keys(steps, {"0.state": "not done", "0.verdict": "skip", "4.verdict": "fail", "5.required": False})
    changed["accepted_unconfirmed"] = [changed["system"]["name"]]
    assert headline(changed) == (
        f"3 of 5 required steps pass, {close} values close to a limit. "
        "Pantograph model: not done. Line tests: FAIL. Not required, for information: "
        "Limits of validity (PASS). Accepted by the user: unconfirmed records of Pantocheck reference simulator."
    )


def test_reasons_name_criteria_and_claims_that_do_not_pass(content: dict[str, Any]) -> None:
    assert list_step_reasons(Procedure.model_validate(content["procedure"])) == ()
    changed = copy.deepcopy(content)
    change_keys(
        changed["procedure"],
        {
            "steps.1.criteria.0.reason": "2 % above the upper limit",
            "steps.2.unconfirmed": "not confirmed by every run: start",
            "steps.4.reason": "the run was interrupted",
            "claims.2.reason": "the runs that passed cover 160 to 180 km/h",
        },
    )
    (section,) = list_step_reasons(Procedure.model_validate(changed["procedure"]))
    (block,) = section.blocks
    assert block.items == (
        "Static check of the line model, Largest difference of the elasticity, relative to the measured one: 2 % above "
        "the upper limit",
        "Simulation parameters: not confirmed by every run: start",
        "Line tests: the run was interrupted",
        "Claim not shown by a run: Speed: the runs that passed cover 160 to 180 km/h",
    )


def test_junit_has_a_suite_for_every_step_and_case(content: dict[str, Any]) -> None:
    root = ElementTree.fromstring(render_junit(Results.model_validate(content)))
    names = [suite.attrib["name"] for suite in root]
    assert names[:2] == ["step/pantograph_model", "step/static_check"]
    assert names[6:] == ["en50318-2002/250", "pair/160-up", "pair/200-up", "pair/200-up-two"]
    assert (root.attrib["failures"], root.attrib["errors"]) == ("0", "0")
    changed = copy.deepcopy(content)
    change_keys(changed["procedure"], {"steps.1.verdict": "fail", "steps.2.required": False, "steps.2.verdict": "fail"})
    root = ElementTree.fromstring(render_junit(Results.model_validate(changed)))
    suites = {suite.attrib["name"]: suite for suite in root}
    assert suites["step/static_check"].attrib["failures"] == "1"
    assert suites["step/simulation_parameters"].attrib["failures"] == "0"
    assert len(suites["step/limits_of_validity"]) == 1 + len(content["procedure"]["claims"])


def test_badge_and_summary_state_the_steps(content: dict[str, Any]) -> None:
    assert "pass 6/6 steps" in render_badge(Results.model_validate(content))
    text = summarise(content)
    assert text.startswith("# PASS, CLOSE: 6 of 6 required steps pass")
    assert "| 5 Line tests | PASS | decides the verdict |" in text.replace("&#8203;", "")


@pytest.mark.parametrize(
    ("key", "value", "found"),
    [
        ("procedure.steps.0.verdict", "fail", "step pantograph_model"),
        ("procedure.steps.1.margin", 0.9, "step static_check"),
        ("procedure.steps.1.criteria.0.value", 50.0, "step static_check"),
        ("procedure.steps.5.state", "not done", "step limits_of_validity"),
        ("procedure.claims.2.claimed", [100.0, 300.0], "claim on speed"),
        ("procedure.evidence.1.passed", False, "passed runs"),
        ("procedure.evidence.1.speed_km_h", 300.0, "claim on speed"),
        ("procedure.steps.4.cases", [], "belongs to 0 steps"),
        ("cases.1.criteria.0.upper", 80.0, "pair/160-up"),
    ],
)
def test_changed_number_is_found(content: dict[str, Any], key: str, value: Any, found: str) -> None:
    changed = copy.deepcopy(content)
    change_keys(changed, {key: value})
    assert any(found in text for text in find_discrepancies(Results.model_validate(changed))), key


def test_runs_on_another_line_are_no_evidence_for_the_claimed_speeds(
    content: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The line of the first run has no claim, so its point is neither passed nor not passed."""
    changed = copy.deepcopy(content)
    evidence = changed["procedure"]["evidence"]
    claimed = {claim["name"] for claim in changed["procedure"]["claims"] if claim["kind"] == "line"}
    own = [item for item in evidence if item["line"] in claimed]
    assert own
    charts: list[Chart] = []
    monkeypatch.setattr(step_sections, "draw_chart", lambda chart: charts.append(chart) or "<svg/>")
    changed["procedure"]["evidence"] = [own[0] | {"line": "a line without a claim", "speed_km_h": 999.0}, *own]
    certify(changed)
    points = {series.label: series.y for series in charts[-1].series}
    assert points.pop("another line") == [999.0]
    assert sorted(speed for speeds in points.values() for speed in speeds) == sorted(item["speed_km_h"] for item in own)


@pytest.mark.parametrize(
    ("language", "suffix"),
    [
        ("en", "json"),
        *(pytest.param(*pair, marks=pytest.mark.thorough) for pair in product(LANGUAGES, ("html", "pdf"))),
    ],
)
def test_unsigned_dossier_is_not_accepted(results: Results, tmp_path: Path, language: Language, suffix: str) -> None:
    """Exit code 1 whatever the verdict: anyone can have written it."""
    document, path = replace(build_certificate(results), language=language), tmp_path / f"dossier.{suffix}"
    match suffix:
        case "json":
            path.write_bytes(results.to_json())
        case "html":
            path.write_text(render_html(document), "utf-8")
        case _:
            path.write_bytes(render_pdf(document))
    done = pantocheck("verify", path, "--any-verdict")
    assert (done.exit_code, done.stdout.split(":")[0]) == (1, "UNSIGNED")
    assert pantocheck("verify", path, "--any-verdict", "--numbers-only").exit_code == 0

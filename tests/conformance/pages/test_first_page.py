"""Page 1: the answers in their order, each number once, on one sheet."""

from dataclasses import replace
from io import BytesIO
from typing import Any

import pytest
from pypdf import PdfReader

from helpers.shown_page import certify, find_facts, print_certificate, shown_certificate
from pantocheck.conformance.pages.document import Answers, Document, Figures, Section, Table, digest_results
from pantocheck.conformance.pages.first_page import MOST_CASES, MOST_GRADED, MOST_REASONS, MOST_SENTENCES
from pantocheck.conformance.pages.markdown import render_markdown
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.pages.translation import translate
from pantocheck.conformance.results.report_files import LANGUAGES, Language
from pantocheck.conformance.results.results_format import Results

QUESTIONS = ["Tested item", "Cases and limits", "Result", "Use", "Issued by", "Check of this document"]


def list_values(document: Document) -> list[Table]:
    """Tables of graded values on page 1."""
    [answers] = [block for block in document.blocks if isinstance(block, Answers)]
    blocks = [block for section in answers.sections for block in section.blocks]
    return [block for block in blocks if isinstance(block, Table) and block.layout == "values"]


def test_answers_stand_in_their_order_on_one_sheet(results: dict[str, Any]) -> None:
    """Three cases with 21 graded values; the first sheet ends behind the digest of the results."""
    [answers] = [block for block in certify(results).blocks if isinstance(block, Answers)]
    assert [section.heading for section in answers.sections] == QUESTIONS
    sheet = " ".join(PdfReader(BytesIO(print_certificate(results))).pages[0].extract_text().split())
    places = [sheet.index(text) for text in (*QUESTIONS, "Digest of the results")]
    assert places == sorted(places)
    facts = dict(find_facts(certify(results), "tested"))
    assert facts["Speed"] == "250, 300, 320 km/h"


@pytest.mark.parametrize("language", LANGUAGES)
def test_first_sheet_ends_behind_the_digest_in_every_language(results: dict[str, Any], language: Language) -> None:
    """Long names of cases and long reasons: no name of a quantity is broken, and page 1 is still one sheet."""
    case, *others = results["cases"]
    case["id"] = "own/a-long-folder/a-long-name-of-a-case"
    failed = {"verdict": "fail", "margin": -0.1, "trust": "primary", "source": "other"}
    rows = [row | failed for row in case["criteria"]]
    others[0] |= {"id": f"{case['id']}-2", "criteria": rows[: MOST_GRADED - len(rows)]}
    for case in results["cases"]:
        case["warnings"] = [f"{number}: {'a long warning of every case, ' * 9}" for number in range(MOST_SENTENCES)]
    certificate = replace(certify(results), language=language)
    sheet = PdfReader(BytesIO(render_pdf(certificate))).pages[0].extract_text()
    assert any(line.startswith(translate("Mean contact force", language).text) for line in sheet.splitlines())
    assert digest_results(Results.model_validate(results))[-12:] in sheet


def test_value_stands_in_one_table(passing: dict[str, Any]) -> None:
    """The section of a case repeats no row of page 1."""
    document = certify(passing)
    [table] = list_values(document)
    rows = sum(len(case["criteria"]) for case in passing["cases"])
    assert len(table.rows) == rows <= MOST_GRADED
    passing["cases"][0]["criteria"][0]["value"] = 117.77
    assert shown_certificate(passing).count("117.8 N") == 1


def test_cases_beyond_the_room_keep_their_tables_and_list(passing: dict[str, Any]) -> None:
    case = passing["cases"][0]
    passing["cases"] = [case | {"id": f"own/{number}"} for number in range(MOST_CASES + 1)]
    document = certify(passing)
    [table] = list_values(document)
    assert {row[1] for row in table.rows} == {"own/0"}
    sections = {block.anchor: block for block in document.blocks if isinstance(block, Section)}
    assert len(sections["cases"].blocks[0].rows) == MOST_CASES + 1  # type: ignore[union-attr]
    [criteria] = [
        part for part in sections["case-2"].blocks if isinstance(part, Section) and part.heading == "Criteria"
    ]
    assert any(isinstance(block, Table) and len(block.rows) == len(case["criteria"]) for block in criteria.blocks)


def test_reasons_that_page_1_has_no_room_for_stand_in_a_section(passing: dict[str, Any]) -> None:
    """Page 1 counts the others; the section lists all."""
    rows = passing["cases"][0]["criteria"]
    for row in rows[: MOST_REASONS + 2]:
        row |= {"verdict": "fail", "margin": -0.1}
    text = dict(find_facts(certify(passing), "result"))["Failed"]
    assert text.count(", margin ") == MOST_REASONS
    assert text.endswith("Under Reasons: 2 more.")
    markdown = render_markdown(certify(passing))
    assert markdown[markdown.index("## Reasons") :].count(", margin ") == MOST_REASONS + 2


@pytest.mark.parametrize("others", [["one"], []])
def test_warning_of_every_case_is_said_once(results: dict[str, Any], others: list[str]) -> None:
    results["cases"][0]["warnings"] = ["one", "of the first"]
    results["cases"][1]["warnings"] = others
    text = render_markdown(certify(results))
    assert text.count("Warning: one\n") == (0 if others else 1)
    assert text.count("* one\n") == (1 if others else 0)
    assert text.count("Warning: of the first\n") == 1


def test_forces_are_drawn_without_graded_values(passing: dict[str, Any]) -> None:
    """A case without limits has forces, too; those of the graded cases come first."""
    case = passing["cases"][0]
    passing["cases"] = [case | {"criteria": []}]
    [answers] = [block for block in certify(passing).blocks if isinstance(block, Answers)]
    [figures] = [block for block in answers.sections[2].blocks if isinstance(block, Figures)]
    assert [figure.caption.split(": ")[0].split(", ")[1] for figure in figures.figures] == [
        "pantograph 1",
        "pantograph 2",
    ]

"""Sections of cases: skipped cases, repeated notes and inputs, values of inputs."""

from typing import Any

from helpers.shown_page import certify, find_facts
from pantocheck.conformance.pages.case_section import (
    AUTHOR,
    ShownCase,
    build_case_section,
    input_blocks,
    list_shown_cases,
)
from pantocheck.conformance.pages.document import Answers, BulletList, Section, SmallPrint, Table
from pantocheck.conformance.pages.first_page import plan_first_page
from pantocheck.conformance.results.results_format import CaseResult, Results

SPANS = {"count": 40, "lowest": 50, "highest": 65}
VALUES = {"tension_N": 20000.0, "mass_kg_m": 1.35, "span_list.length_m": SPANS}
WIRE = {"group": "line.contact_wire", "trust": "secondary", "source": "a book", "values": VALUES}
UNTRACED = {"group": "line.contact_wire.mass_kg_m", "trust": "provisional", "source": "not traced", "values": {}}


def show_cases(results: dict[str, Any]) -> list[ShownCase]:
    """Shown cases of results."""
    content = Results.model_validate(results)
    return list_shown_cases(content.cases, plan_first_page(content))


def test_skipped_cases_have_no_section_and_share_a_sentence(results: dict[str, Any]) -> None:
    """The skipped case stands in the table of cases and among the reasons only."""
    skipped = results["cases"][2]
    shown = [shown.case.id for shown in show_cases(results)]
    assert shown == ["en50318-2002/250", "en50318-2002/300"]
    document = certify(results)
    headings = [block.heading for block in document.blocks if isinstance(block, Section)]
    assert skipped["title"] not in headings
    [answers] = [block for block in document.blocks if isinstance(block, Answers)]
    index = answers.sections[1].blocks[0]
    assert isinstance(index, Table)
    assert skipped["id"] in [row[0] for row in index.rows]
    section = build_case_section(show_cases(results)[0])
    headings = [block.heading for block in section.blocks if isinstance(block, Section)]
    assert headings.index("Figures") == headings.index("Criteria") + 1
    assert headings.index("Figures") < headings.index("All quantities, with uncertainty by component")
    results["cases"].append(results["cases"][2] | {"id": "own/other"})
    sentence = f"{results['cases'][2]['id']}, own/other: {results['cases'][2]['reason']}"
    assert sentence in dict(find_facts(certify(results), "result"))["Not evaluated"]


def test_notes_of_an_earlier_case_are_counted(results: dict[str, Any]) -> None:
    first, second = results["cases"][:2]
    second["notes"] = [*first["notes"], "A note of its own."]
    section = build_case_section(show_cases(results)[1])
    [notes] = [block for block in section.blocks if isinstance(block, Section) and block.heading == "Notes"]
    assert notes.blocks == (BulletList(("A note of its own.", "1 note as in en50318-2002/250.", AUTHOR)),)
    second["library"] = "identical"
    section = build_case_section(show_cases(results)[1])
    [notes] = [block for block in section.blocks if isinstance(block, Section) and block.heading == "Notes"]
    assert notes.blocks == (BulletList(("A note of its own.", "1 note as in en50318-2002/250.")),)


def test_inputs_have_values_with_units_and_marks(passing: dict[str, Any]) -> None:
    """A single provisional value is marked in its group; it has no row of its own."""
    case = CaseResult.model_validate(passing["cases"][0] | {"inputs": [WIRE, UNTRACED]})
    table, sources, key = input_blocks(case, (), "case-1-input-source")
    assert isinstance(table, Table)
    [row] = table.rows
    assert row[1] == "tension 20000 N; mass 1.35 kg/m ○; span list, length 40 values, 50 to 65 m"
    assert sources.items == ("a book",)  # type: ignore[union-attr]
    assert key == SmallPrint("○: value not traced to a printed source.")
    [text] = input_blocks(case, (case.model_copy(update={"id": "own/first"}),), "case-2-input-source")
    assert text == SmallPrint("As in own/first: line.contact_wire.")
    case = CaseResult.model_validate(passing["cases"][0] | {"inputs": [WIRE | {"values": {}}, UNTRACED]})
    table, _ = input_blocks(case, (), "case-1-input-source")
    assert isinstance(table, Table)
    assert [row[1] for row in table.rows] == ["–", "–"]

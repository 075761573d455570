"""Conditions of the band from 20 to 50 Hz in certificate and summary: sentence, mark and table."""

import csv
from typing import Any
from xml.etree import ElementTree

import pytest

from helpers.shown_page import certify, summarise
from pantocheck.conformance.pages.ci_reports import render_junit
from pantocheck.conformance.pages.condition_sections import (
    BAND_MARK,
    build_condition_section,
    describe_condition,
    mark_values,
)
from pantocheck.conformance.pages.document import Code, Paragraph, Remark, Section, Table
from pantocheck.conformance.pages.quantity_tables import build_quantity_table, render_quantity_list
from pantocheck.conformance.results.results_format import CaseResult, Results

SPRING = {
    "group": "pantograph 1.contact", "trust": "provisional", "source": "untraced", "values": {"stiffness_N_m": 50000.0}
}  # fmt: skip
CONDITIONS = [
    {
        "name": "half of the spring",
        "group": "contact",
        "changes": {"1": {"rms_20_50_N": -54.2}, "2": {"rms_20_50_N": -50.0}},
    },
    {
        "name": "contact stiffness +100 %",
        "group": "contact",
        "changes": {"1": {"rms_20_50_N": 31.04}, "0": {"max_uplift_at_support_mm": 1.0}},
    },
    {"name": "contact stiffness of an arm", "group": "supports", "changes": {"1": {"rms_20_50_N": 9.0}}},
    {"name": "steady arm -0.1 kg", "group": "supports", "not_applicable": "the value cannot be below 0 kg"},
]


@pytest.fixture
def conditioned(passing: dict[str, Any]) -> dict[str, Any]:
    """Results of two pantographs on a case with an untraced contact spring and stored conditions."""
    case = passing["cases"][0]
    case["inputs"] = [*(group for group in case["inputs"] if not group["group"].endswith("contact")), {**SPRING}]
    case["conditions"], case["input_studies"] = CONDITIONS, ["Resolving power: 5 %."]
    return passing


def model(results: dict[str, Any]) -> CaseResult:
    return CaseResult.model_validate(results["cases"][0])


def test_sentence_states_the_spring_its_source_and_its_effect(conditioned: dict[str, Any]) -> None:
    assert describe_condition(model(conditioned)) == (
        "‡ Values from 20 to 50 Hz are conditional on a contact spring of 50 kN/m, which is not traced. They change by "
        "−54.2 % and −50 % with half of the spring; +31 % with contact stiffness +100 %."
    )
    conditioned["cases"][0]["conditions"] = []
    conditioned["cases"][0]["inputs"][-1] |= {"trust": "secondary", "values": {"stiffness_N_m": 67500.0}}
    assert describe_condition(model(conditioned)) == (
        "‡ Values from 20 to 50 Hz are conditional on a contact spring of 67.5 kN/m, whose source is secondary "
        "(printed in another publication or public source)."
    )


@pytest.mark.parametrize(
    ("values", "law"),
    [
        ({"law": "hertz", "effective_modulus_N_m2": 1.1e10, "effective_radius_m": 0.02}, "contact by the law of Hertz"),
        ({"law": "constraint"}, "contact by a constraint"),
    ],
)
def test_sentence_names_every_contact_law(conditioned: dict[str, Any], values: dict[str, Any], law: str) -> None:
    case = conditioned["cases"][0]
    case["inputs"][-1] |= {"values": values}
    case["conditions"] = [
        {"name": "contact by a constraint", "group": "contact", "changes": {"1": {"rms_20_50_N": 21.9}}}
    ]
    assert describe_condition(model(conditioned)) == (
        f"‡ Values from 20 to 50 Hz are conditional on {law}, which is not traced. They change by +21.9 % with contact "
        "by a constraint."
    )


def test_no_spring_or_no_value_needs_no_condition(conditioned: dict[str, Any]) -> None:
    """A measured record has no contact spring, and a line at rest no band."""
    case = conditioned["cases"][0]
    for part, content in (("inputs", []), ("quantities", {"1": {"mean_force_N": 120.0}})):
        other = CaseResult.model_validate(case | {part: content})
        assert describe_condition(other) == ""
        assert mark_values(other, (build_quantity_table(other),)) == (build_quantity_table(other),)


def list_rows(block: Any) -> list[tuple[str, Any]]:
    """First cells of all tables below a block."""
    if isinstance(block, Section):
        return [row for part in block.blocks for row in list_rows(part)]
    return [row[0] for row in block.rows] if isinstance(block, Table) else []


def test_every_row_of_the_band_has_the_mark_and_no_other(conditioned: dict[str, Any]) -> None:
    cells = [cell for block in certify(conditioned).blocks for cell in list_rows(block) if isinstance(cell, tuple)]
    marked = [cell for cell in cells if f" {BAND_MARK}" in cell]
    band = [cell for cell in cells if Code("rms_20_50_N") in cell]
    assert len(band) >= 2  # criteria, all quantities
    assert marked == band
    summary = summarise(conditioned)
    rows = [line for line in summary.splitlines() if line.startswith("| RMS, 20–50 Hz")]
    assert all(f"RMS, 20–50 Hz {BAND_MARK} |" in row for row in rows)
    assert summary.count(f"{BAND_MARK} Values from 20 to 50 Hz") == 1
    assert "Resolving power: 5 %." in summary


def test_table_lists_changes_of_both_pantographs_and_reasons(conditioned: dict[str, Any]) -> None:
    (section,) = build_condition_section(model(conditioned))
    table, text = section.blocks
    assert [row[0] for row in table.rows[:2]] == ["half of the spring", "contact stiffness +100 %"]
    assert table.rows[0][-1] == "−54.2 / −50"
    assert table.rows[1][-1] == "+31 / –"
    assert table.rows[3][0] == ("steady arm −0.1 kg", Remark("not applicable: the value cannot be below 0 kg"))
    assert text.text.endswith("Values of pantograph 1 / pantograph 2.")
    conditioned["cases"][0]["conditions"] = []
    assert build_condition_section(model(conditioned)) == ()


def test_text_without_a_table_is_not_marked(conditioned: dict[str, Any]) -> None:
    paragraph = Paragraph("RMS, 20–50 Hz")
    assert mark_values(model(conditioned), (paragraph,)) == (paragraph,)


def test_list_of_quantities_and_junit_state_the_condition(conditioned: dict[str, Any]) -> None:
    """In the list at the values of the band alone; in JUnit once for each case."""
    results = Results.model_validate(conditioned)
    rows = list(csv.DictReader(render_quantity_list(results).splitlines()))
    stated = {row["quantity"] for row in rows if row["condition"]}
    assert stated == {"rms_20_50_N"}
    [text] = {row["condition"] for row in rows if row["condition"] and row["case"] == results.cases[0].id}
    assert text.startswith("Values from 20 to 50 Hz are conditional on a contact spring of ")
    suite = ElementTree.fromstring(render_junit(results))[0]
    properties = {row.get("name"): row.get("value") for row in suite.iter("property")}
    assert properties["condition"] == f"{BAND_MARK} {text}"

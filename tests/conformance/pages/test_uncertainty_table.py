"""Table of the uncertainty by component in the certificate."""

from typing import Any

from helpers.shown_page import certify, shown_certificate
from pantocheck.conformance.pages.document import BulletList, Code, Section, Table
from pantocheck.conformance.pages.quantity_tables import build_quantity_table, draw_spark_line, uncertainty_blocks
from pantocheck.conformance.pages.words import format_value
from pantocheck.conformance.results.results_format import CaseResult


def test_table_has_every_component_of_every_quantity(passing: dict[str, Any]) -> None:
    """Both pantographs; an unknown component is a dash, and its reason stands above the table."""
    case = passing["cases"][0]
    basis, table = uncertainty_blocks(CaseResult.model_validate(case))
    assert isinstance(table, Table)
    assert isinstance(basis, BulletList)
    assert basis.items[1].startswith("Start: 7 runs with other starts and ramps")
    assert basis.items[3] == "Length: not known: the analysis section is shorter than 5 spans."
    headings = [column.heading for column in table.columns]
    assert headings[3:] == ["Combined", "Discretisation", "Start", "Section", "Length"]
    rows = {(row[1], row[0][1]): row for row in table.rows}
    assert len(rows) == sum(len(case["quantities"][key]) for key in "12")
    for pantograph in ("1", "2"):
        value = case["quantities"][pantograph]["std_force_N"]
        widths = [format_value(share * value, 2) for share in (0.0025, 0.0015, 0.002)]
        combined, *others = widths
        assert rows[f"pantograph {pantograph}", Code("std_force_N")][2:] == ("N", f"{combined}*", *others, "–", "–")


def test_model_uncertainty_stands_below_the_components_and_changes_no_width(passing: dict[str, Any]) -> None:
    case = passing["cases"][0]
    _, table = uncertainty_blocks(CaseResult.model_validate(case))
    case["model_uncertainty"] = ["Constant tension. Maximum of the 20 Hz force: 0.8 %."]
    basis, same = uncertainty_blocks(CaseResult.model_validate(case))
    assert isinstance(basis, BulletList)
    assert len(basis.items) == 5
    assert basis.items[4] == (
        "Model, not part of the combined width: Constant tension. Maximum of the 20 Hz force: 0.8 %."
    )
    assert same == table


def test_several_values_have_the_largest_of_their_half_widths(passing: dict[str, Any]) -> None:
    case = passing["cases"][0]
    case["quantities"]["0"]["presag_mm"] = [20.0, 55.0]
    case["uncertainty"]["0"] = {"presag_mm": [0.5, 0.25]}
    case["uncertainty_components"]["0"] = {"presag_mm": {"discretisation": [0.5, 0.25]}}
    _, table = uncertainty_blocks(CaseResult.model_validate(case))
    assert isinstance(table, Table)
    assert table.rows[-1][1:] == ("line", "mm", "0.50*", "0.50", "–", "–", "–")
    cells = {row[0][1]: row for row in build_quantity_table(CaseResult.model_validate(case)).rows}
    assert cells[Code("presag_mm")][-1] == "20.000, 55.000"
    # The curve of 3 points spans the height of the drawing inside its margins of 2; equal values lie at one height.
    assert 'points="2.00,16.00 50.00,2.00 98.00,9.00"' in draw_spark_line([1.0, 3.0, 2.0])
    assert 'points="2.00,16.00 98.00,16.00"' in draw_spark_line([1.0, 1.0])
    case = passing["cases"][0]
    case["quantities"]["0"] = {"presag_mm": [0.5] * 10, "elasticity_along_span_mm_N": [0.25, *[0.5] * 23]}
    case["uncertainty"]["0"] = {}
    cells = {row[0][1]: row[-1] for row in build_quantity_table(CaseResult.model_validate(case)).rows}
    assert cells[Code("presag_mm")].count("0.50000") == 10
    drawing, text = cells[Code("elasticity_along_span_mm_N")]
    assert drawing.svg == draw_spark_line([0.25, *[0.5] * 23])
    assert drawing.alternative == text.strip() == "24 values, 0.25000 to 0.50000"


def test_certificate_shows_the_components_only_where_there_are_results(results: dict[str, Any]) -> None:
    sections = [block for block in certify(results).blocks if isinstance(block, Section)]
    found = {
        section.heading: [part.heading for part in section.blocks if isinstance(part, Section)] for section in sections
    }
    named = [heading for heading, parts in found.items() if "Uncertainty by component" in parts]
    assert len(named) == 2
    assert "is not known. A quantity with several values" in shown_certificate(results)

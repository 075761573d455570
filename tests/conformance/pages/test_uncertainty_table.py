"""Table of all quantities with their uncertainty by component in the certificate."""

from typing import Any

from helpers.shown_page import certify, shown_certificate
from pantocheck.conformance.pages.document import Code, RichText, Section
from pantocheck.conformance.pages.quantity_tables import build_quantity_table, list_uncertainty_basis
from pantocheck.conformance.pages.words import format_value
from pantocheck.conformance.results.results_format import CaseResult


def list_rows(case: dict[str, Any]) -> dict[tuple[str, Code], tuple[RichText, ...]]:
    """Rows of the table by pantograph and name of the quantity."""
    rows = build_quantity_table(CaseResult.model_validate(case)).rows
    return {(str(row[1]), row[0][1]): row for row in rows}  # type: ignore[index]


def test_table_has_every_component_of_every_quantity(passing: dict[str, Any]) -> None:
    """Both pantographs; a graded value stands above, and an unknown component only among the sentences."""
    case = passing["cases"][0]
    result = CaseResult.model_validate(case)
    basis = list_uncertainty_basis(result)
    assert basis[1].startswith("Start: 7 runs with other starts and ramps")
    assert basis[3] == "Length: not known: the analysis section is shorter than 5 spans."
    headings = [column.heading for column in build_quantity_table(result).columns]
    assert headings == ["Quantity", "Pantograph", "Unit", "Value", "Uncertainty", "Discretisation", "Start"]
    rows = list_rows(case)
    assert len(rows) == sum(map(len, case["quantities"].values()))
    for pantograph in ("1", "2"):
        for name, unit, graded in (("std_force_N", "N", True), ("cov_20", "–", False)):
            value = case["quantities"][pantograph][name]
            combined, *others = (format_value(share * value, 2) for share in (0.0025, 0.0015, 0.002))
            shown = ("above", "above") if graded else (format_value(value, 5), combined)
            assert rows[pantograph, Code(name)][2:] == (unit, *shown, *others)


def test_model_uncertainty_stands_below_the_components_and_changes_no_width(passing: dict[str, Any]) -> None:
    case = passing["cases"][0]
    rows = list_rows(case)
    case["model_uncertainty"] = ["Constant tension. Maximum of the 20 Hz force: 0.8 %."]
    basis = list_uncertainty_basis(CaseResult.model_validate(case))
    assert basis[4] == "Model, not part of the uncertainty: Constant tension. Maximum of the 20 Hz force: 0.8 %."
    assert list_rows(case) == rows
    case["uncertainty_basis"] = dict.fromkeys(case["uncertainty_basis"], "does not apply: the line is at rest")
    stated, model = list_uncertainty_basis(CaseResult.model_validate(case))
    assert stated == "Discretisation, start, section, length: does not apply: the line is at rest."
    assert model == basis[4]


def test_several_values_have_the_largest_of_their_half_widths(passing: dict[str, Any]) -> None:
    case = passing["cases"][0]
    case["quantities"]["0"]["presag_mm"] = [20.0, 55.0]
    case["uncertainty"]["0"] = {"presag_mm": [0.5, 0.25]}
    case["uncertainty_components"]["0"] = {"presag_mm": {"discretisation": [0.5, 0.25]}}
    assert list_rows(case)["line", Code("presag_mm")][2:] == ("mm", "20.000, 55.000", "0.50", "0.50", "–")
    case["quantities"]["0"] = {"presag_mm": [0.5] * 5, "elasticity_along_span_mm_N": [0.25, *[0.5] * 23]}
    rows = list_rows(case)
    assert str(rows["line", Code("presag_mm")][3]).count("0.50000") == 5
    assert rows["line", Code("elasticity_along_span_mm_N")][3] == "24 values, 0.25000 to 0.50000"


def test_closed_forms_are_exact_and_values_without_a_known_width_are_not(passing: dict[str, Any]) -> None:
    """The length of the record is not known, and has no influence on the line at rest."""
    case = passing["cases"][0]
    for owner, name in (("0", "wave_speed_m_s"), ("1", "cov_50")):
        case["quantities"][owner][name] = 1.0
        case["uncertainty"].setdefault(owner, {})[name] = 0.0
        case["uncertainty_components"].setdefault(owner, {})[name] = {"discretisation": 0.0}
    rows = list_rows(case)
    assert rows["line", Code("wave_speed_m_s")][4] == "exact"
    assert rows["1", Code("cov_50")][4] == "not known"


def test_certificate_shows_the_components_only_where_there_are_results(results: dict[str, Any]) -> None:
    sections = [block for block in certify(results).blocks if isinstance(block, Section)]
    found = {
        section.heading: [part.heading for part in section.blocks if isinstance(part, Section)] for section in sections
    }
    named = [heading for heading, parts in found.items() if "All quantities, with uncertainty by component" in parts]
    assert len(named) == 2
    assert "is not known. A quantity with several values" in shown_certificate(results)

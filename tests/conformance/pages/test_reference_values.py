"""Values of the reference simulator in a certificate: columns, curve and note, only where they were requested."""

from typing import Any

import pytest

from helpers.shown_page import print_certificate, show_certificate
from pantocheck.conformance.core.figure_data import Traces
from pantocheck.conformance.core.panel_figure import PanelFigure
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.case_figures import draw_force
from pantocheck.conformance.pages.criteria_table import criteria_blocks, find_reference, reference_note
from pantocheck.conformance.pages.quantity_tables import build_quantity_table
from pantocheck.conformance.results.results_format import CaseResult


@pytest.fixture
def case(passing: dict[str, Any]) -> dict[str, Any]:
    """First case of the example, with a reference whose values are 1 % larger."""
    (first,) = passing["cases"]
    quantities = {
        owner: {name: 1.01 * value for name, value in values.items()} for owner, values in first["quantities"].items()
    }
    forces = {owner: [1.01 * force for force in trace["force_20_N"]] for owner, trace in first["traces"].items()}
    first["reference"] = {
        "name": "Reference", "version": "3", "reason": None, "quantities": quantities,
        "uncertainty": {owner: {"mean_force_N": 0.5} for owner in quantities}, "force_20_N": forces,
    }  # fmt: skip
    return first


def test_criteria_and_quantities_have_a_column_of_the_reference(case: dict[str, Any]) -> None:
    result = CaseResult.model_validate(case)
    table = criteria_blocks(result.criteria, "case-1", "case-1-source", result)[0]
    assert isinstance(table, doc.Table)
    assert [column.heading for column in table.columns][3:6] == ["Uncertainty", "Reference", "Limits"]
    expected = 1.01 * case["criteria"][0]["value"]
    assert float(str(table.rows[0][4])) == pytest.approx(expected, rel=1e-3)
    assert {len(row) for row in table.rows} == {len(table.columns)}
    table = build_quantity_table(CaseResult.model_validate(case))
    headings = [column.heading for column in table.columns]
    assert headings[3:6] == ["Value", "Reference", "Uncertainty"]
    mean = next(row for row in table.rows if "mean_force_N" in str(row[0]))
    assert float(str(mean[4])) == pytest.approx(expected, rel=1e-3)


def test_items_and_forces_of_the_reference_are_found(case: dict[str, Any]) -> None:
    case["reference"]["quantities"]["0"]["presag_mm"] = [10.0, 20.0]
    result = CaseResult.model_validate(case)
    row = result.criteria[0].model_copy(update={"quantity": "presag_mm", "pantograph": 0, "item": 2})
    assert find_reference(result, row) == 20.0
    assert find_reference(result, row.model_copy(update={"item": 3})) is None
    assert find_reference(result, row.model_copy(update={"quantity": "elasticity_mm_N", "item": None})) is None
    trace, force = Traces.model_validate(case["traces"]["1"]), case["reference"]["force_20_N"]["1"]
    for reference, count in ((force, 1), ([], 0)):
        figure = draw_force.__wrapped__(trace, reference)  # type: ignore[attr-defined]
        assert isinstance(figure, PanelFigure)
        labels = [label for label, _ in figure.axes[0].legend]
        assert len([label for label in labels if label.startswith("reference")]) == count
    assert labels[:2] == ["unfiltered", "0–20 Hz"]


def test_certificate_names_the_reference_and_the_reason_without_values(
    passing: dict[str, Any], case: dict[str, Any]
) -> None:
    page = show_certificate(passing)
    assert "Reference: values of the Reference 3, for information." in page
    assert "Behind: the reference simulator." in page
    assert print_certificate(passing).startswith(b"%PDF")
    case["reference"] |= {"reason": "no solution", "quantities": {}, "uncertainty": {}, "force_20_N": {}}
    assert reference_note(CaseResult.model_validate(case)) == (
        doc.Paragraph("Reference 3: no values for comparison, no solution."),
    )
    result = CaseResult.model_validate(case)
    table = criteria_blocks(result.criteria, "case-1", "case-1-source", result)[0]
    assert isinstance(table, doc.Table)
    assert "Reference" not in [column.heading for column in table.columns]


def test_certificate_without_a_reference_does_not_name_it(passing: dict[str, Any]) -> None:
    page = show_certificate(passing)
    assert "Reference:" not in page
    assert "Behind: the reference" not in page

"""Sections of the verification against closed forms: comparisons, orders of convergence and figures."""

from typing import Any

from pantocheck.conformance.core.figure_data import Chart
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.study_chart import draw_chart
from pantocheck.conformance.pages.words import format_value
from verification.guide.pages.convergence_chart import draw_convergence

AGREEMENT = {True: "yes", False: "NO"}
"""Words for a value inside or outside its tolerance."""


def build_topic_section(name: str, topic: dict[str, Any]) -> doc.Section:
    """Section of a topic."""
    blocks: list[doc.Block] = [doc.Paragraph(topic["theory"]), doc.Paragraph(topic["setting"])]
    if topic["comparisons"]:
        blocks += [build_value_table(topic["comparisons"]), list_tolerance_reasons(topic["comparisons"])]
    if topic["convergence"]:
        blocks += [_build_orders(topic["convergence"]), list_tolerance_reasons(topic["convergence"])]
    figures = [_draw_study(study) for study in topic["convergence"]]
    figures += [
        doc.Figure(draw_chart(Chart.model_validate(chart)), chart["alternative"], chart["caption"])
        for chart in topic["charts"]
    ]
    if figures:
        blocks.append(doc.Figures(tuple(figures)))
    return doc.Section(topic["title"], tuple(blocks), anchor=f"verification-{name}")


def build_value_table(rows: list[dict[str, Any]]) -> doc.Table:
    """Computed values beside their expected values."""
    numbers = ("Computed", "Expected", "Deviation", "Tolerance")
    columns = (
        doc.Column("Quantity", share=1),
        *(doc.Column(name, number=True) for name in numbers),
        doc.Column("Agrees"),
    )
    cells = tuple(
        (
            f"{row['quantity']} [{row['unit']}]",
            format_value(row["computed"], 6),
            format_value(row["expected"], 6),
            format_deviation(row, row["deviation"]),
            format_deviation(row, row["tolerance"]),
            AGREEMENT[row["agrees"]],
        )
        for row in rows
    )
    return doc.Table(columns, cells, layout="grid")


def format_deviation(row: dict[str, Any], value: float) -> str:
    """A deviation or tolerance: relative ones as a share, absolute ones in the unit."""
    unit = "" if row["kind"] == "relative" or row["unit"] == "-" else f" {row['unit']}"
    return format_value(value, 2) + unit


def _build_orders(rows: list[dict[str, Any]]) -> doc.Table:
    names = ("Refined", "Errors", "Orders", "Theory", "Agrees")
    columns = (doc.Column("Error of", share=1), *map(doc.Column, names))
    cells = tuple(
        (
            row["quantity"],
            row["parameter"],
            ", ".join(format_value(error, 3) for error in row["errors"]),
            ", ".join(format_value(order, 3) for order in row["orders"]),
            f"{format_value(row['theory'], 2)} ± {format_value(row['tolerance'], 2)}",
            AGREEMENT[row["agrees"]],
        )
        for row in rows
    )
    return doc.Table(columns, cells, layout="grid")


def list_tolerance_reasons(rows: list[dict[str, Any]]) -> doc.Block:
    """Reasons of the tolerances, each once."""
    return doc.SmallPrint(" ".join(dict.fromkeys(row["reason"] for row in rows)))


def _draw_study(study: dict[str, Any]) -> doc.Figure:
    pairs = zip(study["steps"], study["errors"], strict=True)
    points = ", ".join(f"{format_value(error, 2)} at {format_value(step, 3)}" for step, error in pairs)
    return doc.Figure(
        draw_convergence(study),
        f"Error of the {study['quantity']} against the {study['parameter']}: {points}; "
        f"a line shows order {study['theory']:g}.",
        f"Convergence: {study['quantity']}.",
        wide=False,
    )

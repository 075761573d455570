"""Errors against a refined step, beside the slope of the theoretical order."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, NullLocator

from pantocheck.conformance.core.figure_data import Chart
from pantocheck.conformance.core.figure_style import HALF, INK, SHADES, add_legend, label_decades, render_svg
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.study_chart import draw_chart
from pantocheck.conformance.pages.words import format_value


@render_svg
def draw_convergence(study: dict[str, Any]) -> Figure:
    """Errors of a convergence study of guide.json on logarithmic axes."""
    steps, errors = np.array(study["steps"]), np.array(study["errors"])
    figure = Figure(figsize=(HALF, 2.1))
    axes = figure.subplots()
    axes.set(xscale="log", yscale="log", xlabel=study["parameter"], ylabel="relative error [-]")
    slope = errors[-1] * (steps / steps[-1]) ** study["theory"]
    axes.plot(steps, slope, "--", color=SHADES[1], linewidth=1.0, label=f"order {study['theory']:g}")
    axes.plot(steps, errors, "o-", color=INK, linewidth=1.0, markersize=3.5, label="computed")
    label_decades(axes.yaxis)
    axes.set_xticks(steps, [f"{step:g}" for step in steps])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.margins(x=0.08)
    add_legend(axes, columns=2)
    return figure


# Sections of the verification against closed forms: comparisons, orders of convergence and figures.
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


# Section on the comparisons with packages of others.
PEER_SCOPE = (
    "Packages of others solve parts of the same problems. A comparison runs where its package is installed; no stored "
    "value replaces it."
)

INSTALL_LINE = "pip install 'pantocheck[peers]'"


def build_peer_section(peers: list[dict[str, Any]]) -> doc.Section:
    """Section with one part per package."""
    return doc.Section("Peers", (doc.Paragraph(PEER_SCOPE), *map(_build_peer, peers)), anchor="peers")


def _build_peer(peer: dict[str, Any]) -> doc.Section:
    blocks: tuple[doc.Block, ...] = (doc.Paragraph(peer["setting"]),)
    if peer["version"] is None:
        reason = (f"Not run: {peer['package']} is not installed. Install it with ", doc.Code(INSTALL_LINE), ".")
        blocks = (*blocks, doc.Paragraph(reason))
    else:
        version = f"Installed version: {peer['package']} {peer['version']}."
        rows = peer["comparisons"]
        blocks = (*blocks, doc.Paragraph(version), build_value_table(rows), list_tolerance_reasons(rows))
    return doc.Section(peer["title"], blocks)

"""Figure of static values along a line: measurement, model and their difference."""

from typing import TYPE_CHECKING

import numpy as np

from pantocheck.conformance.core.figure_style import (
    FULL,
    GREY,
    INK,
    LIMIT_FILL,
    PALE,
    add_legend,
    new_figure,
    render_svg,
)
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.comparison_parts import PageKind
from pantocheck.conformance.pages.words import format_plain, format_signed, format_value
from pantocheck.conformance.results.comparison_format import ComparedValues, SpanDifferences, StaticComparison

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@render_svg
def draw_static_values(
    values: ComparedValues, spans: tuple[SpanDifferences, ...], tolerance: float | None, section: tuple[float, float]
) -> "Figure":
    """Measured values and those of the model over neighbouring spans; below, their difference.

    Args:
        values: Values of one kind.
        spans: Spans of this figure, from the same values.
        tolerance: Largest accepted difference in the unit of the values; None: the band is not drawn.
        section: Start and end of the evaluated section [m]; the rest of the line has a grey background.
    """
    start, end = spans[0].start_m, spans[-1].end_m
    position = np.array(values.position_m)
    shown = (position >= start) & (position <= end)
    figure = new_figure(FULL, 2.8)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    _draw_model(upper, values, spans)
    outliers = shown & np.isin(values.row, values.outlier_rows)
    for axes, drawn in ((upper, values.measured), (lower, values.difference)):
        numbers = np.array(drawn)
        axes.plot(position[shown], numbers[shown], "o", color=INK, markersize=2.6, label="measured")
        if outliers.any():
            axes.plot(
                position[outliers], numbers[outliers], "o", color=INK, markersize=7, markerfacecolor="none",
                label="outlier",
            )  # fmt: skip
        _mark_spans(axes, spans, section)
    if tolerance is not None:
        lower.axhspan(-tolerance, tolerance, color=LIMIT_FILL, zorder=0, label="tolerance")
    lower.axhline(0.0, color=GREY, linewidth=0.8)
    upper.set_ylabel(f"{values.name.replace('_', ' ')} [{values.unit}]")
    lower.set(xlabel="position [m]", ylabel=f"difference [{values.unit}]", xlim=(start, end))
    add_legend(upper)
    return figure


def _draw_model(axes: "Axes", values: ComparedValues, spans: tuple[SpanDifferences, ...]) -> None:
    """Curve of the model, broken at spans without measured values."""
    x, curve = np.array(values.curve_position_m), np.array(values.curve)
    label: str | None = "model"
    for span in spans:
        inside = (x >= span.start_m) & (x <= span.end_m)
        if span.values:
            axes.plot(x[inside], curve[inside], color=GREY, linewidth=1.1, label=label)
            label = None


def _mark_spans(axes: "Axes", spans: tuple[SpanDifferences, ...], section: tuple[float, float]) -> None:
    """Lines at the supports, numbers of the spans along the lower edge, grey outside the evaluated section."""
    for span in spans:
        axes.axvline(span.start_m, color=GREY, linewidth=0.6, linestyle=":")
        middle = (span.start_m + span.end_m) / 2
        axes.annotate(
            str(span.number), (middle, 0), xycoords=("data", "axes fraction"), xytext=(0, 3),
            textcoords="offset points", ha="center", fontsize=6.5, color=GREY,
        )  # fmt: skip
    start, end = spans[0].start_m, spans[-1].end_m
    if section[0] > start:
        axes.axvspan(start, min(section[0], end), color=PALE, zorder=0)
    if section[1] < end:
        axes.axvspan(max(section[1], start), end, color=PALE, zorder=0)


# Page of a static comparison: figures of ten spans and a table of all spans for each kind of values.
SPANS_OF_A_FIGURE = 10
"""Largest number of spans in a figure: the droppers of each span stay visible on paper."""


def build_static_sections(comparison: StaticComparison) -> tuple[doc.Section, ...]:
    """Section of each kind of values, with figures and a table of the spans."""
    return tuple(_build_section(values, comparison) for values in comparison.values)


def _build_opening(comparison: StaticComparison) -> tuple[doc.Block, ...]:
    first, last = comparison.evaluated_spans
    start, end = map(format_plain, comparison.evaluated_m)
    distance = comparison.largest_distance_m
    facts = {
        "Evaluated section": f"spans {first} to {last}, {start} to {end} m",
        "Largest distance of measured positions": f"{format_plain(distance)} m" if distance else "not stated",
        "Static force of the elasticity": " and ".join(f"{format_plain(force)} N" for force in comparison.force_N),
        "Element length of the model": f"{format_plain(comparison.element_m)} m",
        "Digest of the line": comparison.model.digest,
        "Digest of the record": comparison.record.digest,
        "Digest of the suite": comparison.suite.digest,
        "Note": comparison.note,
    }
    return (doc.select_facts(facts),)


def _build_section(values: ComparedValues, comparison: StaticComparison) -> doc.Section:
    name, unit, spans = values.name.replace("_", " "), values.unit, values.spans
    graded = f"{values.name}_difference_{unit.replace('/', '_')}"
    tolerance = next((item.upper for item in comparison.criteria if item.quantity == graded), None)
    figures = tuple(
        doc.Figure(
            draw_static_values(values, part, tolerance, comparison.evaluated_m),
            f"{name} measured and of the model in spans {part[0].number} to {part[-1].number}.",
            f"Spans {part[0].number} to {part[-1].number}, numbered at the lower edge; dotted: supports.",
        )
        for part in (spans[i : i + SPANS_OF_A_FIGURE] for i in range(0, len(spans), SPANS_OF_A_FIGURE))
        if any(span.values for span in part)
    )
    text = (
        f"Model minus measurement in the evaluated section: mean {format_value(values.mean_difference, 3)} {unit}, "
        f"RMS {format_value(values.rms_difference, 3)} {unit}."
    )
    heading = f"{name[0].upper()}{name[1:]}"
    return doc.Section(heading, (doc.Paragraph(text), doc.Figures(figures), _build_span_table(values)))


def _build_span_table(values: ComparedValues) -> doc.Table:
    def limits(pair: tuple[float, float] | None) -> str:
        return "–" if pair is None else f"{format_value(pair[0])} to {format_value(pair[1])}"

    def signed(value: float | None) -> str:
        return "–" if value is None else format_signed(value)

    cells = {
        "Span": lambda span: str(span.number),
        "From [m]": lambda span: format_plain(span.start_m),
        "To [m]": lambda span: format_plain(span.end_m),
        "Values": lambda span: str(span.values),
        "Measured": lambda span: limits(span.measured),
        "Model": lambda span: limits(span.model),
        "Mean difference": lambda span: signed(span.mean_difference),
        "Largest difference": lambda span: signed(span.largest_difference),
    }
    return doc.make_grid(f"Lowest and highest values span by span [{values.unit}]", values.spans, cells)


STATIC_PAGE: PageKind[StaticComparison] = PageKind(
    heading="Static values of a line: measurement and model",
    statement="self-declared comparison with measured values",
    headlines={
        "pass": "The graded differences between model and measurement lie within the tolerances of the user.",
        "fail": "A difference between model and measurement exceeds a tolerance of the user.",
        "skip": "The record is not complete for every tolerance.",
        "info": "No tolerance was given: the differences are shown and not graded.",
    },
    scope=(
        "Static check of the line model against measured values. The tolerances are those of the user, not of a "
        "standard. Every measured value of the evaluated section counts, also an outlier. Differences are model minus "
        "measurement. The record is unconfirmed: a table of static values has no second channel that could confirm it."
    ),
    describe=lambda comparison: f"Line: {comparison.model.name}. Measured values: {comparison.record.name}.",
    label=lambda comparison: comparison.model.name,
    opening=_build_opening,
    sections=build_static_sections,
)

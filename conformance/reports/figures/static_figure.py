"""Figure of static values along a line: measurement, model and their difference."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pantocheck.conformance.reports.figures.figure_style import (
    FULL,
    GREY,
    INK,
    LIMIT_FILL,
    PALE,
    add_legend,
    render_svg,
)
from pantocheck.conformance.results.comparison_format import ComparedValues, SpanDifferences


@render_svg
def draw_static_values(
    values: ComparedValues, spans: tuple[SpanDifferences, ...], tolerance: float | None, section: tuple[float, float]
) -> Figure:
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
    figure = Figure(figsize=(FULL, 2.8))
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


def _draw_model(axes: Axes, values: ComparedValues, spans: tuple[SpanDifferences, ...]) -> None:
    """Curve of the model, broken at spans without measured values."""
    x, curve = np.array(values.curve_position_m), np.array(values.curve)
    label: str | None = "model"
    for span in spans:
        inside = (x >= span.start_m) & (x <= span.end_m)
        if span.values:
            axes.plot(x[inside], curve[inside], color=GREY, linewidth=1.1, label=label)
            label = None


def _mark_spans(axes: Axes, spans: tuple[SpanDifferences, ...], section: tuple[float, float]) -> None:
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

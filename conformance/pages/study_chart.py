"""Chart of a study: series, printed values and limits."""

from collections.abc import Iterable
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Chart, Mark, Series
from pantocheck.conformance.core.figure_style import (
    BAR_FILLS,
    CROSS,
    FULL,
    HALF,
    INK,
    LIMIT_FILL,
    LIMIT_LINE,
    LINES,
    SHADES,
    add_box,
    add_legend,
    label_decades,
    new_figure,
    render_svg,
)
from pantocheck.conformance.results.campaign_format import ValueMap

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MARKERS = "os^Dv"
HATCHES = ("", "", "////", "....")
BAND_OPACITY = 0.18
TICK_WIDTH = 10
"""Characters on a line of a tick label."""
LABEL_WIDTH = 30
"""Characters on a line of the label of a y axis, along the height of a chart."""


def find_common_range(charts: Iterable[Chart]) -> tuple[float, float]:
    """Ends of a linear y axis for several charts: from 0, or from below a negative value, to above the highest value.

    The margins are a twentieth of the range, as those of a single chart.
    """
    values = [value for chart in charts for series in chart.series for value in series.y]
    low, high = min(values, default=0.0), max(values, default=1.0)
    margin = 0.05 * (high - min(low, 0.0))
    return (0.0 if low >= 0 else low - margin, high + margin)


@render_svg
def draw_chart(data: Chart, y_range: tuple[float, float] | None = None) -> "Figure":
    """A chart of a study: one entry of a case's `charts`; `y_range` is the scale that it shares with others."""
    figure = new_figure(FULL, 2.3) if data.wide else new_figure(HALF, 2.1)
    axes = figure.subplots()
    axes.set(xscale=data.x_scale, yscale=data.y_scale, xlabel=data.x_label, ylabel=_break_label(data.y_label))
    for axis, scale in ((axes.xaxis, data.x_scale), (axes.yaxis, data.y_scale)):
        if scale == "log":
            label_decades(axis)
    bars = [series for series in data.series if series.style == "bars"]
    bands = [series for series in data.series if series.style == "band"]
    others = [series for series in data.series if series.style not in ("bars", "band")]
    for number, series in enumerate(bars):
        _draw_bars(axes, series, number, len(bars))
    for number, series in enumerate(others):
        STYLES[series.style](axes, series, number)
    for number, series in enumerate(bands):  # each belongs to the line of the same number
        shade = SHADES[number % 3]
        axes.fill_between(series.x, series.y, series.high or [], color=shade, alpha=BAND_OPACITY, linewidth=0)
    for mark in data.marks:
        _draw_mark(axes, mark)
    if data.ticks:
        axes.set_xticks(range(len(data.ticks)), [fill(name, TICK_WIDTH) for name in data.ticks])
        axes.set_xlim(-0.6, len(data.ticks) - 0.4)
    if data.y_scale == "linear" and all(min(series.y, default=0) >= 0 for series in data.series):
        axes.set_ylim(bottom=0)
    if y_range is not None:
        axes.set_ylim(*y_range)
    if any(series.style != "boxes" for series in data.series) or data.marks:
        labels = [*(series.label for series in data.series), *(mark.label for mark in data.marks)]
        longest = max(map(len, labels))
        add_legend(axes, columns=max(1, min(4, (100 if data.wide else 45) // (longest + 8))))
    return figure


def _break_label(label: str) -> str:
    """Label of a y axis, on a second line from its comma on if it is longer than the axis."""
    return label if len(label) <= LABEL_WIDTH else label.replace(", ", ",\n", 1)


def _draw_line(axes: "Axes", series: Series, number: int) -> None:
    style, shade = LINES[number % len(LINES)], SHADES[number % 3]
    axes.plot(series.x, series.y, style, color=shade, linewidth=1.1, label=series.label)
    if series.error is not None:
        y, width = np.array(series.y), np.array(series.error)
        axes.fill_between(series.x, y - width, y + width, color=shade, alpha=BAND_OPACITY, linewidth=0)


def _draw_points(axes: "Axes", series: Series, number: int) -> None:
    axes.errorbar(
        series.x,
        series.y,
        yerr=series.error,
        fmt=MARKERS[number % len(MARKERS)],
        color=SHADES[number % 3],
        markerfacecolor="white" if number % 2 else SHADES[number % 3],
        markersize=3.5,
        elinewidth=0.8,
        label=series.label,
    )
    axes.margins(x=0.03)


def _draw_crosses(axes: "Axes", series: Series, number: int) -> None:
    """Coloured crosses over points of other series."""
    axes.plot(series.x, series.y, "x", color=CROSS, markersize=8, label=series.label, zorder=3)


def _draw_boxes(axes: "Axes", series: Series, number: int) -> None:
    x, y = np.array(series.x), np.array(series.y)
    for place in np.unique(x):
        values = y[x == place]
        add_box(axes, values, place)
        axes.plot(np.full(values.size, place + 0.36), values, "o", color=INK, markersize=3, markerfacecolor="white")
    axes.set_xlim(x.min() - 0.6, x.max() + 0.6)
    axes.set_xticks(np.unique(x))


STYLES = {"line": _draw_line, "points": _draw_points, "crosses": _draw_crosses, "boxes": _draw_boxes}
"""Drawing of a series by its style; bars and bands are drawn together."""


def _draw_bars(axes: "Axes", series: Series, number: int, count: int) -> None:
    width = 0.8 / count
    places = np.array(series.x) + width * (number - (count - 1) / 2)
    axes.bar(
        places,
        series.y,
        0.9 * width,
        color=BAR_FILLS[number % len(BAR_FILLS)],
        hatch=HATCHES[number % len(HATCHES)],
        edgecolor=INK,
        linewidth=0.7,
        label=series.label,
    )


def _draw_mark(axes: "Axes", mark: Mark) -> None:
    along = mark.axis == "x"
    if mark.high is not None:
        (axes.axvspan if along else axes.axhspan)(
            mark.low, mark.high, color=LIMIT_FILL, zorder=0, linewidth=0, label=mark.label
        )
    else:
        (axes.axvline if along else axes.axhline)(
            mark.low, color=INK, linewidth=1.0, linestyle=LIMIT_LINE, label=mark.label
        )


# Tornado chart: changes of a value by each input, the largest at the top.
TORNADO_FILLS = (BAR_FILLS[0], SHADES[3])
"""Fills of the bars of both signs of the change of an input."""

TICK_NAME_WIDTH = 34
"""Characters on a line of the name of an input."""


@render_svg
def draw_tornado(data: Chart) -> "Figure":
    """A chart of campaign.json whose series have the style `tornado`; the first tick is at the top."""
    ticks = data.ticks or []
    figure = new_figure(FULL, 0.9 + 0.32 * len(ticks))
    axes = figure.subplots()
    for series, colour in zip(data.series, TORNADO_FILLS, strict=True):
        axes.barh(series.x, series.y, 0.7, color=colour, edgecolor=INK, linewidth=0.5, label=series.label)
    axes.axvline(0.0, color=INK, linewidth=0.8)
    names = [fill(name, TICK_NAME_WIDTH) for name in ticks]
    axes.set_yticks(np.arange(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_xlabel(data.y_label)
    add_legend(axes, columns=2)
    return figure


# Map of a value over two inputs, with the contour of its limit.
MAP_COLOURS = "Greys"
"""Colour map that paper and every eye can tell apart."""


@render_svg
def draw_map(data: ValueMap) -> "Figure":
    """A map of campaign.json: one cell per run, white where there is none; dashed: the limit between the cells."""
    figure = new_figure(FULL, 3.2)
    axes = figure.subplots()
    x, y = np.array(data.x), np.array(data.y)
    values = np.ma.masked_invalid(np.array(data.values, float))
    mesh = axes.pcolormesh(x, y, values, shading="nearest", cmap=MAP_COLOURS, rasterized=False)
    figure.colorbar(mesh, ax=axes, label=data.value_label)
    for bound in (data.lower, data.upper):
        if bound is not None:
            _draw_limit(axes, x, y, values, bound)
    axes.set(xlabel=data.x_label, ylabel=_break_label(data.y_label))
    return figure


def _draw_limit(axes: "Axes", x: RealArray, y: RealArray, values: Any, bound: float) -> None:
    """Contour of a limit, if values lie on both sides of it."""
    if values.min() < bound < values.max():
        lines = axes.contour(x, y, values, levels=[bound], colors=INK, linewidths=1.4, linestyles=[LIMIT_LINE])
        axes.clabel(lines, fmt=f"limit {bound:g}", fontsize=6.5)

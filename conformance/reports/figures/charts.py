"""Charts of studies: series, printed values and limits, as a study left them in the results."""

from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pantocheck.conformance.reports.figures.force_figures import FULL, HALF, INK, LINES, SHADES, draw_box, render_svg

MARKERS = "os^Dv"
FILLS = ("#3a424a", "#aab3bc", "white", "white")
HATCHES = ("", "", "////", "....")
TICK_WIDTH = 10  # characters on a line of a tick's name


@render_svg
def draw_chart(data: dict[str, Any]) -> Figure:
    """A chart of a study.

    Parameters
    ----------
    data : dict[str, Any]
        One entry of a case's `charts`.
    """
    figure = Figure(figsize=(FULL, 2.9) if data["wide"] else (HALF, 2.4))
    axes = figure.subplots()
    axes.set_xscale(data["x_scale"])
    axes.set_yscale(data["y_scale"])
    bars = [one for one in data["series"] if one["style"] == "bars"]
    others = [one for one in data["series"] if one["style"] != "bars"]
    for at, series in enumerate(bars):
        _bars(axes, series, at, len(bars))
    for at, series in enumerate(others):
        {"line": _line, "points": _points, "boxes": _boxes}[series["style"]](axes, series, at)
    for mark in data["marks"]:
        _mark(axes, mark)
    if data["ticks"]:
        axes.set_xticks(range(len(data["ticks"])), [fill(name, TICK_WIDTH) for name in data["ticks"]])
        axes.set_xlim(-0.6, len(data["ticks"]) - 0.4)
    if data["y_scale"] == "linear" and all(min(series["y"], default=0) >= 0 for series in data["series"]):
        axes.set_ylim(bottom=0)
    axes.set_xlabel(data["x_label"])
    axes.set_ylabel(data["y_label"])
    if any(series["style"] != "boxes" for series in data["series"]) or data["marks"]:
        longest = max(len(one["label"]) for one in (*data["series"], *data["marks"]))
        columns = max(1, min(4, 100 // (longest + 8)))
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1.02), ncols=columns, borderaxespad=0.2, columnspacing=1.4)
    return figure


def _line(axes: Axes, series: dict[str, Any], at: int) -> None:
    style, shade = LINES[at % len(LINES)], SHADES[at % 3]
    axes.plot(series["x"], series["y"], style, color=shade, linewidth=1.1, label=series["label"])


def _points(axes: Axes, series: dict[str, Any], at: int) -> None:
    axes.errorbar(
        series["x"],
        series["y"],
        yerr=series["error"],
        fmt=MARKERS[at % len(MARKERS)],
        color=SHADES[at % 3],
        markerfacecolor="white" if at % 2 else SHADES[at % 3],
        markersize=3.5,
        elinewidth=0.8,
        label=series["label"],
    )
    axes.margins(x=0.03)


def _boxes(axes: Axes, series: dict[str, Any], at: int) -> None:
    x, y = np.array(series["x"]), np.array(series["y"])
    for place in np.unique(x):
        values = y[x == place]
        draw_box(axes, values, place)
        axes.plot(np.full(values.size, place + 0.36), values, "o", color=INK, markersize=3, markerfacecolor="white")
    axes.set_xlim(x.min() - 0.6, x.max() + 0.6)
    axes.set_xticks(np.unique(x))


def _bars(axes: Axes, series: dict[str, Any], at: int, count: int) -> None:
    width = 0.8 / count
    places = np.array(series["x"]) + width * (at - (count - 1) / 2)
    axes.bar(
        places,
        series["y"],
        0.9 * width,
        color=FILLS[at % len(FILLS)],
        hatch=HATCHES[at % len(HATCHES)],
        edgecolor=INK,
        linewidth=0.7,
        label=series["label"],
    )


def _mark(axes: Axes, mark: dict[str, Any]) -> None:
    along = mark["axis"] == "x"
    if mark["high"] is not None:
        (axes.axvspan if along else axes.axhspan)(
            mark["low"], mark["high"], color="#e1e6ea", zorder=0, linewidth=0, label=mark["label"]
        )
    else:
        (axes.axvline if along else axes.axhline)(
            mark["low"], color=INK, linewidth=1.0, linestyle=(0, (6, 2)), label=mark["label"]
        )

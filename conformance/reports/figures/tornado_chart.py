"""Tornado chart: changes of a value by each input, the largest at the top."""

from textwrap import fill

import numpy as np
from matplotlib.figure import Figure

from pantocheck.conformance.reports.figures.figure_style import FULL, INK, add_legend, render_svg
from pantocheck.conformance.results.figure_data import Chart

TORNADO_FILLS = ("#3a424a", "#c3cad2")
"""Fills of the bars of both signs of the change of an input."""

TICK_NAME_WIDTH = 34
"""Characters on a line of the name of an input."""


@render_svg
def draw_tornado(data: Chart) -> Figure:
    """A chart of campaign.json whose series have the style `tornado`; the first tick is at the top."""
    ticks = data.ticks or []
    figure = Figure(figsize=(FULL, 0.9 + 0.32 * len(ticks)))
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

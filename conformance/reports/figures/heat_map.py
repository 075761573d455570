"""Map of a value over two inputs, with the contour of its limit."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.reports.figures.figure_style import FULL, INK, LIMIT_LINE, render_svg
from pantocheck.conformance.results.campaign_format import ValueMap

MAP_COLOURS = "Greys"
"""Colour map that paper and every eye can tell apart."""


@render_svg
def draw_map(data: ValueMap) -> Figure:
    """A map of campaign.json: one cell per run, white where there is none; dashed: the limit between the cells."""
    figure = Figure(figsize=(FULL, 3.2))
    axes = figure.subplots()
    x, y = np.array(data.x), np.array(data.y)
    values = np.ma.masked_invalid(np.array(data.values, float))
    mesh = axes.pcolormesh(x, y, values, shading="nearest", cmap=MAP_COLOURS, rasterized=False)
    figure.colorbar(mesh, ax=axes, label=data.value_label)
    for bound in (data.lower, data.upper):
        if bound is not None:
            _draw_limit(axes, x, y, values, bound)
    axes.set(xlabel=data.x_label, ylabel=data.y_label)
    return figure


def _draw_limit(axes: Axes, x: RealArray, y: RealArray, values: Any, bound: float) -> None:
    """Contour of a limit, if values lie on both sides of it."""
    if values.min() < bound < values.max():
        lines = axes.contour(x, y, values, levels=[bound], colors=INK, linewidths=1.4, linestyles=[LIMIT_LINE])
        axes.clabel(lines, fmt=f"limit {bound:g}", fontsize=6.5)

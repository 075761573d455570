"""Errors against a refined step, beside the slope of the theoretical order."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, NullLocator

from pantocheck.conformance.core.figure_style import HALF, INK, SHADES, add_legend, label_decades, render_svg


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

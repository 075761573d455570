"""Uplift of the contact wire at the supports."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pantocheck.conformance.reports.figures.figure_style import (
    FULL,
    INK,
    LIMIT_FILL,
    LIMIT_LINE,
    LINES,
    SHADES,
    add_legend,
    render_svg,
)
from pantocheck.conformance.results.criterion_format import Criterion
from pantocheck.conformance.results.figure_data import UpliftTrace

MOST_NAMED = 8
"""Largest number of supports with a line style each; of more, only the largest uplift stands out."""


@render_svg
def draw_uplift(supports: Sequence[UpliftTrace], criteria: Sequence[Criterion]) -> Figure:
    """Uplift over time at the supports of a case, with the limits of the maximum where its criteria grade it."""
    figure = Figure(figsize=(FULL, 2.1))
    axes = figure.subplots()
    if len(supports) <= MOST_NAMED:
        for number, support in enumerate(supports):
            # Two shades times four dashes: neighbours differ in the shade, and no two of eight curves are equal.
            shade, style = SHADES[number % 2], LINES[number // 2 % len(LINES)]
            name = f"support at {support.support_m:g} m"
            axes.plot(support.time_s, support.uplift_mm, style, color=shade, linewidth=1.1, label=name)
    else:
        _draw_largest(axes, supports)
    limits = {(row.lower, row.upper) for row in criteria if row.quantity == "max_uplift_at_support_mm"}
    for lower, upper in sorted(limits, key=str):
        levels = [level for level in (lower, upper) if level is not None]
        if lower is not None and upper is not None:
            axes.axhspan(lower, upper, color=LIMIT_FILL, zorder=0, label="limits of the maximum")
        elif levels:
            axes.axhline(levels[0], color=INK, linewidth=1.2, linestyle=LIMIT_LINE, label="limit of the maximum")
    axes.set(xlabel="time [s]", ylabel="uplift [mm]")
    add_legend(axes, columns=4)
    return figure


def _draw_largest(axes: Axes, supports: Sequence[UpliftTrace]) -> None:
    """All supports in grey with the largest uplift drawn over them: a name for each would fill the figure."""
    largest = max(supports, key=lambda support: max(support.uplift_mm))
    others = [support for support in supports if support is not largest]
    for support in others:
        name = "other supports" if support is others[0] else None
        axes.plot(support.time_s, support.uplift_mm, color=SHADES[2], linewidth=0.8, label=name)
    name = f"largest: support at {largest.support_m:g} m"
    axes.plot(largest.time_s, largest.uplift_mm, color=INK, linewidth=1.3, label=name)

"""Spectral lines in the half-power band of each mode over frequency."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.reports.figures.figure_style import FULL, INK, LIMIT_LINE, SHADES, render_svg
from pantocheck.conformance.reports.figures.fixed_panels import add_panel


@render_svg
def draw_half_power(modes: Sequence[Mode], recommended: int) -> Figure:
    """Number of spectral lines over frequency; open markers: uncertain or lateral modes; dashed: recommended number."""
    figure, axes = add_panel(FULL, 1.7)
    for reliable, face in ((True, SHADES[1]), (False, "white")):
        shown = [mode for mode in modes if (mode.certain and not mode.lateral) == reliable]
        points = [(mode.frequency_Hz, mode.half_power_points) for mode in shown if mode.half_power_points]
        if points:
            label = "certain mode" if reliable else "uncertain or lateral mode"
            axes.plot(*zip(*points, strict=True), "o", color=INK, markerfacecolor=face, markersize=3.5, label=label)
    axes.axhline(recommended, color=INK, linestyle=LIMIT_LINE, linewidth=0.9)
    axes.set(xlabel="frequency [Hz]", ylabel="lines in the half-power band")
    axes.set_ylim(bottom=0)
    axes.margins(x=0.03)
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=2, borderaxespad=0.2)
    return figure

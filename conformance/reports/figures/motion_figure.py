"""Velocity and acceleration at one sensor after the release and a minute later."""

from collections.abc import Callable, Sequence

from matplotlib.figure import Figure

from pantocheck.conformance.identification.identification_format import Curve, CurveWindow, OverlayRun
from pantocheck.conformance.reports.figures.figure_style import FULL, LINES, SHADES, render_svg
from pantocheck.conformance.reports.figures.fixed_panels import PanelGrid, add_panels

MOTIONS: dict[str, Callable[[CurveWindow], Curve]] = {
    "velocity [m/s]": lambda window: window.velocity_m_s,
    "acceleration [m/s²]": lambda window: window.acceleration_m_s2,
}
"""Curve of each row by its label."""


@render_svg
def draw_motion(runs: Sequence[OverlayRun]) -> Figure:
    """Records of one drop laid over each other, one column per window; `runs` of an entry of `overlays`."""
    windows = max(len(run.windows) for run in runs)
    grid = PanelGrid(FULL, 1.5, rows=len(MOTIONS), columns=windows, between_rows=0.15, between_columns=0.5)
    figure, panels = add_panels(grid)
    for row, (label, select) in zip(panels, MOTIONS.items(), strict=True):
        for window, axes in enumerate(row):
            for number, run in enumerate(runs):
                if window < len(run.windows):
                    data = run.windows[window]
                    shade, style = SHADES[number % len(SHADES)], LINES[number % len(LINES)]
                    axes.plot(data.time_s, select(data), style, color=shade, linewidth=1.0, label=run.name)
            axes.tick_params(labelbottom=row is panels[-1])
        row[0].set_ylabel(label)
    for axes in panels[-1]:
        axes.set_xlabel("time after the release [s]")
    panels[0][0].legend(loc="lower left", bbox_to_anchor=(0, 1.02), ncols=5, borderaxespad=0.2)
    return figure

"""Magnitude of the frequency responses in the range of the first two groups of span modes."""

import numpy as np
from matplotlib.figure import Figure

from pantocheck.conformance.identification.identification_format import RecordResponses
from pantocheck.conformance.reports.figures.figure_style import FULL, INK, SHADES, render_svg, use_decades
from pantocheck.conformance.reports.figures.fixed_panels import PanelGrid, add_panels


@render_svg
def draw_response_zoom(data: RecordResponses, modes_Hz: list[float], zoom: tuple[float, float]) -> Figure:
    """Magnitude of the accelerance of every sensor in a range of frequencies [Hz], with ticks at the modes."""
    n, low, high = len(data.channels), *zoom
    columns = min(n, 2)
    grid = PanelGrid(
        FULL, 1.35, rows=-(-n // columns), columns=columns, left=0.65, top=0.35, between_rows=0.22, between_columns=0.75
    )
    figure, panels = add_panels(grid)
    frequency = np.array(data.frequency_Hz)
    shown = (frequency >= low) & (frequency <= high)
    ticks = [mode for mode in modes_Hz if low <= mode <= high]
    flat = [axes for row in panels for axes in row]
    for axes, channel, measured, identified in zip(flat, data.channels, data.measured, data.identified, strict=False):
        axes.plot(
            frequency[shown], np.array(measured.magnitude)[shown], color=SHADES[3], linewidth=2.4, label="measured"
        )
        axes.plot(frequency[shown], np.array(identified.magnitude)[shown], color=INK, linewidth=0.8, label="identified")
        use_decades(axes)
        axes.plot(
            ticks, np.ones(len(ticks)), "|", color=INK, markersize=6, transform=axes.get_xaxis_transform(),
            clip_on=False,
        )  # fmt: skip
        axes.set_xlim(low, high)
        axes.set_ylabel(f"{channel} [m/s²/N]")
    for axes in flat[: -len(panels[-1])]:
        axes.tick_params(labelbottom=False)
    for axes in panels[-1]:
        axes.set_xlabel("frequency [Hz]; ticks: identified modes")
    for axes in flat[n:]:
        axes.set_axis_off()
    flat[0].legend(loc="lower left", bbox_to_anchor=(0, 1.04), ncols=2, borderaxespad=0.2)
    return figure

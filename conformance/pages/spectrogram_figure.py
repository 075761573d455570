"""Spectrogram of a drop: whole record and first seconds, with the release and the limits of the linear decay."""

from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from pantocheck.conformance.core.figure_style import FULL, INK, render_svg
from pantocheck.conformance.pages.fixed_panels import PanelGrid, add_panels
from pantocheck.conformance.results.identification_format import Spectrogram, SpectrogramPart

SHOWN_LEVELS = -60, 0
"""Levels of white and of black [dB]."""

MARK_STYLES: tuple[Literal["-", "--", ":"], ...] = ("-", "--", ":")
"""Line styles of the marks, in their order."""

SCALE_WIDTH, SCALE_GAP = 0.12, 0.12
"""Width of the scale of the levels, and its distance from the panels [in]."""


@render_svg
def draw_spectrogram(data: Spectrogram, marks: dict[str, float], limits: tuple[float, float]) -> Figure:
    """Levels over time and frequency.

    Args:
        data: Entry `spectrogram` of a line.
        marks: Times after the release that are marked, by their names [s].
        limits: Start and end of the record after the release [s].
    """
    grid = PanelGrid(FULL, 1.6, columns=2, right=0.85, between_columns=0.5)
    figure, panels = add_panels(grid)
    whole, start = panels[0]
    _draw_levels(whole, data.whole)
    _draw_levels(start, data.start)
    whole.set_xlim(*limits)
    for axes in (whole, start):
        _draw_marks(axes, marks)
        axes.set_xlabel("time after the release [s]")
    whole.set_ylabel("frequency [Hz]")
    _add_scale(figure, grid)
    handles = [
        Line2D([], [], linestyle=style, color=INK, linewidth=1.0, label=name)
        for name, style in zip(marks, MARK_STYLES, strict=False)
    ]
    whole.legend(handles=handles, loc="lower left", bbox_to_anchor=(0, 1.0), ncols=3, borderaxespad=0.2)
    return figure


def _draw_levels(axes: Axes, part: SpectrogramPart) -> None:
    """Levels as an image of one pixel per value, whose centres lie at the times and frequencies."""
    axes.imshow(
        np.array(part.level_dB, dtype=np.float64).T,
        cmap="Greys",
        vmin=SHOWN_LEVELS[0],
        vmax=SHOWN_LEVELS[1],
        aspect="auto",
        origin="lower",
        interpolation="none",
        extent=(*_find_edges(part.time_s), *_find_edges(part.frequency_Hz)),
    )
    axes.set_ylim(0, part.frequency_Hz[-1])
    axes.grid(visible=False)


def _find_edges(centres: list[float]) -> tuple[float, float]:
    """Ends of equal pixels with given centres."""
    half = (centres[-1] - centres[0]) / max(len(centres) - 1, 1) / 2
    return centres[0] - half, centres[-1] + half


def _draw_marks(axes: Axes, marks: dict[str, float]) -> None:
    """Vertical lines on a white ground, so that they can be seen in dark places."""
    low, high = axes.get_xlim()
    for time, style in zip(marks.values(), MARK_STYLES, strict=False):
        if low <= time <= high:
            axes.axvline(time, color="white", linewidth=2.4)
            axes.axvline(time, color=INK, linestyle=style, linewidth=1.0)


def _add_scale(figure: Figure, grid: PanelGrid) -> None:
    left = grid.width - grid.right + SCALE_GAP
    axes = figure.add_axes(
        (
            left / grid.width,
            grid.bottom / grid.total_height,
            SCALE_WIDTH / grid.width,
            grid.height / grid.total_height,
        )
    )
    axes.imshow(
        np.linspace(*SHOWN_LEVELS, 61)[:, None],
        cmap="Greys",
        aspect="auto",
        origin="lower",
        interpolation="none",
        extent=(0.0, 1.0, *SHOWN_LEVELS),
    )
    axes.set_xticks([])
    axes.yaxis.tick_right()
    axes.yaxis.set_label_position("right")
    axes.set_ylabel("level [dB]")
    axes.set_yticks([-60, -40, -20, 0])
    axes.grid(visible=False)

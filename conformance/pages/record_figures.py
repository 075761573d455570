"""Figures of the records of mass drops: places of sensors and masses, motion, spectrogram."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_style import FULL, GREY, INK, LINES, SHADES, render_svg
from pantocheck.conformance.pages.fixed_panels import PanelGrid, add_panels
from pantocheck.conformance.results.identification_format import (
    Curve,
    CurveWindow,
    OverlayRun,
    Spectrogram,
    SpectrogramPart,
)

# Schematic of a mass drop: supports, wires, sensors and masses along the line, without a scale of the heights.
DRAWN_SAG = 0.4
"""Sag of the messenger wire in the drawing; the contact wire has height 0, the messenger wire at a support height 1."""

DRAWN_DROPPERS = 5
"""Droppers drawn in a span; their real number is not known."""

NAME_OFFSET = 0.16
"""Distance of a text from its point in the drawing."""


@dataclass(frozen=True)
class DrawnPlace:
    """Sensor or mass on a wire: its text, wire, and position [m]."""

    label: str
    wire: str
    position_m: float


@render_svg
def draw_drop_layout(spans: Sequence[float], sensors: Sequence[DrawnPlace], masses: Sequence[DrawnPlace]) -> Figure:
    """Wires over spans [m]; sensors stand above and masses below their wires."""
    figure, panels = add_panels(PanelGrid(FULL, 1.1, left=0.15, right=0.15, top=0.02))
    axes = panels[0][0]
    supports = np.concatenate([[0.0], np.cumsum(spans)])
    for start, end in pairwise(supports):
        x = np.linspace(start, end, 21)
        places = start + (np.arange(DRAWN_DROPPERS) + 0.5) / DRAWN_DROPPERS * (end - start)
        axes.plot(x, _messenger_height(x, supports), color=INK, linewidth=0.8)
        axes.vlines(places, 0.0, _messenger_height(places, supports), color=GREY, linewidth=0.5)
    axes.plot(supports[[0, -1]], [0.0, 0.0], color=INK, linewidth=1.4)
    axes.vlines(supports, -0.15, 1.15, color=GREY, linewidth=1.8)
    _draw_points(axes, supports, sensors, "s", NAME_OFFSET)
    _draw_points(axes, supports, masses, "v", -NAME_OFFSET - 0.1)
    axes.set(xlim=(supports[0] - 2, supports[-1] + 2), ylim=(-0.7, 1.4), xlabel="position along the line [m]")
    axes.set_xticks(supports, [f"{x:g}" for x in supports])
    axes.set_yticks([])
    axes.spines.left.set_visible(False)
    return figure


def _draw_points(axes: Axes, supports: RealArray, points: Sequence[DrawnPlace], marker: str, offset: float) -> None:
    for point in points:
        x = np.array([point.position_m])
        height = float(_messenger_height(x, supports)[0]) if point.wire == "MW" else 0.0
        # A mass hangs below its wire.
        axes.plot(x, [height - 0.1 * (marker == "v")], marker, color=INK, markersize=6 if marker == "v" else 4)
        side = "bottom" if offset > 0 else "top"
        ground = {"facecolor": "white", "edgecolor": "none", "pad": 0.4}
        axes.text(x[0], height + offset, point.label, ha="center", va=side, size=7, bbox=ground)


def _messenger_height(x: RealArray, supports: RealArray) -> RealArray:
    """Height of the messenger wire in the drawing: a parabola in each span."""
    span = np.clip(np.searchsorted(supports, x, side="right") - 1, 0, supports.size - 2)
    s = (x - supports[span]) / (supports[span + 1] - supports[span])
    return np.asarray(1.0 - 4 * DRAWN_SAG * s * (1 - s))


# Velocity and acceleration at one sensor after the release and a minute later.
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


# Spectrogram of a drop: whole record and first seconds, with the release and the limits of the linear decay.
SHOWN_LEVELS = -60, 0
"""Levels of white and of black [dB]."""

MARK_STYLES: tuple[Literal["-", "--", ":"], ...] = ("-", "--", ":")
"""Line styles of the marks, in their order."""

SCALE_WIDTH, SCALE_GAP = 0.12, 0.12
"""Width of the scale of the levels, and its distance from the panels [in]."""


@render_svg
def draw_spectrogram(data: Spectrogram, marks: dict[str, float], limits: tuple[float, float]) -> Figure:
    """Levels over time and frequency, with named times and limits of the record after the release [s]."""
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

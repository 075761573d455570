"""Figures of a drop comparison: motion of record and models laid over each other, and residual energy against time."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pantocheck.conformance.reports.figures.figure_style import (
    FULL,
    GREY,
    INK,
    LINES,
    SHADES,
    add_legend,
    render_svg,
    use_decades,
)
from pantocheck.conformance.results.drop_comparison_format import EnergyCurve, MotionCurve

RECORD_WIDTH = 2.2
"""Width of the pale line of the record [pt]; the lines of the models lie on it."""


@render_svg
def draw_drop_motion(curves: Sequence[MotionCurve]) -> Figure:
    """Velocity and acceleration of one place in every window."""
    figure = Figure(figsize=(FULL, 0.6 + 1.7 * len(curves)))
    panels = np.atleast_1d(figure.subplots(len(curves), 1))
    for axes, curve in zip(panels, curves, strict=True):
        if curve.record is not None:
            axes.plot(curve.time_s, curve.record, color=SHADES[3], linewidth=RECORD_WIDTH, label="record")
        _plot_models(axes, curve.time_s, curve.models)
        unit = "m/s" if curve.motion == "velocity" else "m/s²"
        axes.set_ylabel(f"{curve.motion} [{unit}]")
        axes.margins(x=0)
    panels[-1].set_xlabel("time after the release [s]")
    add_legend(panels[0])
    return figure


@render_svg
def draw_residual_energy(energy: EnergyCurve, graded: str) -> Figure:
    """Mean square of the velocity against time, and of the difference of the graded model."""
    figure = Figure(figsize=(FULL, 2.4))
    axes = figure.subplots()
    if energy.record is not None:
        axes.plot(energy.time_s, energy.record, color=SHADES[3], linewidth=RECORD_WIDTH, label="record")
    _plot_models(axes, energy.time_s, energy.models)
    if graded in energy.differences:
        label = f"{graded} − record"
        axes.plot(energy.time_s, energy.differences[graded], ":", color=GREY, linewidth=1.0, label=label)
    use_decades(axes)
    axes.margins(x=0)
    axes.set(xlabel="time after the release [s]", ylabel="mean square [m²/s²]")
    add_legend(axes)
    return figure


def _plot_models(axes: Axes, time: Sequence[float], models: Mapping[str, Sequence[float]]) -> None:
    for number, (name, values) in enumerate(models.items()):
        style, shade = LINES[number % len(LINES)], (INK, *SHADES[1:3])[number % 3]
        axes.plot(time, values, style, color=shade, linewidth=0.8, label=name)

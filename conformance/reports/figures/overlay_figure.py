"""Figures of a simulated run and a measured one: forces over the track with their difference, spectra, spans."""

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pantocheck.conformance.reports.figures.figure_style import FULL, GREY, HALF, INK, PlotStyle, add_legend, render_svg
from pantocheck.conformance.results.figure_data import Spectrum
from pantocheck.conformance.results.measured_run_format import (
    ForceStatistics,
    MeasuredPantograph,
    SpanStatistics,
)

SIMULATED: PlotStyle = {"color": INK, "linewidth": 1.2, "label": "simulated"}
MEASURED: PlotStyle = {"color": GREY, "linewidth": 1.2, "linestyle": "--", "label": "measured"}
"""Styles of the two runs; they differ without colour."""

SPAN_STATISTICS: dict[str, Callable[[ForceStatistics], float]] = {
    "mean [N]": lambda run: run.mean_N,
    "standard\ndeviation [N]": lambda run: run.std_N,
}
"""Statistics that the figure of the spans shows, by their labels."""


@render_svg
def draw_overlay(pantograph: MeasuredPantograph) -> Figure:
    """Filtered forces of one pantograph in both runs; below, simulated minus measured force."""
    figure = Figure(figsize=(FULL, 3.0))
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    position = pantograph.position_m
    upper.plot(position, pantograph.simulated_N, **SIMULATED)
    upper.plot(position, pantograph.measured_N, **MEASURED)
    lower.plot(position, force_difference(pantograph), color=INK, linewidth=0.9)
    lower.axhline(0.0, color=GREY, linewidth=0.8)
    for axes in (upper, lower):
        for support in list_span_limits(pantograph):
            axes.axvline(support, color=GREY, linewidth=0.6, linestyle=":")
    upper.set_ylabel("contact force [N]")
    lower.set(xlabel="position along the track [m]", ylabel="difference [N]", xlim=(position[0], position[-1]))
    add_legend(upper)
    return figure


@render_svg
def draw_run_spectra(pantograph: MeasuredPantograph) -> Figure:
    """Amplitude spectra of the unfiltered forces in both runs; below, simulated minus measured amplitude."""
    figure = Figure(figsize=(HALF, 3.0))
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    simulated, measured = pantograph.simulated_spectrum, pantograph.measured_spectrum
    upper.plot(simulated.frequency_Hz, simulated.amplitude_N, **SIMULATED | {"linewidth": 0.9})
    upper.plot(measured.frequency_Hz, measured.amplitude_N, **MEASURED | {"linewidth": 0.9})
    frequency, difference = spectrum_difference(simulated, measured)
    lower.plot(frequency, difference, color=INK, linewidth=0.9)
    lower.axhline(0.0, color=GREY, linewidth=0.8)
    upper.set_ylim(bottom=0)
    upper.set_ylabel("amplitude [N]")
    lower.set(xlim=(0, 50), xticks=[0, 5, 10, 20, 30, 40, 50], xlabel="frequency [Hz]", ylabel="difference [N]")
    add_legend(upper)
    return figure


@render_svg
def draw_spans(pantograph: MeasuredPantograph) -> Figure:
    """Mean and standard deviation of the filtered force span by span in both runs."""
    figure = Figure(figsize=(HALF, 3.0))
    panels = figure.subplots(2, 1, sharex=True)
    for axes, (label, select) in zip(panels, SPAN_STATISTICS.items(), strict=True):
        _draw_span_values(axes, pantograph.spans, select)
        axes.set_ylabel(label)
    panels[-1].set(xlabel="position along the track [m]")
    add_legend(panels[0])
    return figure


def force_difference(pantograph: MeasuredPantograph) -> list[float]:
    """Simulated minus measured force at the drawn positions [N]."""
    return [a - b for a, b in zip(pantograph.simulated_N, pantograph.measured_N, strict=True)]


def spectrum_difference(simulated: Spectrum, measured: Spectrum) -> tuple[list[float], list[float]]:
    """Frequencies of the simulated spectrum that both have [Hz], and simulated minus measured amplitude there [N]."""
    frequency, known = np.array(simulated.frequency_Hz), np.array(measured.frequency_Hz)
    if not known.size:
        return [], []
    both = (frequency >= known[0]) & (frequency <= known[-1])
    beside = np.interp(frequency[both], known, measured.amplitude_N)
    return frequency[both].tolist(), (np.array(simulated.amplitude_N)[both] - beside).tolist()


def list_span_limits(pantograph: MeasuredPantograph) -> list[float]:
    """Positions of the supports between the compared spans [m]."""
    return sorted({place for span in pantograph.spans for place in (span.start_m, span.end_m)})


def _draw_span_values(axes: Axes, spans: Sequence[SpanStatistics], select: Callable[[ForceStatistics], float]) -> None:
    edges = [spans[0].start_m, *(span.end_m for span in spans)]
    for runs, style in (([span.simulated for span in spans], SIMULATED), ([span.measured for span in spans], MEASURED)):
        values = [select(run) for run in runs]
        axes.step(edges, [*values, values[-1]], where="post", **style)
    axes.set_xlim(edges[0], edges[-1])

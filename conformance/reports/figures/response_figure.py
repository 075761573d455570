"""Figure of a frequency response at a pantograph head: measurement, model, and their deviation by band."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MultipleLocator, NullFormatter, StrMethodFormatter

from pantocheck.conformance.reports.figures.figure_style import (
    FULL,
    GREY,
    INK,
    LIMIT_LINE,
    SHADES,
    add_legend,
    label_decades,
    render_svg,
)
from pantocheck.conformance.results.comparison_format import ComparedResponse, ComparisonCriterion

Limits = Sequence[ComparisonCriterion]

DRAWN_ROWS = 400
"""Largest number of drawn rows, two per millimetre of a figure; the numbers contain all rows."""

FREQUENCY_TICKS = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200)


@render_svg
def draw_response(response: ComparedResponse, limits: Limits) -> Figure:
    """Modulus and phase of measurement and model over the frequency; below, the deviation of the modulus and by band.

    Args:
        response: The response.
        limits: Its criteria of the complex deviation.
    """
    figure = Figure(figsize=(FULL, 4.6))
    modulus, phase, deviation = figure.subplots(3, 1, sharex=True, height_ratios=(3, 2, 2))
    measured, model = response.measured, response.model
    rows = select_drawn_rows(measured.frequency_Hz)
    for axes, key in ((modulus, "modulus"), (phase, "phase_deg")):
        axes.plot(model.frequency_Hz, getattr(model, key), color=SHADES[1], linewidth=1.1, label="model")
        axes.errorbar(
            np.array(measured.frequency_Hz)[rows], np.array(getattr(measured, key))[rows],
            _error_bar(response, key, rows),
            fmt="o", color=INK, markersize=2.2, elinewidth=0.6, label="measured",
        )  # fmt: skip
    _draw_deviations(deviation, response, limits, rows)
    _label_moduli(modulus)
    modulus.set_ylabel(f"{response.kind.replace('_', ' ')} [{response.unit}]")
    phase.set_ylabel("phase [°]")
    phase.yaxis.set_major_locator(MultipleLocator(90))
    _label_frequencies(deviation, model.frequency_Hz)
    add_legend(modulus)
    return figure


def select_drawn_rows(frequency: Sequence[float]) -> list[int]:
    """Rows of a figure: the first one in each of `DRAWN_ROWS` equal parts of the logarithmic frequency axis."""
    log = np.log(frequency)
    parts = np.floor((log - log[0]) / max(log[-1] - log[0], 1e-12) * DRAWN_ROWS)
    return list(map(int, np.unique(parts, return_index=True)[1]))


def _error_bar(response: ComparedResponse, key: str, rows: list[int]) -> Any:
    """Half-widths of the error bars; None where the record states no uncertainty."""
    if not response.modulus_uncertainty_pct:
        return None
    if key == "phase_deg":
        return np.array(response.phase_uncertainty_deg)[rows]
    return (np.array(response.measured.modulus) * np.array(response.modulus_uncertainty_pct) / 100)[rows]


def _draw_deviations(axes: Axes, response: ComparedResponse, limits: Limits, rows: list[int]) -> None:
    """Deviation of the modulus at the rows, complex deviation of each band as a step, limits as dashed lines."""
    points = (np.array(series)[rows] for series in (response.measured.frequency_Hz, response.modulus_deviation_pct))
    axes.axhline(0.0, color=GREY, linewidth=0.6)
    axes.plot(*points, "o", color=GREY, markersize=1.8, label="modulus, each row")
    label = "complex, RMS of band"
    for band in response.bands:
        if band.deviations:
            value = band.deviations["complex_deviation_pct"]
            axes.plot(band.band_Hz, [value, value], color=INK, linewidth=1.6, label=label)
            label = ""
    label = "limit of complex"
    bounds = [(item.where.band_Hz, item.upper) for item in limits]
    for band_Hz, upper in ((band, upper) for band, upper in bounds if band is not None and upper is not None):
        axes.plot(band_Hz, [upper, upper], color=INK, linewidth=0.9, linestyle=LIMIT_LINE, label=label)
        label = ""
    axes.set(ylabel="deviation [%]", xlabel="frequency [Hz]")
    add_legend(axes)


def _label_moduli(axes: Axes) -> None:
    """A logarithmic modulus axis: plain numbers over two decades or less, otherwise powers of ten."""
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    if high / low > 100:
        label_decades(axes.yaxis)
        return
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())


def _label_frequencies(axes: Axes, frequency: Sequence[float]) -> None:
    """A logarithmic frequency axis with plain numbers."""
    axes.set_xscale("log")
    axes.set_xlim(frequency[0], frequency[-1])
    axes.set_xticks([tick for tick in FREQUENCY_TICKS if frequency[0] <= tick <= frequency[-1]])
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())

"""Figures of a damping fit: observability of the coefficients, measured and fitted damping ratios."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from pantocheck.conformance.core.figure_style import (
    FULL,
    GREY,
    INK,
    SHADES,
    add_box,
    add_legend,
    label_decades,
    render_svg,
)
from pantocheck.conformance.results.damping_format import FittedModels, Observability, Thresholds
from pantocheck.conformance.results.population_format import PooledGroup, PooledRecord


@render_svg
def draw_observability(rows: Sequence[Observability], thresholds: Thresholds) -> Figure:
    """Largest share of each coefficient in the damping of a mode, and its plausible value over its uncertainty."""
    names = [f"{row.kind.replace('_', ' ')}, {row.matrix}" for row in rows]
    places = np.arange(len(rows))
    figure = Figure(figsize=(FULL, 0.9 + 0.24 * len(rows)))
    left, right = figure.subplots(1, 2, sharey=True)
    fills = [SHADES[1] if row.observable else "white" for row in rows]
    left.barh(places, [100 * row.largest_share for row in rows], color=fills, edgecolor=INK, linewidth=0.7)
    left.axvline(100 * thresholds.largest_share, color=INK, linestyle="--", linewidth=0.9)
    left.set_xlabel("largest share of a mode's damping [%]")
    left.set_yticks(places, names)
    left.invert_yaxis()
    right.barh(places, [row.plausible_over_std for row in rows], color=fills, edgecolor=INK, linewidth=0.7)
    right.axvline(thresholds.plausible_over_std, color=INK, linestyle="--", linewidth=0.9)
    right.set_xscale("symlog", linthresh=0.1)
    label_decades(right.xaxis)
    right.set_xlim(left=0)
    right.set_xlabel("plausible value / standard deviation [-]")
    return figure


@render_svg
def draw_comparison(data: FittedModels) -> Figure:
    """Measured damping ratios and those of the models at the computed modes."""
    figure = Figure(figsize=(FULL, 3.2))
    axes = figure.subplots()
    measured = data.measured
    axes.errorbar(
        measured.frequency_Hz,
        [100 * value for value in measured.damping_ratio],
        yerr=[196 * value for value in measured.std],
        fmt="o",
        color=INK,
        markersize=3.5,
        elinewidth=0.8,
        label="measured",
    )
    for (name, ratios), style, shade in zip(data.models.items(), ("--", "-", ":"), (GREY, INK, INK), strict=False):
        axes.plot(data.frequency_Hz, [100 * value for value in ratios], style, color=shade, linewidth=1.1, label=name)
    top = 1.5 * max(100 * value for value in measured.damping_ratio)
    axes.set(ylim=(0, top), xlabel="frequency [Hz]", ylabel="damping ratio [%]")
    add_legend(axes)
    return figure


# Figures of a population of tests: damping ratios of all tests over frequency, and box plots over tests.
TEST_MARKERS = "os^vDP*X<>"
"""Markers of the tests; from the eleventh test on they repeat in another shade."""


@render_svg
def draw_test_ratios(records: Sequence[PooledRecord]) -> Figure:
    """Damping ratio of every certain mode of every test over frequency; one marker per test, with its number."""
    figure = Figure(figsize=(FULL, 3.2))
    axes = figure.subplots()
    for t, record in enumerate(records):
        shade = SHADES[t // len(TEST_MARKERS) % len(SHADES)]
        axes.plot(
            [value.frequency_Hz for value in record.values],
            [100 * value.damping_ratio for value in record.values],
            TEST_MARKERS[t % len(TEST_MARKERS)],
            color=shade,
            markerfacecolor="white",
            label=str(t + 1),
        )
    axes.set_ylim(bottom=0)
    axes.margins(x=0.02)
    axes.set(xlabel="frequency [Hz]", ylabel="damping ratio [%]")
    add_legend(axes, columns=8)
    return figure


@render_svg
def draw_test_boxes(groups: Sequence[PooledGroup], records: Sequence[PooledRecord]) -> Figure:
    """Damping ratios of all tests per group: quartiles and median; outliers as dots; joint median as a grey line."""
    figure = Figure(figsize=(FULL, 3.2))
    axes = figure.subplots()
    for group in groups:
        number = group.group
        values = [value for record in records for value in record.values if value.group == number]
        add_box(axes, np.array([100 * value.damping_ratio for value in values]), number)
        outliers = [100 * value.damping_ratio for value in values if value.outlier]
        axes.plot([number] * len(outliers), outliers, "o", color=INK, markersize=3)
        if group.joint_median is not None:
            axes.plot([number - 0.4, number + 0.4], [100 * group.joint_median] * 2, "--", color=GREY, linewidth=1.0)
    numbers = [group.group for group in groups]
    axes.set_xlim(0.4, max(numbers, default=1) + 0.6)
    axes.set_xticks(numbers, [str(number) for number in numbers])
    axes.set_ylim(bottom=0)
    label = "group of span modes (dots: outliers; dashed: median of the joint identification)"
    axes.set(xlabel=label, ylabel="damping ratio [%]")
    return figure

"""Figures of a population of tests: damping ratios of all tests over frequency, and box plots over tests."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from pantocheck.conformance.identification.population_format import PooledGroup, PooledRecord
from pantocheck.conformance.reports.figures.figure_style import FULL, GREY, INK, SHADES, add_box, add_legend, render_svg

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

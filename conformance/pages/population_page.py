"""Report on a population of tests, from population.json, with its figures."""

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.figure import Figure

from pantocheck.conformance.core.figure_style import FULL, GREY, INK, SHADES, add_box, add_legend, render_svg
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.words import clean_tree, format_percent, format_value
from pantocheck.conformance.results.population_format import (
    PooledGroup,
    PooledLevel,
    PooledRecord,
    PopulationFile,
    Variability,
)

BOX_TEXT = (
    "Every record is identified on its own. A box holds the certain modes of one group of all tests: quartiles and "
    "median. Outliers are more than 1.5 interquartile ranges outside the quartiles."
)
MEDIAN_TEXT = (
    "Intervals are those of 95 %, with the tests redrawn. The joint result counts each test with the modes of the "
    "joint identification of its line. Spread over tests: interquartile range of the damping ratios minus those of "
    "the same modes in the joint result."
)


def build_population_document(population: PopulationFile) -> doc.Document:
    """The report on population.json."""
    population = clean_tree(population.rounded())
    records, groups = population.records, population.groups
    blocks: list[doc.Block] = [*doc.warn(population.warnings)]
    if groups:
        blocks += [
            doc.Section(
                "Groups of modes", (doc.Paragraph(BOX_TEXT), _draw_figures(groups, records), _box_table(groups))
            ),
            doc.Section("Tests beside the joint result", (doc.Paragraph(MEDIAN_TEXT), _comparison_table(groups))),
            doc.Section("Variability", (doc.Paragraph(_describe_variability(population.variability)),)),
        ]
    blocks.append(doc.Section("Tests", (_record_table(records),)))
    if population.levels:
        blocks.append(doc.Section("Medians by mass, place, sensors and tensions", (_level_table(population.levels),)))
    return doc.build_plain_document("Damping ratios over tests", _write_headline(records, groups), blocks)


def _write_headline(records: Sequence[PooledRecord], groups: Sequence[PooledGroup]) -> str:
    agreeing = [group for group in groups if group.agrees]
    compared = [group for group in groups if group.agrees is not None]
    count = count_noun(len(records), "test")
    return (
        f"{count} identified one by one; the medians of {len(agreeing)} of {len(compared)} groups agree with the joint "
        "identification."
    )


def _draw_figures(groups: Sequence[PooledGroup], records: Sequence[PooledRecord]) -> doc.Figures:
    boxes = doc.Figure(
        draw_test_boxes(groups, records),
        "Box plots over tests of the damping ratio of each group; the numbers are in the table of groups.",
        "Damping ratio per group over all tests.",
    )
    ratios = doc.Figure(
        draw_test_ratios(records),
        "Damping ratios of all tests over frequency; the numbers are in population.json.",
        "Damping ratio of every certain mode of every test, with the number of the test in the table of tests.",
    )
    return doc.Figures((boxes, ratios))


def _box_table(groups: Sequence[PooledGroup]) -> doc.Table:
    cells: dict[str, Callable[[PooledGroup], str]] = {
        "Group": lambda group: str(group.group),
        "Frequency [Hz]": lambda group: f"{format_value(group.from_Hz)}–{format_value(group.to_Hz)}",
        "Tests": lambda group: str(group.tests),
        "Values": lambda group: str(group.values),
        "Quartiles [%]": lambda group: _format_range((group.lower_quartile, group.upper_quartile)),
        "Median [%]": lambda group: format_percent(group.median),
        "Outliers above": lambda group: str(group.outliers_above),
        "Outliers below": lambda group: str(group.outliers_below),
    }
    return doc.make_grid("Damping ratios of all tests per group of span modes", groups, cells)


def _comparison_table(groups: Sequence[PooledGroup]) -> doc.Table:
    def spread(group: PooledGroup) -> str:
        return "–" if group.test_spread is None else format_percent(group.test_spread / group.median, 2)

    words = {True: "yes", False: "no", None: "–"}
    cells: dict[str, Callable[[PooledGroup], str]] = {
        "Group": lambda group: str(group.group),
        "Median over tests [%]": lambda group: format_percent(group.median),
        "Interval [%]": lambda group: _format_range(group.interval),
        "Joint median [%]": lambda group: format_percent(group.joint_median),
        "Interval of the joint median [%]": lambda group: _format_range(group.joint_interval),
        "Agrees": lambda group: words[group.agrees],
        "Spread over tests [% of the median]": spread,
    }
    return doc.make_grid("Medians of the tests beside those of the joint identification", groups, cells)


def _format_range(values: Sequence[float] | None) -> str:
    return "–" if values is None else f"{format_percent(values[0])}–{format_percent(values[1])}"


def _describe_variability(variability: Variability) -> str:
    sentences = []
    if variability.rank_correlation is not None:
        sentences.append(
            f"The rank correlation of interquartile range and frequency over {variability.groups} groups is "
            f"{format_value(variability.rank_correlation, 2)}; −1 means that the variability decreases from each "
            "group to the next."
        )
    if variability.last_over_first is not None:
        sentences.append(
            f"The interquartile range of the last group is {format_value(variability.last_over_first, 2)} times "
            "that of the first."
        )
    if variability.outliers:
        sentences.append(
            f"{format_percent(variability.outliers_above_share, 3)} % of the {variability.outliers} outliers lie "
            "above their box."
        )
    else:
        sentences.append("No damping ratio is an outlier.")
    return " ".join(sentences)


def _record_table(records: Sequence[PooledRecord]) -> doc.Table:
    numbers = {id(record): str(t) for t, record in enumerate(records, 1)}
    cells: dict[str, Callable[[PooledRecord], str]] = {
        "No.": lambda record: numbers[id(record)],
        "Mass": lambda record: f"{format_value(record.mass_kg, 3)} kg",
        "Place": lambda record: f"{record.drop_wire or '?'} at {format_value(record.drop_position_m)} m",
        "Certain modes": lambda record: f"{record.certain} of {record.modes}",
        "Misfit": lambda record: format_value(record.misfit, 3),
        "Outliers above, below": lambda record: f"{record.outliers_above}, {record.outliers_below}",
        "Test": lambda record: str(record.record),
    }
    return doc.make_grid("Records, each identified on its own", records, cells)


def _level_table(levels: Sequence[PooledLevel]) -> doc.Table:
    def medians(level: PooledLevel) -> str:
        return ", ".join(f"{group}: {format_percent(ratio)}" for group, ratio in level.medians.items())

    cells: dict[str, Callable[[PooledLevel], str]] = {
        "Property": lambda level: str(level.factor),
        "Level": lambda level: str(level.level),
        "Tests": lambda level: str(level.tests),
        "Median damping ratio by group [%]": medians,
    }
    return doc.make_grid("Medians of the tests with one mass, place, set of sensors or tension", levels, cells)


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

"""Report on a damping fit, from damping.json, with its figures."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from matplotlib.figure import Figure

from pantocheck.conformance.core.figure_style import FULL, GREY, INK, SHADES, add_legend, label_decades, render_svg
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.shape_figure import draw_shapes, list_paired_rows
from pantocheck.conformance.pages.words import clean_tree, format_percent, format_value
from pantocheck.conformance.results.damping_format import (
    Coefficient,
    DampingResults,
    FittedModels,
    FittedProperty,
    GroupResidual,
    Matching,
    Observability,
    PairedMode,
    PairedShapes,
    Thresholds,
)

NOMINAL_INTERVALS = (
    "Intervals are nominal 95 % intervals: value ± 1.96 standard deviations. In 1,472 simulated records of the "
    "field, with drops up to 60 kg, 94 to 96 % of the intervals of the modes contained the true value: see "
    f"{DocumentationPage.IDENTIFICATION_COVERAGE}."
)
"""Meaning of the intervals of modes and coefficients, with their measured coverage."""

COEFFICIENT_UNITS = {"stiffness": "s", "mass": "1/s"}
RESULT = (
    "The block replaces [damping] in the line file. Mass coefficients multiply M, stiffness coefficients multiply K."
)
LINE_STATES = {
    "consistent": "The line of the fit is the line of the record.",
    "unconfirmed": "The line of the fit is not confirmed.",
    "contradicted": "The line of the fit is NOT the line of the record.",
}
LINE_FIT = (
    "Factors on the stated values, fitted together with the coefficients; the intervals of either contain the "
    "uncertainty of the other. A tension holds for the stated mass per length."
)
REACH = (
    "Residual of each group of span modes. A group is not explained if scatter as among the modes of a group gives its "
    "residual with a probability below 1 % for all groups together."
)
COMPARISON = "The line as it is: the line with the damping of its line file."


def build_damping_document(results: DampingResults, block: str) -> doc.Document:
    """The report on a damping fit; the block is its result as TOML for the line file."""
    results = clean_tree(results.rounded())
    kinds = dict.fromkeys(_component(row) for row in results.observability if row.observable)
    headline = (
        f"Rayleigh damping is fitted to {sum(pair.used for pair in results.pairs)} modes; the residual is "
        f"{100 * results.residual:.2g} % of their damping ratios. Observable: {', '.join(kinds) or 'nothing'}. "
        f"{sum(row.determined for row in results.coefficients)} of {len(results.coefficients)} coefficients "
        f"are determined. {LINE_STATES[results.line.state]}"
    )
    warnings = list(results.warnings)
    if results.unpaired:
        frequencies = ", ".join(format_value(frequency) for frequency in results.unpaired)
        warnings.append(f"measured modes without a counterpart in the model: {frequencies} Hz")
    matching = describe_matching(results.matching, results.thresholds)
    blocks: list[doc.Block] = [*doc.warn(warnings), doc.Paragraph(matching), doc.Paragraph(NOMINAL_INTERVALS)]
    comparison = doc.Figure(
        draw_comparison(results.comparison),
        "Damping ratio over frequency, measured and of the models; the pairs are in the table.",
        "Damping ratio: measured (nominal 95 % intervals), of the line as it is, of Rayleigh, and of Rayleigh + "
        "modal damping.",
    )
    observability = doc.Figure(
        draw_observability(results.observability, results.thresholds),
        "Bars of the numbers in the table; filled bars are observable.",
        "Observability: filled bars are observable, dashed lines are the thresholds.",
    )
    explanation = describe_observability(results.thresholds)
    sections: dict[str, tuple[doc.Block, ...]] = {
        "Result": (doc.Paragraph(RESULT), doc.CodeBlock(block), _coefficient_table(results.coefficients)),
        "Line": (doc.Paragraph(LINE_FIT), _property_table(results.properties)) if results.properties else (),
        "Reach of the model": (doc.Paragraph(REACH), _group_table(results.groups)) if results.groups else (),
        "Comparison": (doc.Paragraph(COMPARISON), doc.Figures((comparison,))),
        "Mode shapes": tuple(_list_shape_figures(results.shapes)),
        "Observability": (
            doc.Paragraph(explanation),
            doc.Figures((observability,)),
            _observability_table(results.observability),
        ),
        "Pairs of modes": (_pair_table(results.pairs),),
    }
    blocks += (doc.Section(heading, parts) for heading, parts in sections.items() if parts)
    return doc.build_plain_document("Damping model from mass drops", headline, blocks)


def describe_observability(thresholds: Thresholds) -> str:
    """Meaning of an observable coefficient, by the `thresholds` of damping.json."""
    return (
        "A coefficient is observable if its plausible value contributes at least "
        f"{100 * thresholds.largest_share:g} % of the damping of some mode and is at least "
        f"{thresholds.plausible_over_std:g} times its standard deviation. "
        "The standard deviation takes the coefficients of the wires as unknown as well."
    )


def describe_matching(matching: Matching, thresholds: Thresholds) -> str:
    """Share and MAC of the matched modes, and the thresholds of a determined coefficient."""
    return (
        f"{matching.matched} of {matching.modes} identified modes "
        f"({format_percent(matching.matched_share, 3)} %) have a counterpart in the model of the line. "
        f"MAC of the matched modes: median {format_value(matching.median_mac, 3)}, "
        f"lowest {format_value(matching.lowest_mac, 3)}. A coefficient is determined if it is observable, if at "
        f"least {100 * thresholds.matched_share:g} % of the modes are matched, and if their median MAC is at least "
        f"{thresholds.median_mac:g}."
    )


def _list_shape_figures(shapes: PairedShapes) -> Iterator[doc.Figures]:
    """One figure with the shapes of all listed groups; none without modes of two sensors."""
    if columns := list_paired_rows(shapes.modes):
        values = "; ".join(row.label.replace("\n", ", ") for column in columns for row in column.rows)
        figure = doc.Figure(
            draw_shapes(columns, shapes.supports_m),
            f"Computed shapes of contact and messenger wire with the measured values at the sensors: {values}.",
            "Mode shapes: computed along the line, and measured at the sensors (real part), with the frequency and the "
            "MAC; vertical lines are supports.",
        )
        yield doc.Figures((figure,))


def _component(row: Coefficient | Observability) -> str:
    return row.kind.replace("_", " ")


def _coefficient_table(rows: Sequence[Coefficient]) -> doc.Table:
    cells: dict[str, Callable[[Coefficient], str]] = {
        "Component": _component,
        "Multiplies": lambda row: row.matrix,
        "Value": lambda row: f"{format_value(row.value)} {COEFFICIENT_UNITS[row.matrix]}",
        "Nominal 95 % interval": lambda row: f"{format_value(row.low_95, 3)} to {format_value(row.high_95, 3)}",
        "Determined": lambda row: "yes" if row.determined else "not determined",
    }
    return doc.make_grid("Coefficients", rows, cells)


def _property_table(rows: Sequence[FittedProperty]) -> doc.Table:
    cells: dict[str, Callable[[FittedProperty], str]] = {
        "Property": lambda row: row.name.replace("_", " "),
        "Factor": lambda row: format_value(row.factor, 5),
        "Nominal 95 % interval": lambda row: f"{format_value(row.low_95, 5)} to {format_value(row.high_95, 5)}",
        "Tolerance [%]": lambda row: format_percent(row.tolerance, 3),
        "Determined": lambda row: "yes" if row.determined else "no: at its stated value",
    }
    return doc.make_grid("Properties of the line", rows, cells)


def _group_table(rows: Sequence[GroupResidual]) -> doc.Table:
    cells: dict[str, Callable[[GroupResidual], str]] = {
        "Group": lambda row: str(row.group),
        "Modes": lambda row: str(row.modes),
        "Mean residual [%]": lambda row: format_percent(row.mean, 3),
        "RMS residual [%]": lambda row: format_percent(row.rms, 3),
        "Chi-square": lambda row: format_value(row.chi_square, 3),
        "Probability": lambda row: format_value(row.probability, 2),
        "Explained": lambda row: "yes" if row.explained else "NO",
    }
    return doc.make_grid("Residuals of the groups", rows, cells)


def _observability_table(rows: Sequence[Observability]) -> doc.Table:
    cells: dict[str, Callable[[Observability], str]] = {
        "Component": _component,
        "Multiplies": lambda row: row.matrix,
        "Share [%]": lambda row: format_percent(row.largest_share, 3),
        "Std": lambda row: format_value(row.std, 2),
        "Plausible / std": lambda row: format_value(row.plausible_over_std, 3),
        "Inflation": lambda row: format_value(row.variance_inflation, 3),
        "Residual without": lambda row: format_value(row.residual_without, 3),
        "Observable": lambda row: "yes" if row.observable else "no",
    }
    return doc.make_grid("Information of the modes on each coefficient", rows, cells)


def _pair_table(pairs: Sequence[PairedMode]) -> doc.Table:
    cells: dict[str, Callable[[PairedMode], str]] = {
        "Measured [Hz]": lambda pair: format_value(pair.measured_Hz, 5),
        "Computed [Hz]": lambda pair: format_value(pair.computed_Hz, 5),
        "MAC": lambda pair: format_value(pair.mac, 4),
        "Group": lambda pair: str(pair.group),
        "Measured ζ [%]": lambda pair: format_percent(pair.measured),
        "Fitted ζ [%]": lambda pair: format_percent(pair.fitted),
        "Used": lambda pair: (
            "yes" if pair.used else f"no: {'overlaps another mode' if pair.overlapping else 'outlier of its group'}"
        ),
    }
    return doc.make_grid("Measured modes and their computed counterparts", pairs, cells)


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

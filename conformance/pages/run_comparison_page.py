"""Report on a comparison of runs, from comparison.json."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from pantocheck.conformance.core.figure_data import Spectrum
from pantocheck.conformance.core.figure_style import (
    FULL,
    GREY,
    HALF,
    INK,
    PlotStyle,
    add_legend,
    new_figure,
    render_svg,
)
from pantocheck.conformance.core.results_part import select_single
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.comparison_parts import clean_model
from pantocheck.conformance.pages.condition_sections import BAND_MARK, CONDITIONED
from pantocheck.conformance.pages.criteria_table import Basis
from pantocheck.conformance.pages.frequency_section import mute_cell
from pantocheck.conformance.pages.study_chart import draw_chart
from pantocheck.conformance.pages.view_page import draw_scene
from pantocheck.conformance.pages.words import (
    clean_text,
    format_plain,
    format_signed,
    format_value,
    name_pantograph,
    quantity_label,
    quantity_unit,
)
from pantocheck.conformance.results.case_facts_format import (
    ForceStatistics,
    MeasuredPantograph,
    MeasuredRun,
    SpanStatistics,
)
from pantocheck.conformance.results.comparison_format import ComparedOwner, ComparedQuantity, RunComparison
from pantocheck.conformance.results.incomplete_uncertainty import describe_half_width, list_unknown
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.results.supported_frequency import (
    SupportedFrequency,
    describe_supported,
    is_supported,
    reaches,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Supported = Mapping[str, Sequence[SupportedFrequency]]
"""Highest frequencies that the parts of the model of each subject support, by its name."""

RUN_COMPARISON_SCOPE = (
    "The comparison judges nothing: it has no limits and no verdict. A number in parentheses is the difference from "
    "the first subject. An asterisk marks a difference that exceeds the joint nominal 95 % uncertainty of both values. "
    "The uncertainty of a record is that of its length; its discretisation error is not known."
)

UNKNOWN_CONTACT = (
    f"{BAND_MARK} Values from 20 to 50 Hz are conditional on the contact stiffness of each subject, which a record "
    "does not state."
)


def build_run_comparison(results: RunComparison) -> doc.Document:
    """The report on the content of comparison.json."""
    scenes = [scene.model_copy(update={"names": list(map(clean_text, scene.names))}) for scene in results.scenes]
    results = clean_model(results.model_copy(update={"scenes": ()}))
    names = [subject.name for subject in results.subjects]
    header = doc.PlainHeader("Comparison of runs", f"{', '.join(names[1:])} beside {names[0]}.")
    facts = {
        subject.name: f"{subject.source}, {subject.digest}" if subject.digest else str(subject.source)
        for subject in results.subjects
    }
    suite = results.suite
    facts |= {"Suite": f"Pantocheck {suite.version}", "Digest of the suite": suite.digest}
    blocks: list[doc.Block] = [doc.Paragraph(RUN_COMPARISON_SCOPE), doc.Facts(tuple(facts.items()))]
    passages = {scene.id: doc.Figures((draw_scene(scene, n),)) for n, scene in enumerate(scenes)}
    for case in results.cases:
        supported = dict(zip(names, case.supported or [()] * len(names), strict=True))
        owners = [_build_owner(owner, supported) for owner in case.owners if owner.quantities]
        blocks.append(
            doc.Section(case.id or "Records", (*doc.warn(case.notes), *filter(None, (passages.get(case.id),)), *owners))
        )
    return doc.Document(header.headline, header, tuple(blocks), scenes=tuple(scenes))


def _build_owner(owner: ComparedOwner, supported: Supported) -> doc.Section:
    """Figures, agreement and quantities of a pantograph or of the line; grey above the supported frequencies."""
    blocks: list[doc.Block] = []
    if owner.charts:
        figures = (
            doc.Figure(draw_chart(chart), chart.alternative, chart.caption, chart.wide) for chart in owner.charts
        )
        blocks.append(doc.Figures(tuple(figures)))
    if owner.reasons:
        blocks.append(doc.BulletList(tuple(owner.reasons)))
    if owner.agreements:
        blocks.append(_build_agreement_table(owner, supported))
    blocks.append(_build_quantity_table(owner, supported))
    texts = [f"{name} {describe_supported(parts, str(owner.number))}" for name, parts in supported.items() if parts]
    if texts:
        blocks.append(doc.SmallPrint(f"Highest supported frequency: {'; '.join(texts)}. Grey: not supported."))
    if any(item.name == CONDITIONED for item in owner.quantities):
        blocks.append(doc.SmallPrint(UNKNOWN_CONTACT))
    return doc.Section(name_pantograph(owner.number).capitalize(), tuple(blocks))


def _build_agreement_table(owner: ComparedOwner, supported: Supported) -> doc.Table:
    """RMS values of the bands; those that a force of the row does not support are grey."""
    first = next(iter(supported))
    rows = [(agreement, band) for agreement in owner.agreements for band in agreement.bands]
    cells = {
        "Subject": lambda row: row[0].subject,
        "Band [Hz]": lambda row: f"{format_plain(row[1].low_Hz)} to {format_plain(row[1].high_Hz)}",
        f"RMS of {first} [N]": lambda row: format_value(row[1].first_N),
        "RMS of the subject [N]": lambda row: format_value(row[1].other_N),
        "RMS of the difference [N]": lambda row: format_value(row[1].difference_N),
        "Correlation of the whole force": lambda row: format_value(row[0].correlation, 3),
    }
    table = doc.make_grid("Agreement of the forces at the same positions", rows, cells)
    muted = [
        cells
        if all(reaches(supported[name], str(owner.number), band.high_Hz) for name in (first, agreement.subject))
        else tuple(map(mute_cell, cells))
        for (agreement, band), cells in zip(rows, table.rows, strict=True)
    ]
    return replace(table, rows=tuple(muted))


def _build_quantity_table(owner: ComparedOwner, supported: Supported) -> doc.Table:
    columns = (doc.Column("Quantity", share=1), *(doc.Column(name, number=True) for name in supported))
    rows = tuple(
        (
            _name_quantity(item.name),
            *(_build_cell(item, i, owner.number, parts) for i, parts in enumerate(supported.values())),
        )
        for item in owner.quantities
    )
    return doc.Table(columns, rows, "Quantities", layout="grid")


def _build_cell(item: ComparedQuantity, index: int, owner: int, parts: Sequence[SupportedFrequency]) -> doc.RichText:
    """Value of a subject, grey if its model does not support it."""
    text = format_compared(item, index)
    return text if is_supported(parts, str(owner), item.name) else doc.Muted(text)


def _name_quantity(name: str) -> str:
    unit, mark = quantity_unit(name), f" {BAND_MARK}" if name == CONDITIONED else ""
    return f"{quantity_label(name)}{mark} [{unit}]" if unit else quantity_label(name)


def format_compared(quantity: ComparedQuantity, index: int) -> str:
    """Value of a subject with its uncertainty and its difference from the first subject.

    Returns:
        Text such as `28.12 ± 0.4 (+1.2 *)`; for several numbers their count and the largest difference.
    """
    value, width = quantity.values[index], quantity.uncertainty[index]
    if value is None:
        return "–"
    if isinstance(value, tuple):
        text = f"{len(value)} values"
    else:
        text = format_value(value) + (f" ± {format_value(width, 2)}" if isinstance(width, float) and width else "")
    difference = quantity.difference[index]
    if index == 0 or difference is None:
        return text
    mark = " *" if quantity.beyond_uncertainty[index] else ""
    return f"{text} ({format_signed(difference)}{mark})"


# Section of a case on the measured run beside it: values, curves, spectra and spans.
def comparison_blocks(case: CaseResult, number: int, anchor: str) -> tuple[doc.Block, ...]:
    """Blocks on the measured run of a case; empty if nothing is compared; arguments as in `draw_case_figures`."""
    comparison = case.comparison
    if comparison is None:
        return ()
    text = f"Measured record {comparison.name}. Curves show the track that both runs cover."
    blocks: list[doc.Block] = [doc.Paragraph(text), _build_value_table(case, comparison)]
    figures = tuple(
        figure
        for key, pantograph in comparison.pantographs.items()
        for figure in _draw_figures(doc.Curves("measured", number, key), pantograph, comparison, anchor)
    )
    if figures:
        blocks.append(doc.Figures(figures))
    blocks += [
        _build_span_table(key, pantograph.spans)
        for key, pantograph in comparison.pantographs.items()
        if pantograph.spans
    ]
    return (doc.Section("Simulated and measured run", tuple(blocks)),)


def _build_value_table(case: CaseResult, comparison: MeasuredRun) -> doc.Table:
    """Quantities that both runs have, with the uncertainties of both."""
    columns = (
        doc.Column("Quantity", share=1),
        doc.Column("Owner"),
        *(doc.Column(heading, number=True) for heading in ("Simulated", "±", "Measured", "±", "Difference")),
        doc.Column("Unit"),
    )
    rows: list[tuple[doc.RichText, ...]] = []
    for key, measured in comparison.quantities.items():
        simulated, widths = case.quantities.get(key, {}), case.uncertainty.get(key, {})
        for name, value in measured.items():
            other = simulated.get(name)
            if isinstance(value, list) or isinstance(other, list | None):
                continue
            rows.append(
                (
                    quantity_label(name),
                    name_pantograph(key),
                    format_value(other),
                    _format_width(select_single(widths.get(name)), case.uncertainty_basis, name),
                    format_value(value),
                    format_value(select_single(comparison.uncertainty.get(key, {}).get(name)), 2),
                    format_signed(other - value),
                    quantity_unit(name),
                )
            )
    return doc.Table(columns, tuple(rows), "Values of both runs, with the half-widths of their nominal 95 % intervals")


def _format_width(width: float | None, basis: Basis, quantity: str) -> str:
    """Half-width of a simulated value with two digits; a dash without one."""
    return "–" if width is None else describe_half_width(width, format_value(width, 2), list_unknown(basis), quantity)


def _draw_figures(
    curves: doc.Curves, pantograph: MeasuredPantograph, comparison: MeasuredRun, anchor: str
) -> Iterator[doc.Figure]:
    if not pantograph.position_m:
        return
    who, cutoff = f"Pantograph {curves.owner}", format_plain(comparison.cutoff_Hz)
    largest = format_value(max(map(abs, force_difference(pantograph))), 3)
    caption = f"{who}: contact force up to {cutoff} Hz, simulated and measured; below, their difference."
    yield doc.Figure(
        draw_overlay(pantograph),
        f"{caption} Largest difference {largest} N.",
        caption,
        anchor=f"{anchor}-measured-{curves.owner}",
        curves=curves,
    )
    caption = f"{who}: amplitude spectra, simulated and measured; below, their difference."
    yield doc.Figure(
        draw_run_spectra(pantograph), f"{caption} The table has the RMS of the bands.", caption, wide=False
    )
    if pantograph.spans:
        caption = f"{who}: mean and standard deviation of the force up to {cutoff} Hz, span by span."
        yield doc.Figure(draw_spans(pantograph), f"{caption} The table has the values.", caption, wide=False)


def _build_span_table(key: str, spans: Sequence[SpanStatistics]) -> doc.Table:
    statistics: dict[str, Callable[[ForceStatistics], float]] = {
        "Mean": lambda run: run.mean_N,
        "σ": lambda run: run.std_N,
        "Max.": lambda run: run.max_N,
        "Min.": lambda run: run.min_N,
    }

    def show(run: str, select: Callable[[ForceStatistics], float], span: SpanStatistics) -> str:
        return format_value(select(getattr(span, run)))

    cells: dict[str, Callable[[SpanStatistics], str]] = {
        "From [m]": lambda span: format_plain(span.start_m),
        "To [m]": lambda span: format_plain(span.end_m),
    }
    for run, short in (("simulated", "sim."), ("measured", "meas.")):
        cells |= {f"{label} {short}": partial(show, run, select) for label, select in statistics.items()}
    caption = f"Pantograph {key}: statistics of the filtered force span by span [N], simulated and measured"
    return doc.make_grid(caption, spans, cells)


# Figures of a simulated run and a measured one: forces over the track with their difference, spectra, spans.
SIMULATED: PlotStyle = {"color": INK, "linewidth": 1.2, "label": "simulated"}
MEASURED: PlotStyle = {"color": GREY, "linewidth": 1.2, "linestyle": "--", "label": "measured"}
"""Styles of the two runs; they differ without colour."""

SPAN_STATISTICS: dict[str, Callable[[ForceStatistics], float]] = {
    "mean [N]": lambda run: run.mean_N,
    "σ [N]": lambda run: run.std_N,
}
"""Statistics that the figure of the spans shows, by their labels."""


@render_svg
def draw_overlay(pantograph: MeasuredPantograph) -> "Figure":
    """Filtered forces of one pantograph in both runs; below, simulated minus measured force."""
    figure = new_figure(FULL, 3.0)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    position = pantograph.position_m
    upper.plot(position, pantograph.simulated_N, **SIMULATED)
    upper.plot(position, pantograph.measured_N, **MEASURED)
    lower.plot(position, force_difference(pantograph), color=INK, linewidth=0.9)
    lower.axhline(0.0, color=GREY, linewidth=0.8)
    for axes in (upper, lower):
        for support in list_span_ends(pantograph):
            axes.axvline(support, color=GREY, linewidth=0.6, linestyle=":")
    upper.set_ylabel("contact force [N]")
    lower.set(xlabel="position along the track [m]", ylabel="difference [N]", xlim=(position[0], position[-1]))
    add_legend(upper)
    return figure


@render_svg
def draw_run_spectra(pantograph: MeasuredPantograph) -> "Figure":
    """Amplitude spectra of the unfiltered forces in both runs; below, simulated minus measured amplitude."""
    figure = new_figure(HALF, 3.0)
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
def draw_spans(pantograph: MeasuredPantograph) -> "Figure":
    """Mean and standard deviation of the filtered force span by span in both runs."""
    figure = new_figure(HALF, 3.0)
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


def list_span_ends(pantograph: MeasuredPantograph) -> list[float]:
    """Supports at both ends of every compared span [m]."""
    return sorted({place for span in pantograph.spans for place in (span.start_m, span.end_m)})


def _draw_span_values(
    axes: "Axes", spans: Sequence[SpanStatistics], select: Callable[[ForceStatistics], float]
) -> None:
    edges = [spans[0].start_m, *(span.end_m for span in spans)]
    for runs, style in (([span.simulated for span in spans], SIMULATED), ([span.measured for span in spans], MEASURED)):
        values = [select(run) for run in runs]
        axes.step(edges, [*values, values[-1]], where="post", **style)
    axes.set_xlim(edges[0], edges[-1])

"""Section of a case on the measured run beside it: values, curves, spectra and spans."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.certificate.criteria_table import Basis
from pantocheck.conformance.reports.figures.overlay_figure import (
    draw_overlay,
    draw_run_spectra,
    draw_spans,
    force_difference,
)
from pantocheck.conformance.reports.page_text import format_plain, format_value, replace_minus
from pantocheck.conformance.reports.words import name_pantograph, quantity_label, quantity_unit
from pantocheck.conformance.results.incomplete_uncertainty import list_unknown, mark_half_width
from pantocheck.conformance.results.measured_run_format import (
    ForceStatistics,
    MeasuredPantograph,
    MeasuredRun,
    SpanStatistics,
)
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.results.results_part import select_single


def comparison_blocks(case: CaseResult, number: int, anchor: str) -> tuple[doc.Block, ...]:
    """Blocks on the measured run of a case; empty if nothing is compared.

    Args:
        case: The case.
        number: Index of the case in the results.
        anchor: Anchor of the section of the case.
    """
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
                    _format_width(select_single(widths.get(name)), case.uncertainty_basis),
                    format_value(value),
                    format_value(select_single(comparison.uncertainty.get(key, {}).get(name)), 2),
                    replace_minus(f"{other - value:+.3g}"),
                    quantity_unit(name),
                )
            )
    return doc.Table(columns, tuple(rows), "Values of both runs, with the half-widths of their 95 % intervals")


def _format_width(width: float | None, basis: Basis) -> str:
    """Half-width of a simulated value with two digits and its mark; a dash without one."""
    return "–" if width is None else mark_half_width(width, format_value(width, 2), list_unknown(basis))


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
    cells: dict[str, Callable[[SpanStatistics], str]] = {
        "From [m]": lambda span: format_plain(span.start_m),
        "To [m]": lambda span: format_plain(span.end_m),
    }
    cells |= {f"{label} sim.": partial(_format_simulated, select) for label, select in statistics.items()}
    cells |= {f"{label} meas.": partial(_format_measured, select) for label, select in statistics.items()}
    caption = f"Pantograph {key}: statistics of the filtered force span by span [N], simulated and measured"
    return doc.make_grid(caption, spans, cells)


def _format_simulated(select: Callable[[ForceStatistics], float], span: SpanStatistics) -> str:
    return format_value(select(span.simulated))


def _format_measured(select: Callable[[ForceStatistics], float], span: SpanStatistics) -> str:
    return format_value(select(span.measured))

"""Figures of a case with their captions and alternative texts."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.figure_data import Chart, Histogram, Traces, UpliftTrace
from pantocheck.conformance.core.results_part import Number, select_single
from pantocheck.conformance.pages.document import Curves, Figure
from pantocheck.conformance.pages.force_figures import (
    draw_force,
    draw_histogram,
    draw_spectrum,
    draw_uplift,
    select_limited,
)
from pantocheck.conformance.pages.reference_values import select_reference_force
from pantocheck.conformance.pages.study_chart import draw_chart, find_common_range
from pantocheck.conformance.pages.words import format_plain, format_value
from pantocheck.conformance.quantities.bands import BANDS
from pantocheck.conformance.results.results_format import CaseResult

LISTED_SUPPORTS = 3
"""Largest number of supports that a caption lists one by one."""


def draw_case_figures(case: CaseResult, number: int, anchor: str) -> Iterator[Figure]:
    """Charts of a study, then force, spectrum and histogram of each pantograph, then the uplift.

    Args:
        case: The case.
        number: Index of the case in the results.
        anchor: Anchor of the section of the case.
    """
    yield from _chart_figures(case.charts)
    limited = [row for row in case.criteria if not row.is_drift]
    for key, trace in sorted(case.traces.items(), key=lambda item: (len(item[0]), item[0])):
        if trace.position_m:
            rows = [row for row in limited if str(row.pantograph) == key]
            curves = Curves("force", number, key)
            figure = _force_figure(key, trace, rows, select_reference_force(case, key))
            yield replace(figure, anchor=name_figure(anchor, key), curves=curves)
        if trace.spectrum.frequency_Hz:
            yield _spectrum_figure(key, trace, case.quantities.get(key, {}))
        if trace.histogram:
            yield _histogram_figure(key, trace, trace.histogram)
    supports = [support for support in case.uplift if support.time_s]
    if supports:
        drawing = draw_uplift(supports, limited)
        alternative = f"Uplift at the supports. Largest: {', '.join(map(_describe_peak, supports))}."
        caption = _describe_uplift(supports)
        yield Figure(drawing, alternative, caption, anchor=name_figure(anchor, "0"), curves=Curves("uplift", number))


def _describe_uplift(supports: Sequence[UpliftTrace]) -> str:
    """Caption of the uplift: every support of a few, or the number, the ends and the largest of many."""
    if len(supports) <= LISTED_SUPPORTS:
        return f"Uplift at the supports. Largest: {', '.join(map(_describe_peak, supports))}."
    places = [support.support_m for support in supports]
    first, last = format_plain(min(places)), format_plain(max(places))
    highest = max(supports, key=lambda support: max(support.uplift_mm))
    return f"Uplift at {len(supports)} supports from {first} m to {last} m. Largest: {_describe_peak(highest)}."


def _describe_peak(support: UpliftTrace) -> str:
    return f"{format_plain(round(max(support.uplift_mm)))} mm at {format_plain(support.support_m)} m"


def name_figure(anchor: str, owner: str) -> str:
    """Anchor of the figure with the force of a pantograph, or with the uplift for the line "0"."""
    return f"{anchor}-uplift" if owner == "0" else f"{anchor}-force-{owner}"


def _chart_figures(charts: Sequence[Chart]) -> Iterator[Figure]:
    """Charts of a study; those that stand side by side and have the same linear y axis get one scale."""
    for (wide, _, scale), group in groupby(charts, lambda chart: (chart.wide, chart.y_label, chart.y_scale)):
        neighbours = list(group)
        shared = not wide and scale == "linear" and len(neighbours) > 1
        y_range = find_common_range(neighbours) if shared else None
        for chart in neighbours:
            yield Figure(draw_chart(chart, y_range), chart.alternative, chart.caption, wide)


def _force_figure(key: str, trace: Traces, criteria: Sequence[Criterion], reference: list[float]) -> Figure:
    start, end = trace.position_m[0], trace.position_m[-1]
    mean, std = trace.mean_N, trace.std_N
    text = f"Pantograph {key}: contact force from {format_plain(start)} m to {format_plain(end)} m"
    if std is not None:
        low, high = format_value(mean - 3 * std), format_value(mean + 3 * std)
        text += f"; mean {format_value(mean)} N, mean ± 3 σ from {low} N to {high} N"
    limited = select_limited(criteria)
    strip = " On the right: limits and values of the force statistics." if limited else ""
    behind = " Behind: the reference simulator." if reference else ""
    return Figure(draw_force(trace, limited, reference), f"{text}.{behind}", f"{text}.{behind}{strip}")


def _spectrum_figure(key: str, trace: Traces, quantities: Mapping[str, Number]) -> Figure:
    values = [
        f"{low:g} to {high:g} Hz: {format_value(select_single(quantities[name]))} N"
        for low, high, name in BANDS
        if quantities.get(name) is not None
    ]
    caption = f"Pantograph {key}: amplitude spectrum of the force, with the RMS of its bands."
    alternative = f"{caption} {'; '.join(values)}." if values else caption
    return Figure(draw_spectrum(trace, quantities), alternative, caption, wide=False)


def _histogram_figure(key: str, trace: Traces, histogram: Histogram) -> Figure:
    edges = histogram.edges_N
    caption = f"Pantograph {key}: histogram of the 20 Hz force."
    alternative = f"{caption} From {format_value(edges[0])} N to {format_value(edges[-1])} N."
    return Figure(draw_histogram(trace, histogram), alternative, caption, wide=False)

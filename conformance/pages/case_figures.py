"""Figures of a case with their captions and alternative texts."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.figure_data import Chart, Histogram, Traces, UpliftTrace
from pantocheck.conformance.core.figure_style import (
    CURVES,
    FULL,
    GREY,
    HALF,
    INK,
    LIMIT_FILL,
    LIMIT_LINE,
    LINES,
    PALE,
    SHADES,
)
from pantocheck.conformance.core.panel_figure import Panel, PanelFigure, write_svg
from pantocheck.conformance.core.panel_marks import LineStyle
from pantocheck.conformance.core.results_part import Number, select_single
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.band_figure import draw_bands
from pantocheck.conformance.pages.criteria_table import name_figure
from pantocheck.conformance.pages.fixed_panels import PanelGrid, lay_panels
from pantocheck.conformance.pages.passage_figure import draw_passage
from pantocheck.conformance.pages.study_chart import draw_chart, find_common_range
from pantocheck.conformance.pages.words import format_plain, format_value
from pantocheck.conformance.quantities.bands import BANDS, EXTENDED_BAND
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.results.supported_frequency import find_supported_Hz

LISTED_SUPPORTS = 3
"""Largest number of supports that a caption lists one by one."""


def draw_case_figures(case: CaseResult, number: int, anchor: str) -> Iterator[doc.Figure]:
    """Charts of a study, then passage, bands, then force, spectrum and histogram of each pantograph, then the uplift.

    `number` is the index of the case in the results, `anchor` that of the section of the case.
    """
    yield from _chart_figures(case.charts)
    yield from draw_passage(case, number, anchor)
    yield from draw_bands(case)
    limited = [row for row in case.criteria if not row.is_drift]
    for key, trace in sorted(case.traces.items(), key=lambda item: (len(item[0]), item[0])):
        supported = find_supported_Hz(case.supported, key)
        if trace.position_m:
            curves = doc.Curves("force", number, key, supported)
            figure = _force_figure(key, trace, select_reference_force(case, key))
            yield replace(figure, anchor=name_figure(anchor, key), curves=curves)
        if trace.spectrum.frequency_Hz:
            yield _spectrum_figure(key, trace, case.quantities.get(key, {}), supported)
        if trace.histogram:
            yield _histogram_figure(key, trace, trace.histogram)
    supports = [support for support in case.uplift if support.time_s]
    if supports:
        drawing = draw_uplift(supports, limited)
        alternative = f"Uplift at the supports. Largest: {', '.join(map(_describe_peak, supports))}."
        caption = _describe_uplift(supports)
        yield doc.Figure(
            drawing, alternative, caption, anchor=name_figure(anchor, "0"), curves=doc.Curves("uplift", number)
        )


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


def _chart_figures(charts: Sequence[Chart]) -> Iterator[doc.Figure]:
    """Charts of a study; those that stand side by side and have the same linear y axis get one scale."""
    for (wide, _, scale), group in groupby(charts, lambda chart: (chart.wide, chart.y_label, chart.y_scale)):
        neighbours = list(group)
        shared = not wide and scale == "linear" and len(neighbours) > 1
        y_range = find_common_range(neighbours) if shared else None
        for chart in neighbours:
            yield doc.Figure(draw_chart(chart, y_range), chart.alternative, chart.caption, wide)


def _force_figure(key: str, trace: Traces, reference: list[float]) -> doc.Figure:
    start, end = trace.position_m[0], trace.position_m[-1]
    mean, std = trace.mean_N, trace.std_N
    caption = f"Pantograph {key}: contact force from {format_plain(start)} m to {format_plain(end)} m."
    caption += " Behind: the reference simulator." if reference else ""
    levels = "" if std is None else f" from {format_value(mean - 3 * std)} N to {format_value(mean + 3 * std)} N"
    text = f"{caption} Mean {format_value(mean)} N, mean ± 3 σ{levels}." if levels else caption
    return doc.Figure(draw_force(trace, reference), text, caption)


def _spectrum_figure(
    key: str, trace: Traces, quantities: Mapping[str, Number], supported_Hz: float | None
) -> doc.Figure:
    values = [
        f"{low:g} to {high:g} Hz: {format_value(select_single(quantities[name]))} N"
        for low, high, name in BANDS
        if quantities.get(name) is not None
    ]
    caption = f"Pantograph {key}: amplitude spectrum of the force, with the RMS of its bands."
    if supported_Hz is not None and supported_Hz < EXTENDED_BAND.high:
        caption += f" Grey: above {supported_Hz:.3g} Hz, not supported."
    alternative = f"{caption} {'; '.join(values)}." if values else caption
    return doc.Figure(draw_spectrum(trace, quantities, supported_Hz), alternative, caption, wide=False)


def _histogram_figure(key: str, trace: Traces, histogram: Histogram) -> doc.Figure:
    edges = histogram.edges_N
    caption = f"Pantograph {key}: histogram of the 20 Hz force."
    alternative = f"{caption} From {format_value(edges[0])} N to {format_value(edges[-1])} N."
    return doc.Figure(draw_histogram(trace, histogram), alternative, caption, wide=False)


# Contact force over the track, its spectrum and its histogram.
MOST_SUPPORT_TICKS = 12
"""Largest number of supports whose positions are the ticks of the track."""

REFERENCE_STYLE = LineStyle(INK, 1.1, (0, (3, 1.5)))
"""Style of the force of the reference; it is hidden where the force of the system lies on it."""


STRIP_COLORS = {"front strip": CURVES[1], "rear strip": CURVES[2]}
"""Colours of the forces of both strips."""


@write_svg
def draw_force(trace: Traces, reference: list[float]) -> PanelFigure:
    """Contact force of one pantograph over its reference, if any."""
    strips = tuple(zip(trace.strip_forces_N or (), STRIP_COLORS.items(), strict=False))
    figure, [[axes]] = lay_panels(PanelGrid(FULL, 1.55, right=0.18, top=0.44 if reference or strips else 0.28))
    position = trace.position_m
    if trace.force_N:
        axes.plot(position, trace.force_N, LineStyle(GREY, 0.6), "unfiltered")
    for force, (label, color) in strips:
        axes.plot(position, force, LineStyle(color, 0.5), label)
    if reference:
        axes.plot(position, reference, REFERENCE_STYLE, "reference, 0–20 Hz")
    if trace.force_20_N:
        axes.plot(position, trace.force_20_N, LineStyle(INK, 1.2), "0–20 Hz")
    _draw_levels(axes.axhline, trace)
    for number, support in enumerate(trace.supports_m):
        axes.axvline(support, LineStyle(INK, 0.8, ":"), None if number else "support")
    axes.x_scale.limits = (position[0], position[-1])
    axes.name_axes("position along the track [m]", "contact force [N]")
    if 1 < len(trace.supports_m) <= MOST_SUPPORT_TICKS:
        axes.x_scale.ticks, axes.x_scale.write = trace.supports_m, "{:g}".format
    axes.add_legend(4 if strips else 3 if reference else 5)
    return figure


MOST_LIMITED = 2
"""Largest number of forces on page 1."""

LIMITED = {"mean_force_N": "mean", "max_force_N": "maximum", "min_force_N": "minimum"}
"""Quantities whose limits are levels of the force."""


def draw_limited_forces(cases: Sequence[CaseResult]) -> tuple[doc.Figure, ...]:
    """Forces of the first cases or pantographs with the limits of their mean and extremes."""
    found = [
        (case, key, trace, [row for row in case.criteria if str(row.pantograph) == key and row.quantity in LIMITED])
        for case in cases
        for key, trace in sorted(case.traces.items())
        if trace.position_m and trace.force_20_N
    ]
    shown = found[:MOST_LIMITED]
    wide = len(shown) == 1
    figures = []
    for case, key, trace, rows in shown:
        caption = f"{case.id}, pantograph {key}: force up to 20 Hz and limits."
        alternative = f"{caption} Grey: limits of {', '.join(LIMITED[row.quantity] for row in rows) or 'no level'}."
        figures.append(doc.Figure(draw_limited_force(trace, rows, FULL if wide else HALF), alternative, caption, wide))
    return tuple(figures)


@write_svg
def draw_limited_force(trace: Traces, rows: Sequence[Criterion], width: float) -> PanelFigure:
    """Force up to 20 Hz with the limits of its mean and extremes as grey bands, or as dashed lines of single limits."""
    figure, [[axes]] = lay_panels(PanelGrid(width, 0.7, right=0.6, bottom=0.2, top=0.05))
    position, force = trace.position_m, trace.force_20_N or []
    for row in rows:
        if row.lower is not None and row.upper is not None:
            axes.axhspan(row.lower, row.upper, LIMIT_FILL)
            place = (1.01, (row.lower + row.upper) / 2)
            axes.text(*place, LIMITED[row.quantity], 6.5, va="center", frame=("panel", "data"))
        else:
            for limit in (row.lower, row.upper):
                if limit is not None:
                    axes.axhline(limit, LineStyle(INK, 0.9, LIMIT_LINE))
    axes.axhline(trace.mean_N, LineStyle(INK, 0.8, "-."))
    axes.plot(position, force, LineStyle(INK, 0.9))
    axes.x_scale.limits = (position[0], position[-1])
    axes.name_axes("", "force [N]")
    axes.x_scale.intervals = 4 if width == HALF else 8
    axes.x_scale.write = "{:g} m".format
    return figure


@write_svg
def draw_spectrum(trace: Traces, quantities: Mapping[str, Number], supported_Hz: float | None = None) -> PanelFigure:
    """Single-sided amplitude spectrum of the unfiltered force with the three bands and their RMS.

    Above the supported frequency [Hz], bands and spectrum are grey.
    """
    frequency, amplitude = trace.spectrum.frequency_Hz, trace.spectrum.amplitude_N
    figure, [[axes]] = lay_panels(PanelGrid(HALF, 1.3))
    axes.plot(frequency, amplitude, LineStyle(INK, 0.9))
    for number, (low, high, quantity) in enumerate(BANDS):
        axes.axvspan(low, high, PALE if number % 2 == 0 else "white")
        axes.axvline(high, LineStyle(GREY, 0.8, "--"))
        rms = select_single(quantities.get(quantity))
        text = f"{low}–{high}" + (f"\n{format_value(rms, 3)}" if rms is not None else "")
        colour = INK if supported_Hz is None or high <= supported_Hz else GREY
        axes.text((low + high) / 2, 1.02, text, color=colour, ha="center", va="bottom", frame=("data", "panel"))
    if supported_Hz is not None and supported_Hz < EXTENDED_BAND.high:
        axes.axvspan(supported_Hz, EXTENDED_BAND.high, GREY, opacity=0.6, level=3.0)
    axes.text(-0.02, 1.02, "Hz\nrms [N]", ha="right", va="bottom", frame=("panel", "panel"))
    axes.x_scale.limits, axes.x_scale.ticks = (0, 50), [0, 5, 10, 20, 30, 40, 50]
    axes.y_scale.limits = (0, None)
    axes.name_axes("frequency [Hz]", "amplitude [N]")
    return figure


@write_svg
def draw_histogram(trace: Traces, histogram: Histogram) -> PanelFigure:
    """Histogram of the 20 Hz force with its mean and mean plus and minus three standard deviations."""
    edges, share = histogram.edges_N, histogram.share_pct
    figure, [[axes]] = lay_panels(PanelGrid(HALF, 1.3))
    axes.y_scale.limits = (0, 1.08 * max(share))
    axes.stairs(share, edges, SHADES[3], INK, 0.6)
    if trace.std_N is not None:
        _draw_levels(axes.axvline, trace)
        axes.x_scale.margin = 0.04
        axes.add_legend()
    axes.name_axes("contact force, 0–20 Hz [N]", "share of samples [%]")
    return figure


def _draw_levels(draw_line: Callable[[float, LineStyle, str | None], None], trace: Traces) -> None:
    """The mean and mean plus and minus three standard deviations, if they are known."""
    mean, std = trace.mean_N, trace.std_N
    if std is not None:
        draw_line(mean, LineStyle(INK, 0.9, "-."), "mean")
        for level, label in ((mean + 3 * std, "mean ± 3 σ"), (mean - 3 * std, None)):
            draw_line(level, LineStyle(INK, 0.9, "--"), label)


# Uplift of the contact wire at the supports.
UPLIFT_COLUMNS = 4
"""Columns of the legend."""

MOST_NAMED = 8
"""Largest number of supports with a line style each; of more, only the largest uplift stands out."""


@write_svg
def draw_uplift(supports: Sequence[UpliftTrace], criteria: Sequence[Criterion]) -> PanelFigure:
    """Uplift over time at the supports of a case, with the limits of the maximum where its criteria grade it."""
    names = len(supports) + 1 if len(supports) <= MOST_NAMED else 3
    figure, [[axes]] = lay_panels(PanelGrid(FULL, 1.4, top=0.12 + 0.16 * math.ceil(names / UPLIFT_COLUMNS)))
    if len(supports) <= MOST_NAMED:
        for number, support in enumerate(supports):
            # Two shades times four dashes: neighbours differ in the shade, and no two of eight curves are equal.
            shade, style = SHADES[number % 2], LINES[number // 2 % len(LINES)]
            name = f"support at {support.support_m:g} m"
            axes.plot(support.time_s, support.uplift_mm, LineStyle(shade, 1.1, style), name)
    else:
        _draw_largest(axes, supports)
    limits = {(row.lower, row.upper) for row in criteria if row.quantity == "max_uplift_at_support_mm"}
    for lower, upper in sorted(limits, key=str):
        levels = [level for level in (lower, upper) if level is not None]
        if lower is not None and upper is not None:
            axes.axhspan(lower, upper, LIMIT_FILL, label="limits of the maximum")
        elif levels:
            axes.axhline(levels[0], LineStyle(INK, 1.2, LIMIT_LINE), "limit of the maximum")
    axes.name_axes("time [s]", "uplift [mm]")
    axes.add_legend(UPLIFT_COLUMNS)
    return figure


def _draw_largest(axes: Panel, supports: Sequence[UpliftTrace]) -> None:
    """All supports in grey with the largest uplift drawn over them: a name for each would fill the figure."""
    largest = max(supports, key=lambda support: max(support.uplift_mm))
    others = [support for support in supports if support is not largest]
    for support in others:
        name = "other supports" if support is others[0] else None
        axes.plot(support.time_s, support.uplift_mm, LineStyle(SHADES[2], 0.8), name)
    name = f"largest: support at {largest.support_m:g} m"
    axes.plot(largest.time_s, largest.uplift_mm, LineStyle(INK, 1.3), name)


def select_reference_force(case: CaseResult, key: str) -> list[float]:
    """Filtered force of the reference at the drawn positions of a pantograph; empty if there is none."""
    return [] if case.reference is None else case.reference.force_20_N.get(key, [])

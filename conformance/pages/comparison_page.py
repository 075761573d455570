"""Page of any comparison of a model with measured values: verdict, remarks, criteria, figures and tables."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pantocheck.conformance.core.figure_style import FULL, GREY, INK, LINES, SHADES, add_legend, render_svg, use_decades
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.comparison_parts import (
    PageKind,
    build_criteria_sections,
    clean_model,
    format_range,
    list_remarks,
)
from pantocheck.conformance.pages.pantograph_pages import RESPONSE_PAGE
from pantocheck.conformance.pages.static_sections import STATIC_PAGE
from pantocheck.conformance.pages.words import format_plain, format_value
from pantocheck.conformance.results.comparison_format import ModelComparison, ResponseComparison, StaticComparison
from pantocheck.conformance.results.drop_comparison_format import (
    ComparedModel,
    ComparedPlace,
    DropComparison,
    EnergyCurve,
    ModelAgreement,
    MotionCurve,
    WindowStatistics,
)


# Page of a drop comparison: motion, residual energy and a table of all bands for each place.
def _build_opening(comparison: DropComparison) -> tuple[doc.Block, ...]:
    drop = comparison.drop
    planned = drop.planned_release_s
    facts = {
        "Mass": f"{format_plain(drop.mass_kg)} kg on {drop.wire} at {format_plain(drop.position_m)} m",
        "Release": f"at {drop.release_s:.4f} s of the record, where the first model fits best "
        f"(correlation {drop.release_correlation:.4f})",
        "Planned release": None if planned is None else f"{format_plain(planned)} s",
        "Duration of the release": f"{format_plain(drop.release_duration_s)} s",
        "Line of the record": comparison.line_comparison.state,
        "Element length and time step": f"{format_plain(comparison.element_m)} m, "
        f"{format_plain(comparison.time_step_s)} s",
        "Digest of the line": comparison.model.digest,
        "Digest of the record": comparison.record.digest,
        "Digest of the suite": comparison.suite.digest,
    }
    return (doc.select_facts(facts), _build_model_table(comparison.models))


def _build_model_table(models: tuple[ComparedModel, ...]) -> doc.Table:
    return doc.make_table(
        models,
        {
            doc.Column("Model"): lambda model: model.name,
            doc.Column("Source", share=1): lambda model: model.source,
            doc.Column("Last slack dropper [s]", number=True): lambda model: format_value(model.last_slack_s, 3),
        },
        "Damping models",
    )


def _build_place(place: ComparedPlace, comparison: DropComparison) -> doc.Section:
    """Section of a sensor or of the mass: motion in every window, residual energy, table of all bands."""
    name = place.name
    where = f"{place.wire} at {format_plain(place.position_m)} m"
    energy = next(item for item in comparison.energies if item.place == name)
    figures = [
        doc.Figure(
            draw_drop_motion([curve for curve in comparison.curves if (curve.place, curve.window_s) == (name, window)]),
            f"Velocity and acceleration of {name}, {format_range(window)} s after the release.",
            f"Velocity and acceleration of {name} up to 20 Hz, {format_range(window)} s after the release.",
        )
        for window in comparison.windows_s
    ]
    figures.append(
        doc.Figure(
            draw_residual_energy(energy, comparison.models[0].name),
            f"Mean square of the velocity of {name} against time.",
            f"Residual energy of {name}: mean square of the velocity up to 20 Hz in windows of two seconds.",
        )
    )
    rows = [row for row in comparison.statistics if row.place == name]
    heading = f"Mass, {where}" if place.sensor is None else f"{name}, {where}"
    return doc.Section(heading, (doc.Figures(tuple(figures)), _build_statistics_table(rows)))


def _build_statistics_table(rows: list[WindowStatistics]) -> doc.Table:
    """RMS, ratio and correlation of each model; one row per motion, window, band and model."""
    records: list[tuple[WindowStatistics, ModelAgreement]] = [(row, model) for row in rows for model in row.models]
    cells = {
        "Motion": lambda pair: pair[0].motion,
        "Window [s]": lambda pair: format_range(pair[0].window_s),
        "Band [Hz]": lambda pair: format_range(pair[0].band_Hz),
        "Record": lambda pair: format_value(pair[0].record_rms),
        "Noise": lambda pair: format_value(pair[0].noise_rms, 2),
        "Model": lambda pair: format_value(pair[1].rms),
        "Ratio": lambda pair: format_value(pair[1].rms_ratio),
        "Correlation": lambda pair: format_value(pair[1].correlation),
        "Damping": lambda pair: pair[1].model,
    }
    return doc.make_grid("RMS of record, noise and model [m/s, m/s²]; ratio and correlation", records, cells)


DROP_PAGE: PageKind[DropComparison] = PageKind(
    heading="Mass drop: record and simulation",
    statement="self-declared comparison with a recorded mass drop",
    headlines={
        "pass": "The graded agreement of model and record lies within the limits of the user.",
        "unconfirmed": "The graded agreement lies within the limits; the record does not state its line completely.",
        "fail": "The agreement of model and record lies outside a limit of the user.",
        "skip": "The record does not contain all data that the limits need.",
        "info": "No limit was given: the agreement is shown and not graded.",
    },
    scope=(
        "The recorded drop was simulated with the damping of each model. The limits are those of the user, not of a "
        "standard; they grade the first model. An RMS ratio is the RMS of the model over that of the record without "
        "its noise; 1 means agreement, and a dash too much noise. A small error of a frequency lowers the correlation "
        "in a late window, but not the RMS ratio. Velocities contain frequencies from 0.3 Hz only."
    ),
    describe=lambda comparison: (
        f"Line: {comparison.model.name}. Record: {comparison.record.name} ({comparison.record.source})."
    ),
    label=lambda comparison: comparison.record.name,
    opening=_build_opening,
    sections=lambda comparison: tuple(_build_place(place, comparison) for place in comparison.places),
)


RECORD_WIDTH = 2.2
"""Width of the pale line of the record [pt]; the lines of the models lie on it."""


@render_svg
def draw_drop_motion(curves: Sequence[MotionCurve]) -> Figure:
    """Velocity and acceleration of one place in every window."""
    figure = Figure(figsize=(FULL, 0.6 + 1.7 * len(curves)))
    panels = np.atleast_1d(figure.subplots(len(curves), 1))
    for axes, curve in zip(panels, curves, strict=True):
        if curve.record is not None:
            axes.plot(curve.time_s, curve.record, color=SHADES[3], linewidth=RECORD_WIDTH, label="record")
        _plot_models(axes, curve.time_s, curve.models)
        unit = "m/s" if curve.motion == "velocity" else "m/s²"
        axes.set_ylabel(f"{curve.motion} [{unit}]")
        axes.margins(x=0)
    panels[-1].set_xlabel("time after the release [s]")
    add_legend(panels[0])
    return figure


@render_svg
def draw_residual_energy(energy: EnergyCurve, graded: str) -> Figure:
    """Mean square of the velocity against time, and of the difference of the graded model."""
    figure = Figure(figsize=(FULL, 2.4))
    axes = figure.subplots()
    if energy.record is not None:
        axes.plot(energy.time_s, energy.record, color=SHADES[3], linewidth=RECORD_WIDTH, label="record")
    _plot_models(axes, energy.time_s, energy.models)
    if graded in energy.differences:
        label = f"{graded} − record"
        axes.plot(energy.time_s, energy.differences[graded], ":", color=GREY, linewidth=1.0, label=label)
    use_decades(axes)
    axes.margins(x=0)
    axes.set(xlabel="time after the release [s]", ylabel="mean square [m²/s²]")
    add_legend(axes)
    return figure


def _plot_models(axes: Axes, time: Sequence[float], models: Mapping[str, Sequence[float]]) -> None:
    for number, (name, values) in enumerate(models.items()):
        style, shade = LINES[number % len(LINES)], (INK, *SHADES[1:3])[number % 3]
        axes.plot(time, values, style, color=shade, linewidth=0.8, label=name)


# Page of any comparison.
PAGES: dict[type[ModelComparison], PageKind[Any]] = {
    StaticComparison: STATIC_PAGE,
    ResponseComparison: RESPONSE_PAGE,
    DropComparison: DROP_PAGE,
}
"""Texts and blocks of the page by kind of comparison."""


def find_headline(comparison: ModelComparison) -> str:
    """Verdict of a comparison in a sentence."""
    return PAGES[type(comparison)].headlines[comparison.verdict]


def build_comparison(comparison: ModelComparison) -> doc.Document:
    """Compose the page of a comparison."""
    kind, comparison = PAGES[type(comparison)], clean_model(comparison)
    suite = f"Pantocheck {comparison.suite.version}"
    header = doc.VerdictHeader(
        kind.heading,
        comparison.verdict,
        kind.statement,
        kind.headlines[comparison.verdict],
        f"{kind.describe(comparison)} {suite}.",
        f"{suite} · {kind.label(comparison)}",
    )
    blocks: tuple[doc.Block, ...] = (
        *doc.warn(list_remarks(comparison)),
        *(doc.Paragraph(kind.scope), *kind.opening(comparison), *build_criteria_sections(comparison.criteria)),
        *(*kind.sections(comparison), *kind.closing(comparison)),
    )
    return doc.Document(header.heading, header, blocks)

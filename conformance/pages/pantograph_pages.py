"""Pages on a pantograph: measured responses beside its model, and the fit of a chain to them."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.figure_style import (
    FULL,
    GREY,
    INK,
    LIMIT_LINE,
    SHADES,
    add_legend,
    label_decades,
    new_figure,
    render_svg,
)
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.comparison_parts import PageKind, clean_model, format_range
from pantocheck.conformance.pages.words import format_plain, format_value
from pantocheck.conformance.results.comparison_format import (
    BandDeviation,
    ComparedResponse,
    ResponseComparison,
    ResponseQuantity,
)
from pantocheck.conformance.results.pantograph_fit_format import ChainParameter, PantographFit
from pantocheck.conformance.results.supported_frequency import UNKNOWN_FREQUENCY

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Limits = Sequence[Criterion]

DRAWN_ROWS = 400
"""Largest number of drawn rows, two per millimetre of a figure; the numbers contain all rows."""

FREQUENCY_TICKS = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200)


@render_svg
def draw_response(response: ComparedResponse, limits: Limits) -> "Figure":
    """Modulus and phase of measurement and model over the frequency; below, deviations and limits by row and band."""
    from matplotlib.ticker import MultipleLocator

    figure = new_figure(FULL, 4.6)
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


def _draw_deviations(axes: "Axes", response: ComparedResponse, limits: Limits, rows: list[int]) -> None:
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


def _label_moduli(axes: "Axes") -> None:
    """A logarithmic modulus axis: plain numbers over two decades or less, otherwise powers of ten."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axes.set_yscale("log")
    low, high = axes.get_ylim()
    if high / low > 100:
        label_decades(axes.yaxis)
        return
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())


def _label_frequencies(axes: "Axes", frequency: Sequence[float]) -> None:
    """A logarithmic frequency axis with plain numbers."""
    from matplotlib.ticker import NullFormatter

    axes.set_xscale("log")
    axes.set_xlim(frequency[0], frequency[-1])
    axes.set_xticks([tick for tick in FREQUENCY_TICKS if frequency[0] <= tick <= frequency[-1]])
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())


# Page of a response comparison: figure and table of the bands of each response.
def build_response_sections(comparison: ResponseComparison) -> tuple[doc.Section, ...]:
    """Section of each response, with its figure and its bands."""
    return tuple(_build_section(response, comparison.criteria) for response in comparison.responses)


def _describe(comparison: ResponseComparison) -> str:
    count = len(comparison.responses)
    return f"Pantograph: {comparison.model.name}. {count} measured response{'s' if count > 1 else ''}."


def _build_closing(comparison: ResponseComparison) -> tuple[doc.Block, ...]:
    highest = comparison.supported_to_Hz
    facts = {
        "Supported up to": UNKNOWN_FREQUENCY if highest is None else f"{highest:.3g} Hz",
        "Digest of the pantograph": comparison.model.digest,
        "Digest of the suite": comparison.suite.digest,
    }
    return (doc.select_facts(facts),)


def _build_section(response: ComparedResponse, criteria: tuple[Criterion, ...]) -> doc.Section:
    limits = [
        item for item in criteria if item.where.record == response.name and item.quantity == "complex_deviation_pct"
    ]
    kind = response.kind.replace("_", " ")
    figure = doc.Figure(
        draw_response(response, limits),
        f"Modulus and phase of the {kind} of {response.name}, measured and of the model, and their deviation.",
        f"{response.name}: {kind} at the head, measured and of the model, and the deviation of the model.",
    )
    points = [point.replace("_", " ") for point in (response.excited_at, response.measured_at)]
    facts = {
        "Source": response.source,
        "Force and motion": f"{points[0]} and {points[1]}",
        "Measured values": str(len(response.row)),
        "Digest of the record": response.digest,
        "Note": response.note,
    }
    height = "" if response.height_m is None else f", {format_plain(response.height_m)} m"
    informative = "" if response.is_graded else " (informative)"
    heading = f"{response.name}: {format_plain(response.static_force_N)} N{height}{informative}"
    return doc.Section(heading, (doc.Figures((figure,)), _build_band_table(response.bands), doc.select_facts(facts)))


def _build_band_table(bands: tuple[BandDeviation, ...]) -> doc.Table:
    """RMS and largest deviations of each band."""

    def value(key: ResponseQuantity, band: BandDeviation) -> str:
        deviation, error = band.deviations.get(key), band.uncertainty.get(key)
        return format_value(deviation, 3) + ("" if error is None else f" ± {format_value(error, 2)}")

    def largest(key: ResponseQuantity, frequency: float | None, band: BandDeviation) -> str:
        return (
            "–" if frequency is None else f"{format_value(band.deviations[key], 3)} at {format_value(frequency, 3)} Hz"
        )

    cells = {
        "Band [Hz]": lambda band: format_range(band.band_Hz),
        "Values": lambda band: str(band.rows),
        "Modulus [%]": lambda band: value("modulus_deviation_pct", band),
        "Phase [°]": lambda band: value("phase_deviation_deg", band),
        "Complex [%]": lambda band: value("complex_deviation_pct", band),
        "Largest, modulus [%]": lambda band: largest("largest_modulus_deviation_pct", band.largest_modulus_at_Hz, band),
        "Largest, phase [°]": lambda band: largest("largest_phase_deviation_deg", band.largest_phase_at_Hz, band),
        "Beyond uncertainty [%]": lambda band: format_value(band.beyond_uncertainty_pct, 3),
        "Missing": lambda band: band.missing or "–",
    }
    return doc.make_grid("RMS and largest deviations by band", bands, cells)


RESPONSE_PAGE: PageKind[ResponseComparison] = PageKind(
    heading="Pantograph: measured response and model",
    statement="self-declared comparison with measured frequency responses",
    headlines={
        "pass": "The graded deviations of the pantograph model lie within the limits of the user.",
        "fail": "A deviation of the pantograph model exceeds a limit of the user.",
        "skip": "The responses do not contain all data that the limits need.",
        "info": "No limit was given: the deviations are shown and not graded.",
    },
    scope=(
        "Response of the pantograph model at the centre of its head, with a fixed base, beside measured responses. The "
        "limits are those of the user, not of a standard. The model is linear: friction and stops have no part in it, "
        "and static force and height do not change its response. A deviation is the logarithm of the dynamic stiffness "
        "of the model over the measured one: its real part is the relative deviation of the modulus, its imaginary "
        "part that of the phase, and the complex deviation joins both. It has the same size for every kind of "
        "response. Responses at single contact strips are informative. The records are unconfirmed: a frequency "
        "response has no second channel that could confirm it."
    ),
    describe=_describe,
    label=lambda comparison: comparison.model.name,
    opening=lambda comparison: (),
    sections=build_response_sections,
    closing=_build_closing,
)


# Report on a fitted pantograph, from its JSON file.
PARAMETER_NAMES = {
    "masses_kg": ("Mass", "kg"),
    "stiffness_N_m": ("Stiffness", "N/m"),
    "damping_N_s_m": ("Damping", "N s/m"),
}
FIT_SCOPE = (
    "Chain of lumped masses fitted to measured responses at the head by bounded least squares. The residuals are the "
    "logarithms of the dynamic stiffness of the chain over the measured one, weighted by the uncertainty of the "
    "measurement. Intervals hold at 95 % for independent deviations of the rows. An error that all rows share is no "
    "part of them: a gain error of 1 % changes every mass, stiffness and damping by 1 %. Element n connects mass n "
    "with mass n - 1, element 1 connects mass 1 with the base."
)


def build_pantograph_fit_document(results: PantographFit) -> doc.Document:
    """The report on the content of the JSON file of a fit."""
    results = clean_model(results)
    deviation = next(item.complex_deviation_pct for item in results.candidates if item.masses == results.masses)
    headline = (
        f"{results.title}: chain of {results.masses} masses, RMS deviation {format_value(deviation, 3)} % from "
        f"{format_value(results.band_Hz[0], 3)} to {format_value(results.band_Hz[1], 3)} Hz."
    )
    blocks: list[doc.Block] = [
        *doc.warn(results.warnings),
        doc.Paragraph(FIT_SCOPE),
        doc.Section("Parameters", (_build_parameter_table(results.parameters), *_build_correlations(results))),
        doc.Section("Number of masses", (_build_candidate_table(results), doc.Facts(_list_facts(results)))),
        *build_response_sections(results.comparison),
    ]
    return doc.build_plain_document("Pantograph from measured responses", headline, blocks)


def _build_parameter_table(parameters: tuple[ChainParameter, ...]) -> doc.Table:
    columns = (
        doc.Column("Parameter"),
        doc.Column("Value", number=True),
        doc.Column("± 95 %", number=True),
        doc.Column("± 95 % [%]", number=True),
        doc.Column("Determined by the band", share=1),
    )
    rows: list[tuple[doc.RichText, ...]] = []
    for item in parameters:
        name, unit = PARAMETER_NAMES[item.key]
        share = 100 * item.half_width / item.value if item.value else None
        width = ("–", "–") if item.determination == "fixed" else _format_width(item.half_width, share)
        state = item.determination.replace("_", " ")
        rows.append((f"{name} {item.number} [{unit}]", _format_plainly(item.value, 4), *width, state))
    return doc.Table(columns, tuple(rows))


def _format_width(half_width: float, share: float | None) -> tuple[str, str]:
    return _format_plainly(half_width, 2), "–" if share is None or share > 1000 else _format_plainly(share, 2)


def _format_plainly(value: float, digits: int) -> str:
    """Number with significant digits and without a power of ten."""
    return format_plain(float(f"{value:.{digits}g}"))


def _build_correlations(results: PantographFit) -> tuple[doc.Block, ...]:
    """Sentence on parameters that the band hardly distinguishes."""
    pairs = "; ".join(
        f"{pair.first} and {pair.second} ({format_value(pair.correlation, 3)})" for pair in results.correlations
    )
    return (doc.SmallPrint(f"Correlated parameters: {pairs}."),) if pairs else ()


def _build_candidate_table(results: PantographFit) -> doc.Table:
    cells = {
        "Masses": lambda item: f"{item.masses}{' (chosen)' if item.masses == results.masses else ''}",
        "Free parameters": lambda item: str(item.free_parameters),
        "RMS deviation [%]": lambda item: format_value(item.complex_deviation_pct, 3),
        "Variance ratio": lambda item: format_value(item.variance_ratio, 3),
        "Information criterion": lambda item: format_value(item.information_criterion),
        "Starts in this minimum": lambda item: f"{item.best_starts} of {item.starts}",
    }
    caption = "The lowest information criterion is the best; a variance ratio of 1 is noise alone"
    return doc.make_grid(caption, results.candidates, cells)


def _list_facts(results: PantographFit) -> tuple[tuple[str, str], ...]:
    frequencies = ", ".join(format_value(value) for value in results.natural_frequencies_Hz)
    return (
        ("Natural frequencies, undamped, head free", f"{frequencies} Hz"),
        ("Measured values in the fit", format_plain(results.rows)),
        ("Uncertainty of the measurement", "stated" if results.is_noise_stated else "not stated"),
        ("Digest of the suite", results.suite.digest),
    )

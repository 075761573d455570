"""Report on a fitted pantograph, from its JSON file."""

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.comparison_parts import clean_model
from pantocheck.conformance.pages.response_sections import build_response_sections
from pantocheck.conformance.pages.words import format_plain, format_value
from pantocheck.conformance.results.pantograph_fit_format import ChainParameter, PantographFit

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
    header = doc.PlainHeader("Pantograph from measured responses", headline)
    blocks: list[doc.Block] = [doc.WarningBox(tuple(results.warnings))] if results.warnings else []
    blocks += [
        doc.Paragraph(FIT_SCOPE),
        doc.Section("Parameters", (_build_parameter_table(results.parameters), *_build_correlations(results))),
        doc.Section("Number of masses", (_build_candidate_table(results), doc.Facts(_list_facts(results)))),
        *build_response_sections(results.comparison),
    ]
    return doc.Document(header.heading, header, tuple(blocks))


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

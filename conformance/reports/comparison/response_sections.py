"""Page of a response comparison: figure and table of the bands of each response."""

from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.comparison.comparison_parts import PageKind, format_range, select_facts
from pantocheck.conformance.reports.figures.response_figure import draw_response
from pantocheck.conformance.reports.page_text import format_plain, format_value
from pantocheck.conformance.results.comparison_format import (
    BandDeviation,
    ComparedResponse,
    ComparisonCriterion,
    ResponseComparison,
    ResponseQuantity,
)


def build_response_sections(comparison: ResponseComparison) -> tuple[doc.Section, ...]:
    """Section of each response, with its figure and its bands."""
    return tuple(_build_section(response, comparison.criteria) for response in comparison.responses)


def _describe(comparison: ResponseComparison) -> str:
    count = len(comparison.responses)
    return f"Pantograph: {comparison.model.name}. {count} measured response{'s' if count > 1 else ''}."


def _build_closing(comparison: ResponseComparison) -> tuple[doc.Block, ...]:
    facts = {
        "Digest of the pantograph": comparison.model.digest,
        "Digest of the suite": comparison.suite.digest,
    }
    return (select_facts(facts),)


def _build_section(response: ComparedResponse, criteria: tuple[ComparisonCriterion, ...]) -> doc.Section:
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
    return doc.Section(heading, (doc.Figures((figure,)), _build_band_table(response.bands), select_facts(facts)))


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
        "response. Responses at single contact strips are informative. The records are unverified: a frequency "
        "response has no second channel that could confirm it."
    ),
    describe=_describe,
    label=lambda comparison: comparison.model.name,
    opening=lambda comparison: (),
    sections=build_response_sections,
    closing=_build_closing,
)

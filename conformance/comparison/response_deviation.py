"""Deviation of a modelled frequency response from a measured one, by frequency band, and its criteria.

The deviation at a frequency is e = ln(D_model / D_measured), with the dynamic stiffness D. Its real part is the
relative deviation of the modulus, its imaginary part that of the phase in radians; |e| joins both. The logarithm gives
the same size for every kind of response, because the kinds differ by a power of i omega or are inverse to each other. A
mean over a band weighs each frequency by its share of the logarithmic frequency axis, so that the spacing of the rows
has no effect.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from pantocheck.conformance.comparison.comparison_limits import ComparisonLimit, grade_difference
from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.criterion import Criterion, CriterionPlace
from pantocheck.conformance.core.validation_messages import name_rows
from pantocheck.conformance.pantograph.response_record import ResponseRecord, ResponseUncertainty
from pantocheck.conformance.results.comparison_format import BandDeviation, ResponseQuantity

ResponseBand = tuple[float, float]

LARGEST_FREQUENCY_RATIO = 1.2
"""Largest ratio of neighbouring frequencies in a complete band: the half-power width of a mode with a damping ratio of
0.1, which would be missed with fewer rows."""

GradedResponse = tuple[ResponseRecord, Mapping[ResponseBand, BandDeviation]]
"""Record, and its deviations by band."""


def response_deviation(model: ComplexArray, measured: ComplexArray) -> ComplexArray:
    """Deviation ln(D_model / D_measured); NaN where the measured value is missing."""
    deviation = np.full(measured.size, np.nan, dtype=np.complex128)
    present = np.isfinite(measured)
    deviation[present] = np.log(model[present] / measured[present])
    return deviation


def summarise_band(record: ResponseRecord, deviation: ComplexArray, band: ResponseBand) -> BandDeviation:
    """Summarise the deviations in a band.

    Args:
        record: Measured response.
        deviation: Deviation of each row, from `response_deviation`, (n,); NaN: no measured value.
        band: Edges of the band, both included [Hz].

    Returns:
        Deviations, their uncertainty, and missing data.
    """
    inside = (record.frequency >= band[0]) & (record.frequency <= band[1])
    present = inside & np.isfinite(deviation)
    missing = _find_missing_data(record, band, inside, present)
    if not present.any():
        return BandDeviation(
            band_Hz=band, rows=0, missing=missing, deviations={}, uncertainty={},
            largest_modulus_at_Hz=None, largest_phase_at_Hz=None, beyond_uncertainty_pct=None,
        )  # fmt: skip
    frequency, modulus, phase = record.frequency[present], deviation[present].real, deviation[present].imag
    weights = band_weights(frequency, band)
    errors = _select_rows(record.uncertainty, present)
    return BandDeviation(
        band_Hz=band,
        rows=int(present.sum()),
        missing=missing,
        deviations=_deviation_norms(modulus, phase, weights),
        # Both norms obey the triangle inequality: an error of the measurement changes them by its own norm at most.
        uncertainty={} if errors is None else _deviation_norms(errors.modulus, errors.phase, weights),
        largest_modulus_at_Hz=float(frequency[np.argmax(np.abs(modulus))]),
        largest_phase_at_Hz=float(frequency[np.argmax(np.abs(phase))]),
        beyond_uncertainty_pct=None if errors is None else 100 * _share_beyond(modulus, phase, errors),
    )


LARGEST_SUPPORTED_DEVIATION = 0.2
"""Complex deviation, RMS of a third of an octave, with which a response supports a model: that of a line test."""


def find_supported_frequency(frequency: RealArray, deviation: ComplexArray) -> float | None:
    """Highest frequency up to which a response supports the model [Hz]; None: not even in its first third of an octave.

    Thirds of an octave follow each other from the lowest row on; a third without a row, or with a larger deviation,
    ends the supported range.

    Args:
        frequency: Frequency of each row with a measured value, increasing, (n,) [Hz].
        deviation: Deviation of each row, (n,).
    """
    highest, edge, third = None, float(frequency[0]), 2 ** (1 / 3)
    while edge < frequency[-1]:
        upper = min(edge * third, float(frequency[-1]))
        inside = (frequency >= edge) & (frequency <= upper)
        if not inside.any() or np.sqrt(np.mean(np.abs(deviation[inside]) ** 2)) > LARGEST_SUPPORTED_DEVIATION:
            break
        highest = edge = upper
    return highest


def band_weights(frequency: RealArray, band: ResponseBand) -> RealArray:
    """Share of the logarithmic axis of a band that is nearest to each frequency, (n,) ndarray with the sum 1."""
    log = np.log(frequency)
    edges = np.concatenate(([np.log(band[0])], (log[1:] + log[:-1]) / 2, [np.log(band[1])]))
    return np.asarray(np.diff(edges) / (edges[-1] - edges[0]))


def _deviation_norms(modulus: RealArray, phase: RealArray, weights: RealArray) -> dict[ResponseQuantity, float]:
    """RMS over the band and largest value of the deviations [%, degrees]."""
    return {
        "modulus_deviation_pct": 100 * float(np.sqrt(weights @ modulus**2)),
        "phase_deviation_deg": float(np.degrees(np.sqrt(weights @ phase**2))),
        "complex_deviation_pct": 100 * float(np.sqrt(weights @ (modulus**2 + phase**2))),
        "largest_modulus_deviation_pct": 100 * float(np.abs(modulus).max()),
        "largest_phase_deviation_deg": float(np.degrees(np.abs(phase).max())),
    }


def _select_rows(uncertainty: ResponseUncertainty | None, rows: np.ndarray) -> ResponseUncertainty | None:
    return None if uncertainty is None else ResponseUncertainty(uncertainty.modulus[rows], uncertainty.phase[rows])


def _share_beyond(modulus: RealArray, phase: RealArray, errors: ResponseUncertainty) -> float:
    """Share of the deviations of modulus and phase that exceed their uncertainty."""
    beyond = np.concatenate((np.abs(modulus) > errors.modulus, np.abs(phase) > errors.phase))
    return float(beyond.mean())


def _find_missing_data(
    record: ResponseRecord, band: ResponseBand, inside: np.ndarray, present: np.ndarray
) -> str | None:
    """Data that a complete band needs and the record does not have; None if it is complete."""
    if (lost := np.sort(record.row[inside & ~present])).size:
        return f"no value in {name_rows(lost)}"
    steps = np.concatenate(([band[0]], record.frequency[present], [band[1]]))
    widest = int(np.argmax(steps[1:] / steps[:-1]))
    low, high = steps[widest], steps[widest + 1]
    if high / low > LARGEST_FREQUENCY_RATIO:
        return (
            f"no measured value between {low:.4g} and {high:.4g} Hz; neighbouring frequencies may differ by the factor "
            f"{LARGEST_FREQUENCY_RATIO:g}"
        )
    return None


def grade_responses(limits: Sequence[ComparisonLimit], responses: Sequence[GradedResponse]) -> tuple[Criterion, ...]:
    """Grade the responses at the centre of the head by every limit.

    Args:
        limits: Limits of the user.
        responses: Records with their deviations.

    Returns:
        One criterion per limit and response; one that is skipped for each load level or height without a response.
    """
    at_head = [response for response in responses if response[0].sidecar.is_at_head]
    return tuple(criterion for limit in limits for criterion in _grade_limit(limit, at_head))


def _grade_limit(limit: ComparisonLimit, responses: Sequence[GradedResponse]) -> Iterator[Criterion]:
    band = limit.band_Hz or (0.0, 0.0)
    for force in limit.static_forces_N or ():
        loaded = [response for response in responses if response[0].sidecar.static_force_N == force]
        for height in limit.heights_m or (None,):
            found = [item for item in loaded if height is None or item[0].sidecar.height_m == height]
            if not found:
                place = "" if height is None else f" at {height:g} m"
                yield grade_difference(
                    limit,
                    None,
                    CriterionPlace(static_force_N=force, height_m=height, band_Hz=band),
                    missing=f"no response at the centre of the head under {force:g} N{place}",
                    source=limit.source,
                )
            for record, bands in found:
                deviation, measured_at = bands[band], record.sidecar.height_m
                yield grade_difference(
                    limit,
                    _select_value(deviation.deviations, limit),
                    CriterionPlace(record=record.source, static_force_N=force, height_m=measured_at, band_Hz=band),
                    missing=deviation.missing,
                    measurement=_select_value(deviation.uncertainty, limit),
                    source=limit.source,
                )


def _select_value(values: Mapping[ResponseQuantity, float], limit: ComparisonLimit) -> float | None:
    return next((value for name, value in values.items() if name == limit.quantity), None)

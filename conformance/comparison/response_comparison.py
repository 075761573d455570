"""Comparison of a pantograph with frequency responses measured at its head."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from pantocheck.conformance.cases.case import json_digest
from pantocheck.conformance.comparison.comparison_limits import RESPONSE_BANDS, ComparisonLimit, grade_difference
from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.criterion import Criterion, CriterionPlace
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.validation_messages import name_rows
from pantocheck.conformance.core.verdicts import worst_verdict
from pantocheck.conformance.grading.results_building import build_suite
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import head_receptance
from pantocheck.conformance.pantograph.response_record import (
    RESPONSE_FORMS,
    ResponseForm,
    ResponseRecord,
    ResponseUncertainty,
)
from pantocheck.conformance.results.comparison_format import (
    BandDeviation,
    ComparedResponse,
    ComparedSource,
    HeadResponse,
    ResponseComparison,
    ResponseQuantity,
)

# Deviation of a modelled frequency response from a measured one, by frequency band, and its criteria.
#
# The deviation at a frequency is e = ln(D_model / D_measured), with the dynamic stiffness D. Its real part is the
# relative deviation of the modulus, its imaginary part that of the phase in radians; |e| joins both. The logarithm
# gives the same size for every kind of response, because the kinds differ by a power of i omega or are inverse to each
# other. A mean over a band weighs each frequency by its share of the logarithmic frequency axis, so that the spacing of
# the rows has no effect.


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


LARGEST_MODULUS_RATIO = 5.0
"""Median ratio of the moduli from which the unit is refused: the smallest ratio of two units is 9.8, of g to m/s2."""

FREQUENCIES_AT_ONCE = 64
"""Frequencies whose matrices are solved together: 40 MB for a pantograph with 200 modes."""

MODEL_CURVE_POINTS = 400
"""Frequencies of the curve of the model, two per millimetre of a figure."""


def compare_responses(
    records: Sequence[ResponseRecord], pantograph: PantographFile, limits: Sequence[ComparisonLimit] = ()
) -> ResponseComparison:
    """Compare a pantograph with measured responses.

    Args:
        records: Measured responses, from `read_response`; at least one.
        pantograph: Content of the pantograph file.
        limits: Limits of the user; without any, the deviations are not graded.

    Returns:
        Content of response_comparison.json.

    Raises:
        InputError: A record occurs twice, or is evidently in another unit.
    """
    _refuse_repeated_records(records)
    deviations = [_deviate(record, pantograph) for record in records]
    bands = [
        {band: summarise_band(record, deviation, band) for band in RESPONSE_BANDS}
        for record, deviation in zip(records, deviations, strict=True)
    ]
    criteria = grade_responses(limits, list(zip(records, bands, strict=True)))
    responses = tuple(
        _describe_response(record, deviation, tuple(by_band.values()), pantograph)
        for record, deviation, by_band in zip(records, deviations, bands, strict=True)
    )
    return ResponseComparison(
        suite=build_suite(),
        model=ComparedSource(name=pantograph.title, digest=json_digest(pantograph.model_dump(mode="json"))),
        verdict=worst_verdict(criterion.verdict for criterion in criteria),
        responses=responses,
        criteria=criteria,
        warnings=tuple(_list_warnings(responses, criteria)),
    ).rounded()


def model_stiffness(pantograph: PantographFile, frequency: RealArray) -> ComplexArray:
    """Dynamic stiffness of the head of a pantograph with a fixed base [N/m] at frequencies [Hz], in closed form.

    The models of pantograph files are linear: static force and height of the head do not change the response.
    """
    blocks = np.array_split(2 * np.pi * frequency, -(-frequency.size // FREQUENCIES_AT_ONCE))
    return np.concatenate([1 / head_receptance(pantograph, omega) for omega in blocks])


def _refuse_repeated_records(records: Sequence[ResponseRecord]) -> None:
    digest, times = Counter(record.digest for record in records).most_common(1)[0]
    if times > 1:
        source = next(record.source for record in records if record.digest == digest)
        raise InputError(f"record '{source}'", f"is given {times} times", "Give each response once.")


def _deviate(record: ResponseRecord, pantograph: PantographFile) -> ComplexArray:
    """Deviation of each row; refuse a response that is evidently in another unit."""
    deviation = response_deviation(model_stiffness(pantograph, record.frequency), record.stiffness)
    median = RESPONSE_FORMS[record.sidecar.kind].stiffness_power * float(-np.nanmedian(deviation.real))
    if abs(median) > np.log(LARGEST_MODULUS_RATIO):
        raise InputError(
            f"record '{record.source}'",
            f"the median of the modulus is {np.exp(median):.3g} times that of the pantograph",
            "Check the unit at the end of the column, the key kind and the key scale of the sidecar.",
        )
    return deviation


def _describe_response(
    record: ResponseRecord, deviation: ComplexArray, bands: tuple[BandDeviation, ...], pantograph: PantographFile
) -> ComparedResponse:
    """Part of the report on one response."""
    sidecar, present = record.sidecar, np.isfinite(deviation)
    form, frequency, deviation = RESPONSE_FORMS[sidecar.kind], record.frequency[present], deviation[present]
    errors = record.uncertainty
    model = model_stiffness(pantograph, frequency)
    curve_frequency = np.geomspace(frequency[0], frequency[-1], MODEL_CURVE_POINTS)
    curve = model_stiffness(pantograph, curve_frequency)
    measured_phase = _passive_phase(model) - deviation.imag
    return ComparedResponse(
        name=record.source,
        digest=record.digest,
        kind=sidecar.kind,
        unit=form.symbol,
        static_force_N=sidecar.static_force_N,
        height_m=sidecar.height_m,
        excited_at=sidecar.excited_at,
        measured_at=sidecar.measured_at,
        is_graded=sidecar.is_at_head,
        source=sidecar.source,
        note=sidecar.note,
        row=tuple(map(int, record.row[present])),
        missing_rows=tuple(map(int, np.sort(record.row[~present]))),
        measured=_build_curve(form, frequency, record.stiffness[present], measured_phase),
        modulus_uncertainty_pct=() if errors is None else tuple(100 * errors.modulus[present]),
        phase_uncertainty_deg=() if errors is None else tuple(np.degrees(errors.phase[present])),
        modulus_deviation_pct=tuple(100 * deviation.real),
        phase_deviation_deg=tuple(np.degrees(deviation.imag)),
        model=_build_curve(form, curve_frequency, curve, _passive_phase(curve)),
        bands=bands,
        supported_to_Hz=find_supported_frequency(frequency, deviation),
    )


def _passive_phase(stiffness: ComplexArray) -> RealArray:
    """Phase of the dynamic stiffness of a model, 0 to pi; without damping, rounding decides the sign of its sine."""
    return np.arctan2(np.abs(stiffness.imag), stiffness.real)


def _build_curve(
    form: ResponseForm, frequency: RealArray, stiffness: ComplexArray, stiffness_phase: RealArray
) -> HeadResponse:
    """Response of a form as modulus and phase."""
    return HeadResponse(
        frequency_Hz=tuple(frequency),
        modulus=tuple(np.abs(form.from_stiffness(stiffness, frequency))),
        phase_deg=tuple(np.degrees(form.shift_phase(stiffness_phase))),
    )


def _list_warnings(responses: Sequence[ComparedResponse], criteria: Sequence[Criterion]) -> Iterator[str]:
    """Caveats: informative responses, missing uncertainty and rows, responses without a limit."""
    graded = {criterion.where.record for criterion in criteria}
    for response in responses:
        if not response.is_graded:
            yield (
                f"{response.name}: excited at {_in_words(response.excited_at)}, measured at "
                f"{_in_words(response.measured_at)}: informative, because the model has one point of the head"
            )
        elif criteria and response.name not in graded:
            yield f"{response.name}: no limit names its static force and height, so that it is not graded"
        if not response.modulus_uncertainty_pct:
            yield f"{response.name}: the sidecar states no uncertainty of the measurement"
        if response.missing_rows:
            yield f"{response.name}: {count_noun(len(response.missing_rows), 'row')} without a value"


def _in_words(point: str) -> str:
    return "another point" if point == "other" else f"the {point.replace('_', ' ')}"

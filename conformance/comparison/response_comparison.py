"""Comparison of a pantograph with frequency responses measured at its head."""

from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from pantocheck.conformance.cases.case import json_digest
from pantocheck.conformance.comparison.comparison_limits import RESPONSE_BANDS, ComparisonLimit
from pantocheck.conformance.comparison.response_deviation import (
    find_supported_frequency,
    grade_responses,
    response_deviation,
    summarise_band,
)
from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.verdicts import worst_verdict
from pantocheck.conformance.grading.results_building import build_suite
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import head_receptance
from pantocheck.conformance.pantograph.response_record import RESPONSE_FORMS, ResponseForm, ResponseRecord
from pantocheck.conformance.results.comparison_format import (
    BandDeviation,
    ComparedResponse,
    ComparedSource,
    HeadResponse,
    ResponseComparison,
)

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
        model=_build_model_curve(form, curve_frequency, model_stiffness(pantograph, curve_frequency)),
        bands=bands,
        supported_to_Hz=find_supported_frequency(frequency, deviation),
    )


def _build_model_curve(form: ResponseForm, frequency: RealArray, stiffness: ComplexArray) -> HeadResponse:
    return _build_curve(form, frequency, stiffness, _passive_phase(stiffness))


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

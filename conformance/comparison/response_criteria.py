"""Criteria of a response comparison: deviations in a band against the limits of the user."""

from collections.abc import Iterator, Mapping, Sequence

from pantocheck.conformance.comparison.response_comparison_format import ResponseCriterion
from pantocheck.conformance.comparison.response_deviation import BandStatistics, ResponseBand
from pantocheck.conformance.comparison.response_limits import ResponseLimit, ResponseLimits
from pantocheck.conformance.comparison.response_record import ResponseRecord
from pantocheck.conformance.grading.near_limit import ValueErrors, near_limit_remarks
from pantocheck.conformance.grading.verdicts import judge, margin

GradedResponse = tuple[ResponseRecord, Mapping[ResponseBand, BandStatistics]]
"""Record, and its deviations by band."""


def grade_response_limits(limits: ResponseLimits, responses: Sequence[GradedResponse]) -> tuple[ResponseCriterion, ...]:
    """Grade the responses at the centre of the head by every limit.

    Parameters
    ----------
    limits : ResponseLimits
        Limits of the user.
    responses : sequence of GradedResponse
        Records with their deviations.

    Returns
    -------
    tuple of ResponseCriterion
        One criterion per limit and response; one that is skipped for each load level or height without a response.
    """
    at_head = [response for response in responses if response[0].sidecar.is_at_head]
    return tuple(criterion for limit in limits.limit for criterion in _grade_limit(limit, at_head))


def _grade_limit(limit: ResponseLimit, responses: Sequence[GradedResponse]) -> Iterator[ResponseCriterion]:
    for force in limit.static_forces_N:
        loaded = [response for response in responses if response[0].sidecar.static_force_N == force]
        for height in limit.heights_m or (None,):
            found = [item for item in loaded if height is None or item[0].sidecar.height_m == height]
            if not found:
                place = "" if height is None else f" at {height:g} m"
                reason = f"no response at the centre of the head under {force:g} N{place}"
                yield _build_criterion(limit, force, height, None, reason)
            for record, bands in found:
                statistics = bands[limit.band_Hz]
                yield _build_criterion(limit, force, record.sidecar.height_m, (record, statistics), statistics.missing)


def _build_criterion(
    limit: ResponseLimit,
    force: float,
    height: float | None,
    graded: tuple[ResponseRecord, BandStatistics] | None,
    missing: str | None,
) -> ResponseCriterion:
    unit = "%" if limit.quantity.endswith("_pct") else "°"
    value = None if graded is None else graded[1].values.get(limit.quantity)
    measurement = None if graded is None else graded[1].uncertainty.get(limit.quantity)
    verdict = "skip" if missing is not None or value is None else judge(value, None, limit.upper)
    beyond = None if value is None or verdict != "fail" else f"{value - limit.upper:.3g} {unit} beyond the limit"
    errors = ValueErrors(limit_uncertainty=measurement or 0.0)
    return ResponseCriterion(
        quantity=limit.quantity,
        unit=unit,
        band_Hz=limit.band_Hz,
        response=None if graded is None else graded[0].source,
        static_force_N=force,
        height_m=height,
        value=value,
        upper=limit.upper,
        source=limit.source,
        verdict=verdict,
        reason=missing or beyond,
        margin=None if value is None else margin(value, None, limit.upper),
        measurement=measurement,
        close=tuple(near_limit_remarks(value, (None, limit.upper), unit, errors)),
    )

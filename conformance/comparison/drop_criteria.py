"""Criteria of a drop comparison: agreement of the first model with the record, against the limits of the user."""

import math
from collections.abc import Iterator, Mapping

from pantocheck.conformance.comparison.drop_comparison_format import DropCriterion, WindowStatistics
from pantocheck.conformance.comparison.drop_limits import ComparedMotion, DropLimit, DropLimits, TimeWindow
from pantocheck.conformance.comparison.drop_statistics import is_buried
from pantocheck.conformance.comparison.motion_bands import MotionBand
from pantocheck.conformance.grading.near_limit import ValueErrors, near_limit_remarks
from pantocheck.conformance.grading.verdicts import judge, margin
from pantocheck.conformance.results.criterion_format import ComponentName

StatisticsKey = tuple[int, ComparedMotion, TimeWindow, MotionBand]
"""Sensor, motion, window and band of statistics."""

GradedStatistics = Mapping[StatisticsKey, WindowStatistics]


def grade_limits(
    limits: DropLimits, computed: GradedStatistics, fine: GradedStatistics, clipped: frozenset[tuple[int, TimeWindow]]
) -> tuple[DropCriterion, ...]:
    """Grade the first model at every sensor of every limit.

    Parameters
    ----------
    limits : DropLimits
        Limits of the user.
    computed, fine : mapping
        Statistics by sensor, motion, window and band; those with half the element length and time step.
    clipped : frozenset of (int, TimeWindow)
        Sensors and windows with clipped samples.

    Returns
    -------
    tuple of DropCriterion
        One criterion per limit and sensor. It is skipped if the record does not have what it needs.
    """
    return tuple(
        _grade(limit, sensor, computed, fine, (sensor, limit.window_s) in clipped)
        for limit in limits.limit
        for sensor in limit.sensors
    )


def _grade(
    limit: DropLimit, sensor: int, computed: GradedStatistics, fine: GradedStatistics, clipped: bool
) -> DropCriterion:
    key = (sensor, limit.motion, limit.window_s, limit.band)
    value, fine_value = (_read_value(limit, statistics.get(key)) for statistics in (computed, fine))
    missing = _find_missing(key, computed, clipped)
    verdict = "skip" if missing is not None or value is None else judge(value, limit.lower, limit.upper)
    discretisation = None if value is None or fine_value is None else abs(value - fine_value)
    measurement = 0.0 if missing is not None else _noise_error(computed[key])
    components: dict[ComponentName, float] = {} if discretisation is None else {"discretisation": discretisation}
    errors = ValueErrors(components=components, limit_uncertainty=measurement)
    return DropCriterion(
        quantity=limit.quantity,
        motion=limit.motion,
        sensor=sensor,
        window_s=limit.window_s,
        band_Hz=limit.band,
        value=value,
        lower=limit.lower,
        upper=limit.upper,
        verdict=verdict,
        reason=missing if value is None or verdict != "fail" else _describe_distance(value, limit),
        margin=None if value is None else margin(value, limit.lower, limit.upper),
        discretisation=discretisation,
        measurement=measurement,
        close=tuple(near_limit_remarks(value, (limit.lower, limit.upper), "", errors)),
    )


def _read_value(limit: DropLimit, statistics: WindowStatistics | None) -> float | None:
    """Quantity of the first model; None if the record does not have it."""
    if statistics is None:
        return None
    model = statistics.models[0]
    return model.rms_ratio if limit.quantity == "rms_ratio" else model.correlation


def _noise_error(statistics: WindowStatistics) -> float:
    """Half-width of the 95 % interval of an RMS ratio, and about that of a correlation, by the noise of the record.

    The mean product of signal and noise has the relative standard deviation r / sqrt(2 B T), with the ratio r of the
    RMS of noise and signal, the width B of the band and the length T of the window.
    """
    clean, noise = statistics.record_rms, statistics.noise_rms
    if not clean or noise is None:
        return 0.0
    (low, high), (start, end) = statistics.band_Hz, statistics.window_s
    return 2 * noise / clean / math.sqrt(2 * (high - low) * (end - start))


def _describe_distance(value: float, limit: DropLimit) -> str:
    distance = min(abs(value - bound) for bound in (limit.lower, limit.upper) if bound is not None)
    return f"{distance:.3g} beyond the limit"


def _find_missing(key: StatisticsKey, computed: GradedStatistics, clipped: bool) -> str | None:
    """Data that a criterion needs and the record does not have; None if it is complete."""
    return next(_list_missing(key, computed, clipped), None)


def _list_missing(key: StatisticsKey, computed: GradedStatistics, clipped: bool) -> Iterator[str]:
    sensor, _, window, band = key
    if not any(number == sensor for number, *_ in computed):
        yield f"the record has no vertical channel of sensor {sensor}"
    if not any(other == window for _, _, other, _ in computed):
        yield f"the record does not contain the window from {window[0]:g} to {window[1]:g} s after the release"
    if not any(other == band for *_, other in computed):
        yield f"the sampling rate of the record does not support the band of {band.text}"
    if clipped:
        yield "the channel is clipped in this window"
    if key in computed and computed[key].noise_rms is None:
        yield "the record has no rest before the release, from which its noise would follow"
    if key in computed and is_buried(computed[key]):
        yield "the noise of the record is too large in this window and band"

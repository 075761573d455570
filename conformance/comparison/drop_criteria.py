"""Criteria of a drop comparison: agreement of the first model with the record, against the limits of the user."""

import math
from collections.abc import Iterator, Mapping, Sequence

from pantocheck.conformance.comparison.comparison_limits import ComparisonLimit, TimeWindow, grade_difference
from pantocheck.conformance.comparison.drop_motion import MotionBand
from pantocheck.conformance.comparison.drop_statistics import is_mostly_noise
from pantocheck.conformance.core.criterion import ComparedMotion, Criterion, CriterionPlace
from pantocheck.conformance.core.sourced_table import NO_SOURCE
from pantocheck.conformance.results.drop_comparison_format import WindowStatistics

StatisticsKey = tuple[int, ComparedMotion, TimeWindow, MotionBand]
"""Sensor, motion, window and band of statistics."""

GradedStatistics = Mapping[StatisticsKey, WindowStatistics]


def grade_drop(
    limits: Sequence[ComparisonLimit],
    computed: GradedStatistics,
    fine: GradedStatistics,
    clipped: frozenset[tuple[int, TimeWindow]],
) -> tuple[Criterion, ...]:
    """Grade the first model at every sensor of every limit.

    Args:
        limits: Limits of the user.
        computed: Statistics by sensor, motion, window and band.
        fine: The same with half the element length and time step.
        clipped: Sensors and windows with clipped samples.

    Returns:
        One criterion per limit and sensor. It is skipped if its data are missing in the record.
    """
    criteria = []
    for limit, sensor in [(each, number) for each in limits for number in each.sensors or ()]:
        window, band = limit.window_s or (0.0, 0.0), MotionBand(*limit.band_Hz or (0.0, 0.0))
        key = (sensor, limit.motion or "acceleration", window, band)
        value, fine_value = (_read_value(limit, statistics.get(key)) for statistics in (computed, fine))
        missing = next(_list_missing(key, computed, (sensor, window) in clipped), None)
        criteria.append(
            grade_difference(
                limit,
                value,
                CriterionPlace(sensor=sensor, motion=key[1], window_s=window, band_Hz=band),
                missing=missing,
                discretisation=None if value is None or fine_value is None else abs(value - fine_value),
                measurement=0.0 if missing is not None else _noise_error(computed[key]),
                source="" if limit.source == NO_SOURCE else limit.source,
            )
        )
    return tuple(criteria)


def _read_value(limit: ComparisonLimit, statistics: WindowStatistics | None) -> float | None:
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
    if key in computed and is_mostly_noise(computed[key]):
        yield "the noise of the record is too large in this window and band"

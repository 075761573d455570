"""Comparison of a recorded mass drop with its simulation under one or more damping models."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pantocheck.conformance.cases.case import json_digest
from pantocheck.conformance.comparison.comparison_limits import ComparisonLimit, TimeWindow, grade_difference
from pantocheck.conformance.comparison.drop_motion import (
    MOTION_BANDS,
    DropMotion,
    DropSimulation,
    MotionBand,
    simulate_models,
)
from pantocheck.conformance.comparison.drop_statistics import (
    compute_energies,
    compute_statistics,
    is_mostly_noise,
    sample_curves,
)
from pantocheck.conformance.comparison.recorded_drop import RecordedDrop, locate_drop
from pantocheck.conformance.core.criterion import ComparedMotion, Criterion, CriterionPlace
from pantocheck.conformance.core.files import file_digest
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.sourced_table import NO_SOURCE
from pantocheck.conformance.core.step_log import ShareCallback, build_part_callback, ignore_progress
from pantocheck.conformance.core.verdicts import Verdict, worst_verdict
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.line_comparison import warn_about_line
from pantocheck.conformance.grading.results_building import build_suite
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.elements.damping import Damping, overlay_damping
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE, is_observable
from pantocheck.conformance.records.force_checks import find_clipping
from pantocheck.conformance.results.comparison_format import ComparedSource
from pantocheck.conformance.results.drop_comparison_format import (
    ComparedDrop,
    ComparedModel,
    ComparedPlace,
    DropComparison,
    WindowStatistics,
)
from pantocheck.model import Catenary

# Criteria of a drop comparison: agreement of the first model with the record, against the limits of the user.


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


LEAST_CORRELATION = 0.7
"""Correlation over the first seconds below which mass, place, line or units are doubted [-]."""

MASS = "mass"
"""Name of the place of the mass, where no sensor is."""


@dataclass(frozen=True)
class DampingChoice:
    """Damping model of a comparison."""

    source: str
    """Name of its file, or of the line."""
    damping: Damping
    """Damping; its tables replace those of the line."""


@dataclass(frozen=True)
class DropTask:
    """Task of a comparison."""

    line: LineFile
    """Line of the record."""
    models: Mapping[str, DampingChoice]
    """Damping models by name; the first one is graded."""
    windows: tuple[TimeWindow, ...]
    """Compared windows after the release [s]."""
    element: float
    """Largest element length [m]."""
    time_step: float
    """Largest time step [s]."""
    release_duration: float
    """Time in which the weight decreases linearly to zero [s]."""
    limits: tuple[ComparisonLimit, ...] = ()
    """Limits of the user; without any, the differences are shown and not graded."""

    @property
    def settings(self) -> DropSimulation:
        """Settings of the simulations."""
        last = max(end for _, end in self.windows)
        # Sensors without a limit must not move the release: leaving one out could improve the verdict.
        graded = tuple(dict.fromkeys(sensor for limit in self.limits for sensor in limit.sensors or ()))
        return DropSimulation(self.element, self.time_step, self.release_duration, last, graded)

    def build_models(self) -> dict[str, Catenary]:
        """Line with the damping of each model."""
        return {
            name: build_catenary(
                self.line.model_copy(update={"damping": overlay_damping(self.line.damping, choice.damping)})
            )
            for name, choice in self.models.items()
        }


def compare_drop(record: DropRecord, task: DropTask, progress: ShareCallback = ignore_progress) -> DropComparison:
    """Compare a recorded drop with its simulation under each damping model.

    Args:
        record: Record of one drop.
        task: Line, damping models, windows and limits.
        progress: Called from time to time with the completed share of the simulations, 0 to 1.

    Returns:
        Content of drop_comparison.json.

    Raises:
        InputError: The record is not one of a drop on this line, or ends before the first window does.
        NoInitialState, NoEquilibrium, DidNotConverge: A simulation has no solution.
    """
    catenaries = task.build_models()
    drop = locate_drop(record, next(iter(catenaries.values())))
    _check_sensor_numbers(drop, task)
    # The refined simulation has twice the elements and twice the time steps: it takes as long as about four others.
    share = 1.0 if not task.limits else len(catenaries) / (len(catenaries) + 4)
    motion = simulate_models(drop, catenaries, task.settings, build_part_callback(progress, 0.0, share))
    windows, bands = _find_windows(motion, record, task), _find_bands(motion, record)
    places = _list_places(drop)
    names = tuple(place.name for place in places)
    statistics = compute_statistics(motion, names, windows, bands)
    criteria = _grade(drop, task, motion, statistics, build_part_callback(progress, share, 1.0))
    verdict = worst_verdict(criterion.verdict for criterion in criteria)
    return DropComparison(
        suite=build_suite(),
        model=ComparedSource(name=task.line.title, digest=json_digest(task.line.model_dump(mode="json"))),
        record=ComparedSource(
            name=record.name,
            source=record.source,
            digest=f"sha256:{file_digest(Path(record.file))}" if record.file else None,
        ),
        line_comparison=drop.line,
        verdict=_demote(verdict, drop),
        drop=_describe_drop(drop, task, motion),
        rate_Hz=motion.rate,
        element_m=task.element,
        time_step_s=task.time_step,
        windows_s=windows,
        bands_Hz=bands,
        models=tuple(
            ComparedModel(name=name, source=choice.source, damping=choice.damping, last_slack_s=motion.last_slack[name])
            for name, choice in task.models.items()
        ),
        places=places,
        statistics=statistics,
        energies=compute_energies(motion, names),
        curves=sample_curves(motion, names, windows),
        criteria=criteria,
        warnings=(*record.warnings, *motion.release.warnings, *warn_about_line(drop.line), *_warn(task, motion)),
    ).rounded()


def _find_windows(motion: DropMotion, record: DropRecord, task: DropTask) -> tuple[TimeWindow, ...]:
    """Windows that the record contains."""
    windows = tuple(window for window in task.windows if window[1] <= motion.end + 1e-9)
    if not windows:
        raise InputError(
            f"record '{record.source}'",
            f"can be compared until {motion.end:.1f} s after the release",
            f"The first window ends at {min(end for _, end in task.windows):g} s: record longer, or give --window.",
        )
    return windows


def _find_bands(motion: DropMotion, record: DropRecord) -> tuple[MotionBand, ...]:
    """Bands that the sampling rate supports."""
    bands = tuple(band for band in MOTION_BANDS if is_observable(band.high, motion.rate))
    if not bands:
        least = min(band.high for band in MOTION_BANDS) / HIGHEST_SHARE_OF_RATE
        raise InputError(
            f"record '{record.source}'",
            f"has {record.rate:g} samples per second",
            f"The lowest band needs {least:g}: export the record with its full rate.",
        )
    return bands


def _check_sensor_numbers(drop: RecordedDrop, task: DropTask) -> None:
    """Refuse limits whose windows are not compared, and sensors with several vertical channels."""
    if not task.limits:
        return
    for number, limit in enumerate(task.limits, 1):
        if (window := limit.window_s) is not None and window not in task.windows:
            raise InputError(
                f"limits, key limit[{number}].window_s",
                f"{list(window)} is not a compared window",
                f"Add --window {window[0]:g}:{window[1]:g}.",
            )
    numbers = [channel.sensor for channel in drop.channels]
    repeated = [number for number in numbers if numbers.count(number) > 1]
    if repeated:
        raise InputError(
            f"record '{drop.record.source}', key channel.sensor",
            f"{numbers.count(repeated[0])} vertical channels have the number {repeated[0]}",
            "Limits name sensors by number: give each sensor its own.",
        )


def _list_places(drop: RecordedDrop) -> tuple[ComparedPlace, ...]:
    """Places of the columns of the simulated motion: the sensors, then the mass."""
    sensors = [
        ComparedPlace(name=channel.name, sensor=channel.sensor, wire=channel.wire, position_m=channel.position or 0.0)
        for channel in drop.channels
    ]
    mass = ComparedPlace(name=MASS, sensor=None, wire=drop.wire, position_m=drop.position)
    return (*sensors, mass)


def _describe_drop(drop: RecordedDrop, task: DropTask, motion: DropMotion) -> ComparedDrop:
    return ComparedDrop(
        mass_kg=drop.mass,
        wire=drop.wire,
        position_m=drop.position,
        release_duration_s=task.release_duration,
        planned_release_s=drop.record.drop.trigger_nominal,
        release_s=motion.release_time,
        release_correlation=motion.correlation,
    )


def _grade(
    drop: RecordedDrop,
    task: DropTask,
    motion: DropMotion,
    statistics: tuple[WindowStatistics, ...],
    progress: ShareCallback,
) -> tuple[Criterion, ...]:
    """Criteria of the limits; a refined simulation of the first model gives the error of the mesh and time step."""
    if not task.limits:
        return ()
    name, choice = next(iter(task.models.items()))
    fine_task = replace(task, models={name: choice}, element=task.element / 2, time_step=task.time_step / 2)
    fine = simulate_models(drop, fine_task.build_models(), fine_task.settings, progress)
    places = tuple(place.name for place in _list_places(drop))
    windows = tuple(dict.fromkeys(row.window_s for row in statistics))
    bands = tuple(dict.fromkeys(MotionBand(*row.band_Hz) for row in statistics))
    numbers = {place.name: place.sensor for place in _list_places(drop)}
    computed, refined = (
        {
            (number, row.motion, row.window_s, MotionBand(*row.band_Hz)): row
            for row in rows
            if (number := numbers[row.place]) is not None
        }
        for rows in (statistics, compute_statistics(fine, places, windows, bands))
    )
    return grade_drop(task.limits, computed, refined, _find_clipped(drop, motion, task.windows))


def _find_clipped(
    drop: RecordedDrop, motion: DropMotion, windows: tuple[TimeWindow, ...]
) -> frozenset[tuple[int, TimeWindow]]:
    """Sensors and windows with clipped samples; a clipped sample before a window damages it, too."""
    record = drop.record
    clipped = set()
    for column, channel in zip(drop.columns, drop.channels, strict=True):
        tops = find_clipping(record.signals[:, column])
        clipped |= {
            (channel.sensor, window)
            for window in windows
            if any(start / record.rate < motion.release_time + window[1] for start, _ in tops)
        }
    return frozenset(clipped)


def _demote(verdict: Verdict, drop: RecordedDrop) -> Verdict:
    """Verdict of a record whose line is not fully known: at best unconfirmed."""
    return "unconfirmed" if verdict == "pass" and drop.line.state != "consistent" else verdict


def _warn(task: DropTask, motion: DropMotion) -> list[str]:
    """Caveats on windows that the record does not contain, and on a poor fit of the release."""
    warnings = [
        f"window from {start:g} to {end:g} s: the record can be compared until {motion.end:.1f} s after the release"
        for start, end in task.windows
        if end > motion.end + 1e-9
    ]
    if motion.correlation < LEAST_CORRELATION:
        warnings.append(
            f"record and model have a correlation of {motion.correlation:.2f} over the first seconds: mass, place, "
            "line or units may be wrong"
        )
    return warnings

"""From the samples of a record to signals that can be evaluated, and what had to be cut or marked."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.filters import LowPass
from pantocheck.conformance.quantities.signals import LineSignals, PantographSignals
from pantocheck.conformance.records.measured.filtered_force import detect_filtered
from pantocheck.conformance.records.measured.outliers import find_outliers
from pantocheck.conformance.records.measured.pooled_signals import PooledSignals
from pantocheck.conformance.records.measured.sample_positions import missing_share, place_samples
from pantocheck.conformance.records.measured.usable_sections import (
    SHORTEST_S,
    UsableSection,
    cut_section,
    find_usable_sections,
    local_speed,
)
from pantocheck.conformance.records.record import MAX_SAMPLES, RecordInvalid
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.samples import RecordSamples

SETTLING_PERIODS = 2.0
"""Periods of the cut-off after which the transient at the end of a filtered stretch has died out."""

LEAST_COVERED = 0.5
"""Share of the asked stretch that must be evaluated: statistics of less are those of another line."""

FULLY_COVERED = 0.97
"""Below this share it is said how much was evaluated; the transients at the ends of a record take less."""


@dataclass(frozen=True)
class PreparedRecord:
    """What can be evaluated of a record.

    Parameters
    ----------
    pantographs : dict[int, PooledSignals]
        Signals by number from 1.
    line : LineSignals
        Uplift at the supports.
    rate : float
        Samples per second after resampling [Hz].
    speed : float
        Mean over what is evaluated, or the nominal one [m/s].
    evaluated : tuple[float, float]
        Start and end of the track that is evaluated, cuts included [m].
    seconds : float
        What is evaluated of the first pantograph lasts [s].
    notes : tuple[str, ...]
        What was done.
    warnings : tuple[str, ...]
        What should make a reader careful.
    """

    pantographs: dict[int, PooledSignals]
    line: LineSignals
    rate: float
    speed: float
    evaluated: tuple[float, float]
    seconds: float
    notes: tuple[str, ...]
    warnings: tuple[str, ...]


def prepare_record(
    samples: RecordSamples, sidecar: RecordSidecar, low_pass: LowPass, speed_tolerance_pct: float
) -> PreparedRecord:
    """Cut a record into stretches that can be evaluated, evenly sampled in time.

    Parameters
    ----------
    samples : RecordSamples
        As read.
    sidecar : RecordSidecar
        What they are.
    low_pass : LowPass
        Filter of the graded force.
    speed_tolerance_pct : float
        How far the speed may be off the nominal one where the record is evaluated [%].

    Raises
    ------
    RecordInvalid
        Time or position runs backwards, or no sample has both.
    """
    notes: list[str] = []
    warnings: list[str] = []
    samples, time, position = place_samples(samples, sidecar, warnings)
    rate = _round(1 / float(np.median(np.diff(time))))
    if (time[-1] - time[0]) * rate > MAX_SAMPLES:
        raise RecordInvalid("time", f"{time[-1] - time[0]:.4g} s at {rate:.4g} Hz are more than {MAX_SAMPLES} samples")
    nominal = sidecar.speed_km_h / 3.6
    speed = samples.speed if samples.speed is not None else local_speed(time, position[0])
    steady = np.abs(speed / nominal - 1) <= speed_tolerance_pct / 100
    if samples.time is None:
        notes.append(
            f"The record was sampled by distance; by its speed it was resampled to {rate:g} samples per second."
        )
    elif np.abs(np.diff(time) * rate - 1).max() > 0.02:
        notes.append(f"The record was not evenly sampled; it was resampled to {rate:g} samples per second.")
    if not steady.all():
        warnings.append(
            f"{missing_share(~steady)} of the record was cut: the speed is more than {speed_tolerance_pct:g} % off "
            f"{sidecar.speed_km_h:g} km/h, first at {position[0][np.argmin(steady)]:.1f} m"
        )
    start, end = _stretch_asked(sidecar, position)
    asked = PantographSignals(
        rate=rate, position=position[0], force=samples.force[0], evaluated=(start, end), low_pass=low_pass,
        filter_applied_Hz=sidecar.low_passed_Hz,
    )  # fmt: skip
    pantographs = {
        i + 1: _pantograph(samples, i, time, position[i], steady, asked, warnings)
        for i in range(samples.force.shape[0])
    }
    first = pantographs[1]
    return PreparedRecord(
        pantographs=pantographs,
        line=_line(samples, (start, end), warnings),
        rate=rate,
        speed=float(speed[steady].mean()) if steady.any() else nominal,
        evaluated=(start, end),
        seconds=first.seconds,
        notes=(*notes, *_length_note(first, nominal)),
        warnings=tuple(warnings),
    )


def _stretch_asked(sidecar: RecordSidecar, position: RealArray) -> tuple[float, float]:
    if sidecar.evaluated_m is not None:
        return sidecar.evaluated_m[0], sidecar.evaluated_m[1]
    return float(position[:, 0].max()), float(position[:, -1].min())


def _pantograph(
    samples: RecordSamples,
    at: int,
    time: RealArray,
    position: RealArray,
    steady: NDArray[np.bool_],
    asked: PantographSignals,
    warnings: list[str],
) -> PooledSignals:
    """Signals of one pantograph over the stretches of its record."""
    who, force = f"pantograph {at + 1}", samples.force[at]
    height = None if samples.contact_height is None else samples.contact_height[at]
    present = np.isfinite(force)
    if not present.all():
        warnings.append(
            f"{missing_share(~present)} of the force of {who} is missing, first at {position[~present][0]:.1f} m"
        )
    _mark_outliers(force[present], position[present], who, warnings)
    runs = find_usable_sections(time, present & steady)
    stretches = [cut_section(run, time, position, force, height, asked.rate) for run in runs]
    parts = [part for stretch in stretches for part in _evaluated_part(stretch, asked)]
    if len(runs) > 1:
        warnings.append(f"{who} is evaluated over {len(parts)} stretches between gaps, each filtered on its own")
    covered = sum(part.evaluated[1] - part.evaluated[0] for part in parts) / (asked.evaluated[1] - asked.evaluated[0])
    if parts and covered < LEAST_COVERED:
        why = (
            f"only {100 * covered:.2g} % of {asked.evaluated[0]:.6g} m to {asked.evaluated[1]:.6g} m can be evaluated: "
            "name a stretch with evaluated_m that the record covers"
        )
        return PooledSignals((), why)
    if parts and covered < FULLY_COVERED:
        warnings.append(f"{who} is evaluated over {100 * covered:.3g} % of the stretch that was asked for")
    pooled = PooledSignals(
        tuple(parts),
        f"no stretch of {SHORTEST_S:g} s inside {asked.evaluated[0]:.6g} m to {asked.evaluated[1]:.6g} m is without "
        "gaps and at the nominal speed",
    )
    return detect_filtered(pooled, who, warnings)


def _evaluated_part(stretch: UsableSection, asked: PantographSignals) -> list[PantographSignals]:
    """The part of a stretch that is evaluated: away from its ends, where the filter's transients are."""
    settling = round(SETTLING_PERIODS / asked.low_pass.cutoff_Hz * asked.rate)
    if stretch.position.size <= 2 * settling + 2:
        return []
    start = max(asked.evaluated[0], float(stretch.position[settling]))
    end = min(asked.evaluated[1], float(stretch.position[-1 - settling]))
    inside = (stretch.position >= start - 1e-9) & (stretch.position < end - 1e-9)
    if inside.sum() < SHORTEST_S * asked.rate:
        return []
    return [
        replace(
            asked, position=stretch.position, force=stretch.force, contact_height=stretch.height,
            evaluated=(start, end),
        )
    ]  # fmt: skip


def _mark_outliers(force: RealArray, position: RealArray, who: str, warnings: list[str]) -> None:
    found = find_outliers(force)
    if found.size:
        places = ", ".join(f"{force[i]:.4g} N at {position[i]:.1f} m" for i in found[:5])
        warnings.append(
            f"the force of {who} has {found.size} outlier{'s' if found.size > 1 else ''}, graded all the same: {places}"
            f"{', ...' if found.size > 5 else ''}; write nan for a sample that is not a force"
        )


def _line(samples: RecordSamples, evaluated: tuple[float, float], warnings: list[str]) -> LineSignals:
    """Uplift where it was measured; a missing value is taken as low, and said: it could have been the largest."""
    uplift = samples.uplift
    if uplift is None or samples.support_position is None:
        return LineSignals(evaluated)
    missing = ~np.isfinite(uplift)
    if missing.any():
        warnings.append(
            f"{missing_share(missing)} of the uplift is missing: the largest uplift may not have been recorded"
        )
    measured = ~missing.all(axis=1)
    lowest = np.where(missing[measured], np.inf, uplift[measured]).min(axis=1, keepdims=True)
    filled = np.where(missing[measured], lowest, uplift[measured])
    return LineSignals(evaluated, samples.support_position[measured], filled)


def _length_note(signals: PooledSignals, speed: float) -> list[str]:
    if not signals.parts:
        return []
    return [f"Evaluated: {signals.seconds:.4g} s, about {signals.seconds * speed / 1000:.3g} km of line."]


def _round(rate: float) -> float:
    return float(f"{rate:.6g}")

"""Preparation of a measured record: from its samples to signals, with notes on every cut."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.filters import LowPass
from pantocheck.conformance.quantities.signals import ForceChannel, LineSignals, PantographSignals
from pantocheck.conformance.records.measured.force_checks import detect_filtered, find_outliers
from pantocheck.conformance.records.measured.pooled_signals import PooledSignals
from pantocheck.conformance.records.measured.sample_positions import PlacedSamples, missing_share, place_samples
from pantocheck.conformance.records.measured.usable_sections import (
    SHORTEST_S,
    UsableSection,
    find_usable_sections,
    local_speed,
    resample_section,
)
from pantocheck.conformance.records.record import MAX_SAMPLES, RecordInvalid
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.samples import RecordSamples, analysis_section

SETTLING_PERIODS = 2.0
"""Periods of the cut-off after which the filter transient at the end of a section has decayed."""

LEAST_COVERED = 0.5
"""Smallest share of the analysis section that must be evaluated."""

FULLY_COVERED = 0.97
"""Coverage below this share is reported; the transients at the ends of a record take less."""


@dataclass(frozen=True)
class PreparedRecord:
    """Signals of a measured record.

    Parameters
    ----------
    pantographs : dict of int to PooledSignals
        Signals by number from 1.
    line : LineSignals
        Uplift at the supports.
    rate : float
        Sampling rate after resampling [Hz].
    speed : float
        Mean speed of the steady part, or the nominal speed [m/s].
    section : tuple of float
        Start and end of the analysis section, cuts included [m].
    seconds : float
        Evaluated duration of the first pantograph [s].
    notes : tuple of str
        Remarks on the preparation.
    warnings : tuple of str
        Caveats for the reader of the report.
    """

    pantographs: dict[int, PooledSignals]
    line: LineSignals
    rate: float
    speed: float
    section: tuple[float, float]
    seconds: float
    notes: tuple[str, ...]
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class _Settings:
    """Rate [Hz], analysis section [m], filters and steady samples, common to all pantographs."""

    rate: float
    section: tuple[float, float]
    low_pass: LowPass
    filter_applied_Hz: float | None
    steady: NDArray[np.bool_]


def prepare_record(
    samples: RecordSamples, sidecar: RecordSidecar, low_pass: LowPass, speed_tolerance_pct: float
) -> PreparedRecord:
    """Cut a record into usable sections, evenly sampled in time.

    Parameters
    ----------
    samples : RecordSamples
        Samples as read.
    sidecar : RecordSidecar
        Sidecar of the record.
    low_pass : LowPass
        Filter of the graded force.
    speed_tolerance_pct : float
        Largest difference from the nominal speed in an evaluated section [%].

    Raises
    ------
    RecordInvalid
        Time or position decreases, or no sample has both.
    """
    placed = place_samples(samples, sidecar)
    samples, time, position = placed.samples, placed.time, placed.position
    rate = float(f"{1 / float(np.median(np.diff(time))):.6g}")
    if (time[-1] - time[0]) * rate > MAX_SAMPLES:
        raise RecordInvalid("time", f"{time[-1] - time[0]:.4g} s at {rate:.4g} Hz are more than {MAX_SAMPLES} samples")
    nominal = sidecar.speed_km_h / 3.6
    speed = samples.speed if samples.speed is not None else local_speed(time, position[0])
    steady = np.abs(speed / nominal - 1) <= speed_tolerance_pct / 100
    warnings = [*placed.warnings]
    if not steady.all():
        warnings.append(
            f"{missing_share(~steady)} of the record was cut: the speed differs by more than {speed_tolerance_pct:g} % "
            f"from {sidecar.speed_km_h:g} km/h, first at {position[0][np.argmin(steady)]:.1f} m"
        )
    section = analysis_section(sidecar, position)
    settings = _Settings(rate, section, low_pass, sidecar.low_passed_Hz, steady)
    pantographs = {}
    for row in range(samples.force.shape[0]):
        pantographs[row + 1], remarks = _prepare_pantograph(placed, row, settings)
        warnings += remarks
    line, remarks = _prepare_line(samples, section, float(position[:, -1].min()))
    first = pantographs[1]
    return PreparedRecord(
        pantographs=pantographs,
        line=line,
        rate=rate,
        speed=float(speed[steady].mean()) if steady.any() else nominal,
        section=section,
        seconds=first.seconds,
        notes=(*_resampling_notes(placed, rate), *_length_note(first, nominal)),
        warnings=(*warnings, *remarks),
    )


def _prepare_pantograph(placed: PlacedSamples, row: int, settings: _Settings) -> tuple[PooledSignals, list[str]]:
    """Signals of one pantograph over the usable sections of its record, and warnings."""
    name, force, position = f"pantograph {row + 1}", placed.samples.force[row], placed.position[row]
    heights = placed.samples.contact_height
    present = np.isfinite(force)
    warnings = []
    if not present.all():
        warnings.append(
            f"{missing_share(~present)} of the force of {name} is missing, first at {position[~present][0]:.1f} m"
        )
    warnings += _outlier_warnings(force[present], position[present], name)
    sections = find_usable_sections(placed.time, present & settings.steady)
    parts = []
    for indices in sections:
        channels = UsableSection(position[indices], force[indices], None if heights is None else heights[row][indices])
        parts += _cut_transients(resample_section(placed.time[indices], channels, settings.rate), settings)
    if len(sections) > 1:
        warnings.append(f"{name} is evaluated over {len(parts)} sections between gaps, each filtered on its own")
    start, end = settings.section
    extent = f"{start:.6g} m to {end:.6g} m"
    if not parts:
        reason = f"no section of {SHORTEST_S:g} s inside {extent} is without gaps and at the nominal speed"
        return PooledSignals((), reason), warnings
    covered = sum(part.section[1] - part.section[0] for part in parts) / (end - start)
    if covered < LEAST_COVERED:
        reason = (
            f"only {100 * covered:.2g} % of {extent} can be evaluated: "
            "set evaluated_m to a section that the record covers"
        )
        return PooledSignals((), reason), warnings
    if covered < FULLY_COVERED:
        warnings.append(f"{name} is evaluated over {100 * covered:.3g} % of the analysis section")
    pooled, remarks = detect_filtered(PooledSignals(tuple(parts)), name)
    return pooled, [*warnings, *remarks]


def _cut_transients(usable: UsableSection, settings: _Settings) -> list[PantographSignals]:
    """Signals of a usable section, evaluated away from the filter transients at its ends; empty if too short."""
    settling = round(SETTLING_PERIODS / settings.low_pass.cutoff_Hz * settings.rate)
    position = usable.position
    if position.size <= 2 * settling + 2:
        return []
    start = max(settings.section[0], float(position[settling]))
    end = min(settings.section[1], float(position[-1 - settling]))
    inside = (position >= start - 1e-9) & (position < end - 1e-9)
    if inside.sum() < SHORTEST_S * settings.rate:
        return []
    force = ForceChannel(usable.force, settings.rate, settings.low_pass, settings.filter_applied_Hz)
    return [PantographSignals(position, force, (start, end), usable.height)]


def _outlier_warnings(force: RealArray, position: RealArray, name: str) -> list[str]:
    outliers = find_outliers(force)
    if not outliers.size:
        return []
    places = ", ".join(f"{force[i]:.4g} N at {position[i]:.1f} m" for i in outliers[:5])
    return [
        f"the force of {name} has {outliers.size} outlier{'s' if outliers.size > 1 else ''}, which are graded: {places}"
        f"{', ...' if outliers.size > 5 else ''}; write nan for a sample that is not a force"
    ]


def _prepare_line(samples: RecordSamples, section: tuple[float, float], end: float) -> tuple[LineSignals, list[str]]:
    """Uplift of the supports without missing values, and warnings; a missing value may be the largest one."""
    uplift = samples.uplift
    if uplift is None or samples.support_position is None:
        return LineSignals(section), []
    missing = ~np.isfinite(uplift)
    warnings = []
    if missing.any():
        warnings.append(
            f"{missing_share(missing)} of the uplift is missing: a support with missing values is not evaluated"
        )
    complete = ~missing.any(axis=1)
    return LineSignals(section, samples.support_position[complete], uplift[complete], end=end), warnings


def _resampling_notes(placed: PlacedSamples, rate: float) -> list[str]:
    if placed.samples.time is None:
        return [f"The record was sampled by distance; by its speed it was resampled to {rate:g} samples per second."]
    if np.abs(np.diff(placed.time) * rate - 1).max() > 0.02:
        return [f"The record was not evenly sampled; it was resampled to {rate:g} samples per second."]
    return []


def _length_note(signals: PooledSignals, speed: float) -> list[str]:
    if not signals.parts:
        return []
    return [f"Evaluated: {signals.seconds:.4g} s, about {signals.seconds * speed / 1000:.3g} km of line."]

"""Samples of a table in SI units, before time and position are completed; NaN marks a missing value."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.records.record import SPEED_TOLERANCE, STRIP_CHANNELS, Record, RecordInvalid
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.source_alignment import RecordSources


@dataclass(frozen=True)
class RecordSamples:
    """Channels of p pantographs and s supports, n samples; None stands for a missing channel."""

    force: RealArray
    """Contact force, (p, n) [N]."""
    time: RealArray | None = None
    """Time, (n,) [s]."""
    speed: RealArray | None = None
    """Speed of the train, (n,) [m/s]."""
    position: RealArray | None = None
    """Contact points along the track [m], (p, n), or (1, n) of the first pantograph only."""
    contact_height: RealArray | None = None
    """Height of the contact point, (p, n) [m]."""
    uplift: RealArray | None = None
    """Uplift of the contact wire at the supports, (s, n) [m]."""
    support_position: RealArray | None = None
    """Positions of the supports, (s,) [m]."""
    ignored: tuple[str, ...] = ()
    """Names of the columns of the file that are not used."""
    left_out_sensors: tuple[str, ...] = ()
    """Those of them that may be further sensors of a sum of force sensors."""
    event_level: RealArray | None = None
    """Channels that mark events, in the order of the sidecar, (k, n)."""
    arcing: RealArray | None = None
    loaded: RealArray | None = None
    """Arcs, and time under load, as 1, 0 or NaN, (p, n); all NaN for a pantograph without an arc detector."""
    front_strip: RealArray | None = None
    rear_strip: RealArray | None = None
    """Contact forces of both strips, (p, n) [N]."""
    sources: RecordSources = field(default_factory=RecordSources)
    """Further sources with their own times."""

    def select(self, part: NDArray[np.bool_] | slice) -> "RecordSamples":
        """Samples inside a mask or a slice."""
        values = {name: getattr(self, name) for name in _SAMPLED}
        return replace(self, **{name: value[..., part] for name, value in values.items() if value is not None})


_WITH_GAPS = ("uplift", "event_level", "arcing", "loaded")
_SAMPLED = ("force", "time", "speed", "position", "contact_height", *STRIP_CHANNELS, *_WITH_GAPS)


def complete_samples(
    samples: RecordSamples, sidecar: RecordSidecar, case_start: float | None = None
) -> tuple[RealArray, RealArray]:
    """Complete time and positions of a record; a missing one is computed from the speed.

    Args:
        samples: Samples of a record.
        sidecar: Sidecar of the record.
        case_start: Start of the first pantograph in the case of the record [m], to be named where the sidecar states
            none.

    Returns:
        time: Time, (n,) [s].
        position: Contact points of all pantographs along the track, (p, n) [m].

    Raises:
        RecordInvalid: Time and position are both missing, positions cannot be computed, or a speed is not positive.
    """
    behind = np.array(sidecar.behind)[:, None]
    speed = np.full(samples.force.shape[1], sidecar.speed_km_h / 3.6) if samples.speed is None else samples.speed
    time, position = samples.time, samples.position
    if time is None:
        if position is None:
            raise RecordInvalid("time", "time and position are both missing")
        if not np.all(speed > 0):
            raise RecordInvalid("speed", f"the value of sample {int(np.argmin(speed > 0)) + 1} is not positive")
        time = _integral(1 / speed, position[0])
    if position is None:
        _check_placement(sidecar, case_start)
        position = (sidecar.start_m or 0.0) + _integral(speed, time)[None] - behind
    elif position.shape[0] == 1:
        position = position - behind
    return time, position


def _check_placement(sidecar: RecordSidecar, case_start: float | None) -> None:
    """Refuse a record without positions whose sidecar does not state the positions of its pantographs either."""
    if sidecar.pantographs > 1 and sidecar.spacing_m is None:
        raise RecordInvalid("position", "missing, and the sidecar does not state spacing_m")
    placed = (sidecar.case, sidecar.evaluated_m, sidecar.support_position_m)
    if sidecar.start_m is None and any(key is not None for key in placed):
        place = "" if case_start is None else f" (the first pantograph of the case starts at {case_start:g} m)"
        raise RecordInvalid("position", f"missing, and the sidecar does not state start_m{place}")


def _integral(rate: RealArray, over: RealArray) -> RealArray:
    """Integral by trapezoids, 0 at the first sample."""
    return np.concatenate([[0.0], np.cumsum((rate[1:] + rate[:-1]) / 2 * np.diff(over))])


def analysis_section(sidecar: RecordSidecar, position: RealArray) -> tuple[float, float]:
    """Analysis section of the sidecar, or the track passed by all pantographs [m, m]; positions are (p, n) [m]."""
    if sidecar.evaluated_m is not None:
        return sidecar.evaluated_m[0], sidecar.evaluated_m[1]
    return float(position[:, 0].max()), float(position[:, -1].min())


def build_record(
    samples: RecordSamples,
    sidecar: RecordSidecar,
    evaluated: tuple[float, float] | None = None,
    case_start: float | None = None,
) -> Record:
    """Build a record from samples that are complete and evenly spaced in time.

    Args:
        samples: Samples as read.
        sidecar: Sidecar of the record.
        evaluated: Analysis section of the case [m], used if the sidecar states none.
        case_start: Start of the first pantograph in the case [m], to be named where the sidecar states none.

    Raises:
        RecordInvalid: Values are missing, the time axis is not uniform, or the speed channel contradicts the stated
            speed.
    """
    for name in _SAMPLED:
        value = getattr(samples, name)
        if name not in _WITH_GAPS and value is not None and not np.isfinite(value).all():
            bad = np.argwhere(~np.isfinite(value.T))[:, 0]
            raise RecordInvalid(name, f"{bad.size} values are not finite, the first at sample {bad[0] + 1}")
    time, position = complete_samples(samples, sidecar, case_start)
    section = evaluated if sidecar.evaluated_m is None and evaluated else analysis_section(sidecar, position)
    _check_speed_channel(samples, sidecar.speed_km_h, position, section)
    return Record(
        time=time,
        speed=sidecar.speed_km_h / 3.6,
        position=position,
        force=samples.force,
        evaluated=section,
        filter_applied_Hz=sidecar.low_passed_Hz,
        contact_height=samples.contact_height,
        front_strip=samples.front_strip,
        rear_strip=samples.rear_strip,
        support_position=samples.support_position,
        support_uplift=samples.uplift,
    )


def _check_speed_channel(
    samples: RecordSamples, speed_km_h: float, position: RealArray, section: tuple[float, float]
) -> None:
    """Refuse a speed channel that contradicts the stated speed inside the section; run-in and run-out may differ."""
    if samples.speed is None:
        return
    inside = ((position >= section[0]) & (position <= section[1])).any(axis=0)
    speed = 3.6 * (samples.speed[inside] if inside.any() else samples.speed)
    # The mean absolute deviation tolerates the noise of a sensor, but no part of the section at another speed.
    if not np.abs(speed / speed_km_h - 1).mean() <= SPEED_TOLERANCE:
        raise RecordInvalid(
            "speed",
            f"ranges from {speed.min():.4g} to {speed.max():.4g} km/h, but the sidecar states {speed_km_h:.4g} km/h",
        )

"""From the samples of a record to signals that can be evaluated, and what had to be cut or marked."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from pantocheck.conformance.measured.outliers import outliers
from pantocheck.conformance.measured.pooling import PooledSignals
from pantocheck.conformance.measured.stretches import SHORTEST_S, Stretch, local_speed, stretch_of, usable_runs
from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE, LowPass
from pantocheck.conformance.quantities.signals import LineSignals, PantographSignals
from pantocheck.conformance.record import MAX_SAMPLES, Array, RecordInvalid
from pantocheck.conformance.record_files.samples import Samples, completed
from pantocheck.conformance.record_files.sidecar import Sidecar
from scipy.signal import welch

SETTLING_PERIODS = 2.0
"""Periods of the cut-off after which the transient at the end of a filtered stretch has died out."""

FILTERED_RATIO = 0.08
"""Rms at 30-50 Hz over rms at 5-20 Hz below which a force has been low-passed, whatever its sidecar says.

The force of the reference simulator has 0.26 to 0.40 there (EN 50318:2002 at 250 and 300 km/h, AC simple at
320 km/h), and 0.02 to 0.08 after a filter of order 4 or 6 at 20 Hz. If a sidecar says "none" and is right, nothing but
the numbers above 20 Hz is lost."""


@dataclass(frozen=True)
class Prepared:
    """What can be evaluated of a record.

    Parameters
    ----------
    pantographs : signals by number from 1
    line : uplift at the supports
    rate : samples per second after resampling [Hz]
    speed : mean over what is evaluated, or the nominal one [m/s]
    evaluated : start and end of the track that is evaluated, cuts included [m]
    seconds : what is evaluated of the first pantograph lasts [s]
    notes : what was done
    warnings : what should make a reader careful
    """

    pantographs: dict[int, PooledSignals]
    line: LineSignals
    rate: float
    speed: float
    evaluated: tuple[float, float]
    seconds: float
    notes: tuple[str, ...]
    warnings: tuple[str, ...]


def prepared(samples: Samples, sidecar: Sidecar, low_pass: LowPass, speed_tolerance_pct: float) -> Prepared:
    """Cut a record into stretches that can be evaluated, evenly sampled in time.

    Parameters
    ----------
    samples : as read
    sidecar : what they are
    low_pass : filter of the graded force
    speed_tolerance_pct : how far the speed may be off the nominal one where the record is evaluated [%]

    Raises
    ------
    RecordInvalid : time or position runs backwards, or no sample has both
    """
    notes: list[str] = []
    warnings: list[str] = []
    samples, time, position = _placed(samples, sidecar, warnings)
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
            f"{_share(~steady)} of the record was cut: the speed is more than {speed_tolerance_pct:g} % off "
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
    return Prepared(
        pantographs=pantographs,
        line=_line(samples, (start, end)),
        rate=rate,
        speed=float(speed[steady].mean()) if steady.any() else nominal,
        evaluated=(start, end),
        seconds=first.seconds,
        notes=(*notes, *_length_note(first, nominal)),
        warnings=tuple(warnings),
    )


def _placed(samples: Samples, sidecar: Sidecar, warnings: list[str]) -> tuple[Samples, Array, Array]:
    """Samples that say when and where they are, their times and positions."""
    axes = [a for a in (samples.time, samples.speed, samples.position) if a is not None]
    known = np.all([np.isfinite(np.atleast_2d(axis)).all(axis=0) for axis in axes], axis=0)
    if known.sum() < 2:
        raise RecordInvalid("time", "fewer than two samples say when or where they are")
    if not known.all():
        warnings.append(f"{_share(~known)} of the samples do not say when or where they are, and were left out")
        samples = samples.at(known)
    if samples.time is None and samples.speed is not None and not (samples.speed > 0).all():
        warnings.append(f"{_share(samples.speed <= 0)} of the samples were left out: the train stands there")
        samples = samples.at(samples.speed > 0)
    if samples.force.shape[1] < 2:
        raise RecordInvalid("speed", "the train stands at nearly every sample")
    time, position = completed(samples, sidecar)
    for name, axis in (("time", time[None]), ("position", position)):
        backwards = np.argwhere(np.diff(axis, axis=1).T <= 0)
        if backwards.size:
            raise RecordInvalid(name, f"does not grow from sample {backwards[0][0] + 1} to the next")
    return samples, time, position


def _stretch_asked(sidecar: Sidecar, position: Array) -> tuple[float, float]:
    if sidecar.evaluated_m is not None:
        return sidecar.evaluated_m[0], sidecar.evaluated_m[1]
    return float(position[:, 0].max()), float(position[:, -1].min())


def _pantograph(
    samples: Samples,
    at: int,
    time: Array,
    position: Array,
    steady: NDArray[np.bool_],
    asked: PantographSignals,
    warnings: list[str],
) -> PooledSignals:
    """Signals of one pantograph over the stretches of its record."""
    who, force = f"pantograph {at + 1}", samples.force[at]
    height = None if samples.contact_height is None else samples.contact_height[at]
    present = np.isfinite(force)
    if not present.all():
        warnings.append(f"{_share(~present)} of the force of {who} is missing, first at {position[~present][0]:.1f} m")
    _mark_outliers(force[present], position[present], who, warnings)
    runs = usable_runs(time, present & steady)
    stretches = [stretch_of(run, time, position, force, height, asked.rate) for run in runs]
    parts = [part for stretch in stretches for part in _evaluated_part(stretch, asked)]
    if len(runs) > 1:
        warnings.append(f"{who} is evaluated over {len(parts)} stretches between gaps, each filtered on its own")
    pooled = PooledSignals(
        tuple(parts),
        f"no stretch of {SHORTEST_S:g} s inside {asked.evaluated[0]:.6g} m to {asked.evaluated[1]:.6g} m is without "
        "gaps and at the nominal speed",
    )
    return _as_filtered(pooled, who, warnings)


def _evaluated_part(stretch: Stretch, asked: PantographSignals) -> list[PantographSignals]:
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


def _as_filtered(pooled: PooledSignals, who: str, warnings: list[str]) -> PooledSignals:
    """Signals with the filter they have really been through: a sidecar may not know of the measuring chain's."""
    if not pooled.parts or pooled.filter_applied_Hz is not None or pooled.parts[0].rate * HIGHEST_SHARE_OF_RATE < 50:
        return pooled
    upper, inner = (_leakless_rms(pooled, low, high) for low, high in ((30, 50), (5, 20)))
    # Without content at 5-20 Hz there is nothing to compare with.
    if inner <= 1e-3 * float(pooled.delivered.std()) or upper > FILTERED_RATIO * inner:
        return pooled
    cutoff = pooled.parts[0].low_pass.cutoff_Hz
    warnings.append(
        f"the force of {who} has nothing at 30-50 Hz ({upper:.2g} N, {inner:.3g} N at 5-20 Hz): it is taken as "
        f"filtered at {cutoff:g} Hz by the measuring chain, so that nothing is said of what lies above"
    )
    return replace(pooled, parts=tuple(replace(part, filter_applied_Hz=cutoff) for part in pooled.parts))


def _leakless_rms(pooled: PooledSignals, low: float, high: float) -> float:
    """Rms in a band [N] through a Hann window: where a stretch begins and ends must not look like content."""
    power, weight = 0.0, 0
    for part in pooled.parts:
        segment = min(part.delivered.size, round(2 * part.rate))
        frequency, density = welch(part.delivered, part.rate, nperseg=segment)
        inside = (frequency >= low) & (frequency <= high)
        power += part.delivered.size * float(density[inside].sum() * frequency[1])
        weight += part.delivered.size
    return float(np.sqrt(power / weight))


def _mark_outliers(force: Array, position: Array, who: str, warnings: list[str]) -> None:
    found = outliers(force)
    if found.size:
        places = ", ".join(f"{force[i]:.4g} N at {position[i]:.1f} m" for i in found[:5])
        warnings.append(
            f"the force of {who} has {found.size} outlier{'s' if found.size > 1 else ''}, graded all the same: {places}"
            f"{', ...' if found.size > 5 else ''}; write nan for a sample that is not a force"
        )


def _line(samples: Samples, evaluated: tuple[float, float]) -> LineSignals:
    """Uplift where it was measured; a missing value cannot be the largest."""
    uplift = samples.uplift
    if uplift is None or samples.support_position is None:
        return LineSignals(evaluated)
    measured = np.isfinite(uplift).any(axis=1)
    lowest = np.where(np.isfinite(uplift[measured]), uplift[measured], np.inf).min(axis=1, keepdims=True)
    filled = np.where(np.isfinite(uplift[measured]), uplift[measured], lowest)
    return LineSignals(evaluated, samples.support_position[measured], filled)


def _length_note(signals: PooledSignals, speed: float) -> list[str]:
    if not signals.parts:
        return []
    return [f"Evaluated: {signals.seconds:.4g} s, about {signals.seconds * speed / 1000:.3g} km of line."]


def _share(chosen: NDArray[np.bool_]) -> str:
    return f"{100 * chosen.mean():.2g} %"


def _round(rate: float) -> float:
    return float(f"{rate:.6g}")

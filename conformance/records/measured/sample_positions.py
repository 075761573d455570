"""Time and position of each sample of a measured record."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.records.record import RecordInvalid
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.samples import RecordSamples, complete_samples


@dataclass(frozen=True)
class PlacedSamples:
    """Samples with their time and position, both increasing."""

    samples: RecordSamples
    """Samples with time and position."""
    time: RealArray
    """Time of each sample, (n,) [s]."""
    position: RealArray
    """Position of each pantograph along the track, (p, n) [m]."""
    warnings: tuple[str, ...]
    """Notes on discarded samples."""


def place_samples(samples: RecordSamples, sidecar: RecordSidecar) -> PlacedSamples:
    """Determine time and position of the samples; samples without them are discarded.

    Args:
        samples: Samples of a record.
        sidecar: Sidecar of the record.

    Returns:
        Remaining samples with time and position.

    Raises:
        RecordInvalid: Time or position decreases, or fewer than two samples have both.
    """
    warnings = []
    axes = [axis for axis in (samples.time, samples.speed, samples.position) if axis is not None]
    known = np.all([np.isfinite(np.atleast_2d(axis)).all(axis=0) for axis in axes], axis=0)
    if known.sum() < 2:
        raise RecordInvalid("time", "fewer than two samples have a time or position")
    if not known.all():
        warnings.append(f"{missing_share(~known)} of the samples were discarded: they have no time or no position")
        samples = samples.select(known)
    if samples.time is None and samples.speed is not None and not (samples.speed > 0).all():
        warnings.append(f"{missing_share(samples.speed <= 0)} of the samples were discarded: the train stands still")
        samples = samples.select(samples.speed > 0)
    if samples.force.shape[1] < 2:
        raise RecordInvalid("speed", "fewer than two samples have a positive speed")
    time, position = complete_samples(samples, sidecar)
    if samples.time is not None:
        samples, time, position = _smooth_steps(samples, time, position)
    for name, axis in (("time", time[None]), ("position", position)):
        backwards = np.argwhere(np.diff(axis, axis=1).T <= 0)
        if backwards.size:
            first = backwards[0][0] + 1
            raise RecordInvalid(name, f"the value of sample {first + 1} is not greater than that of sample {first}")
    return PlacedSamples(samples, time, position, tuple(warnings))


def _smooth_steps(
    samples: RecordSamples, time: RealArray, position: RealArray
) -> tuple[RecordSamples, RealArray, RealArray]:
    """Interpolate positions of a wheel-pulse counter, which are constant for some samples between two steps."""
    stepped = np.diff(position[0], prepend=-np.inf) > 0
    if stepped.all() or (np.diff(position, axis=1) < 0).any() or stepped.sum() < 2:
        return samples, time, position
    # The position after the last step is unknown.
    within = np.arange(time.size) <= np.flatnonzero(stepped)[-1]
    smooth = np.vstack([np.interp(time[within], time[stepped], row[stepped]) for row in position])
    return samples.select(within), time[within], smooth


def missing_share(mask: NDArray[np.bool_]) -> str:
    """Share of the samples in a mask as text."""
    return f"{100 * mask.mean():.2g} %"

"""When and where each sample of a measured record was taken."""

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.records.record import RecordInvalid
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.samples import RecordSamples, complete_samples


def place_samples(
    samples: RecordSamples, sidecar: RecordSidecar, warnings: list[str]
) -> tuple[RecordSamples, RealArray, RealArray]:
    """Samples that say when and where they are, their times [s] (n,) and positions [m] (p, n), both growing.

    Parameters
    ----------
    samples, sidecar : RecordSamples or RecordSidecar
        Of a record.
    warnings : list[str]
        Is told what was left out.

    Raises
    ------
    RecordInvalid
        Time or position runs backwards, or no two samples have both.
    """
    axes = [a for a in (samples.time, samples.speed, samples.position) if a is not None]
    known = np.all([np.isfinite(np.atleast_2d(axis)).all(axis=0) for axis in axes], axis=0)
    if known.sum() < 2:
        raise RecordInvalid("time", "fewer than two samples say when or where they are")
    if not known.all():
        warnings.append(f"{missing_share(~known)} of the samples do not say when or where they are, and were left out")
        samples = samples.at(known)
    if samples.time is None and samples.speed is not None and not (samples.speed > 0).all():
        warnings.append(f"{missing_share(samples.speed <= 0)} of the samples were left out: the train stands there")
        samples = samples.at(samples.speed > 0)
    if samples.force.shape[1] < 2:
        raise RecordInvalid("speed", "the train stands at nearly every sample")
    time, position = complete_samples(samples, sidecar)
    if samples.time is not None:
        samples, time, position = _without_steps(samples, time, position)
    for name, axis in (("time", time[None]), ("position", position)):
        backwards = np.argwhere(np.diff(axis, axis=1).T <= 0)
        if backwards.size:
            raise RecordInvalid(name, f"does not grow from sample {backwards[0][0] + 1} to the next")
    return samples, time, position


def _without_steps(
    samples: RecordSamples, time: RealArray, position: RealArray
) -> tuple[RecordSamples, RealArray, RealArray]:
    """Positions that grow: a counter of wheel turns stands still for some samples and then steps forwards."""
    grown = np.diff(position[0], prepend=-np.inf) > 0
    if grown.all() or (np.diff(position, axis=1) < 0).any() or grown.sum() < 2:
        return samples, time, position
    # Nothing is known of the place after the last step.
    within = np.arange(time.size) <= np.flatnonzero(grown)[-1]
    smooth = np.vstack([np.interp(time[within], time[grown], row[grown]) for row in position])
    return samples.at(within), time[within], smooth


def missing_share(chosen: NDArray[np.bool_]) -> str:
    return f"{100 * chosen.mean():.2g} %"

"""Contact losses: intervals of an unfiltered force without contact."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray


@dataclass(frozen=True)
class ContactLoss:
    """One contact loss."""

    place: float
    """Position of the pantograph at its start [m]."""
    time: float
    """Time from the start of the analysis section [s]."""
    duration: float
    """Duration [s], a multiple of the sampling interval."""
    lowest_force: float
    """Lowest force [N]; a measured force may be negative."""


def find_losses(force: RealArray) -> NDArray[np.intp]:
    """Intervals [start, end) of samples without contact, (k, 2), for an unfiltered force (n,) [N]."""
    lost = np.concatenate([[False], force <= 0, [False]])
    return np.flatnonzero(np.diff(lost.astype(np.int8))).reshape(-1, 2)


def loss_durations(force: RealArray, rate: float) -> RealArray:
    """Duration of the contact loss that each sample belongs to, (n,) [s]; 0 in contact.

    Args:
        force: Unfiltered contact force, (n,) [N]; no contact is zero force.
        rate: Sampling rate [Hz].
    """
    durations = np.zeros(force.size)
    for start, end in find_losses(force):
        durations[start:end] = (end - start) / rate
    return durations


def loss_starts(force: RealArray) -> RealArray:
    """1 at the first sample of every contact loss, otherwise 0, (n,), for an unfiltered force (n,) [N]."""
    starts = np.zeros(force.size)
    starts[find_losses(force)[:, 0]] = 1
    return starts


def list_losses(force: RealArray, position: RealArray, rate: float) -> list[ContactLoss]:
    """Contact losses in the order of their places.

    Args:
        force: Unfiltered contact force over the analysis section, (n,) [N].
        position: Position of the pantograph, (n,) [m].
        rate: Sampling rate [Hz].
    """
    return [
        ContactLoss(
            float(position[start]), float(start / rate), float((end - start) / rate), float(force[start:end].min())
        )
        for start, end in find_losses(force)
    ]

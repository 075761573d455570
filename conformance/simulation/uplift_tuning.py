"""Uplift forces with which mean contact forces meet their targets."""

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from pantocheck.conformance.array_types import RealArray

TOLERANCE = 0.02
"""A tuned mean contact force is this close to its target [N]."""
MOST_RUNS = 12


class TuningFailed(ArithmeticError):
    """The uplift force that gives the target mean was not found; grading another mean would compare the wrong run."""


TunedRun = TypeVar("TunedRun")


def tune_uplift(
    run: Callable[[tuple[float, ...]], TunedRun],
    means: Callable[[TunedRun], RealArray],
    start: Sequence[float],
    targets: Sequence[float | None],
) -> tuple[TunedRun, tuple[float, ...]]:
    """Secant on every pantograph's own force.

    Parameters
    ----------
    run : Callable[[tuple[float, ...]], TunedRun]
        Makes a run with the given uplift forces [N].
    means : Callable[[TunedRun], ndarray]
        Mean contact forces of a run [N].
    start : Sequence[float]
        Forces of the first run [N].
    targets : Sequence[float or None]
        Mean contact forces that are wanted; None leaves a force as it is [N].

    Returns
    -------
    tuple[TunedRun, tuple[float, ...]]
        The run that meets the targets, and its forces.

    Raises
    ------
    NotTuned
        It is not among the first runs.
    """
    wanted = np.array([np.nan if target is None else target for target in targets])
    aimed = np.isfinite(wanted)
    forces = np.array(start, dtype=float)
    # The mean follows the uplift force nearly one to one.
    slope = np.ones(forces.size)
    made = run(tuple(map(float, forces)))
    found = means(made)
    for made_runs in range(1, MOST_RUNS + 1):
        missing = np.where(aimed, wanted - found, 0.0)
        if np.abs(missing).max(initial=0.0) <= TOLERANCE:
            return made, tuple(map(float, forces))
        if made_runs == MOST_RUNS:
            break
        change = missing / slope
        forces = forces + change
        made = run(tuple(map(float, forces)))
        now = means(made)
        # Two pantographs act on each other: a quotient far from one is the other's doing.
        moved = np.abs(change) > TOLERANCE / 10
        quotient = np.divide(now - found, change, out=slope.copy(), where=moved)
        slope, found = np.clip(quotient, 0.5, 2.0), now
    raise TuningFailed(f"a mean contact force is still {np.nanmax(np.abs(wanted - found)):.2f} N off its target")

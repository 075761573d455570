"""Tuning of the uplift forces to the mean contact forces that a case requires."""

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.model.failures import SimulationError

TOLERANCE = 0.02
"""Largest difference between a tuned mean contact force and its target [N]."""
MAX_RUNS = 12

START_SLOPE = 0.955
"""Change of the mean contact force per change of the uplift force before the second run [-].

Measured on the cases of EN 50318:2018 with one and two pantographs at 275 and 320 km/h: 0.945 to 0.975, middle 0.955.
"""


class TuningFailed(SimulationError):
    """No uplift force gives the target; a run with another mean contact force must not be graded."""


TunedRun = TypeVar("TunedRun")


def tune_uplift(
    run: Callable[[tuple[float, ...]], TunedRun],
    mean_forces: Callable[[TunedRun], RealArray],
    start: Sequence[float],
    targets: Sequence[float | None],
) -> TunedRun:
    """Tune the uplift forces by the secant method, each pantograph with its own slope.

    Args:
        run: Function that simulates the passage for given uplift forces [N].
        mean_forces: Function that gives the mean contact force of every pantograph of a run [N].
        start: Uplift forces of the first run [N].
        targets: Target of every mean contact force [N]; None: the uplift force remains.

    Returns:
        The run that meets the targets.

    Raises:
        TuningFailed: None of the first `MAX_RUNS` runs meets the targets.
    """
    target = np.array([np.nan if value is None else value for value in targets])
    has_target = np.isfinite(target)
    forces = np.array(start, dtype=float)
    slope = np.full(forces.size, START_SLOPE)
    tuned = run(tuple(map(float, forces)))
    means = mean_forces(tuned)
    for run_count in range(1, MAX_RUNS + 1):
        error = np.where(has_target, target - means, 0.0)
        if np.abs(error).max(initial=0.0) <= TOLERANCE:
            return tuned
        if run_count == MAX_RUNS:
            break
        change = error / slope
        forces = forces + change
        tuned = run(tuple(map(float, forces)))
        new_means = mean_forces(tuned)
        # A quotient far from 1 is an effect of the other pantographs, hence the clip.
        moved = np.abs(change) > TOLERANCE / 10
        quotient = np.divide(new_means - means, change, out=slope.copy(), where=moved)
        slope, means = np.clip(quotient, 0.5, 2.0), new_means
    worst = int(np.nanargmax(np.abs(target - means)))
    raise TuningFailed(
        f"pantograph {worst + 1}: after {MAX_RUNS} runs the mean contact force is {means[worst]:.2f} N, "
        f"its target_mean_force_N is {target[worst]:.2f} N"
    )

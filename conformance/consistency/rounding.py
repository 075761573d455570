"""Step to which the values of a channel are rounded."""

import numpy as np

from pantocheck.conformance.array_types import RealArray

COARSEST_STEP_M = 0.5e-3
"""Steps of a rounded height or uplift from which they confirm nothing [m]; the error of steps of 0.1 mm is accepted."""

SMALLEST_STEP = 1e-9
"""Differences that binary numbers make of equal decimal ones [m]."""


def rounding_step(values: RealArray) -> float:
    """Smallest difference between two values [m]: the step to which they are rounded; infinite for a constant.

    Args:
        values: Samples of a channel, (n,) [m].
    """
    steps = np.diff(np.unique(values))
    return float(steps[steps > SMALLEST_STEP].min(initial=np.inf))

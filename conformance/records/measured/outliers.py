"""Outliers: samples that stand far out of their neighbours. They are marked, never removed: a peak may be real."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import medfilt

from pantocheck.conformance.array_types import RealArray

NEIGHBOURS = 7
"""Samples in the running median that a value is compared with."""

DEVIATIONS = 12.0
"""Robust standard deviations from the running median: a normal force has none in a lifetime of samples."""

LEAST_N = 50.0
"""Distance below which nothing is called an outlier [N]."""


def find_outliers(force: RealArray) -> NDArray[np.intp]:
    """Indices of the samples that stand out of their neighbours.

    Parameters
    ----------
    force : (n,) ndarray
        Contact force without missing values [N].
    """
    if force.size < NEIGHBOURS:
        return np.empty(0, dtype=np.intp)
    away = np.abs(force - medfilt(force, NEIGHBOURS))
    # 1.4826: the median of |x| of a normal variable to its standard deviation.
    spread = 1.4826 * float(np.median(away))
    inner = away[NEIGHBOURS // 2 : -(NEIGHBOURS // 2)]  # medfilt pads its ends with zeros
    return np.flatnonzero(inner > max(DEVIATIONS * spread, LEAST_N)) + NEIGHBOURS // 2

"""Outliers: samples far from their neighbours. They are reported but never removed, because a peak may be real."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import medfilt

from pantocheck.conformance.array_types import RealArray

NEIGHBOURS = 7
"""Number of samples in the running median."""

DEVIATIONS = 12.0
"""Robust standard deviations from the running median beyond which a sample is an outlier."""

SMALLEST_DISTANCE_N = 50.0
"""Smallest distance of an outlier from the running median [N]."""


def find_outliers(force: RealArray) -> NDArray[np.intp]:
    """Indices of the outliers.

    Parameters
    ----------
    force : (n,) ndarray
        Contact force without missing values [N].
    """
    if force.size < NEIGHBOURS:
        return np.empty(0, dtype=np.intp)
    distance = np.abs(force - medfilt(force, NEIGHBOURS))
    # 1.4826: standard deviation of a normal variable over the median of its absolute value.
    deviation = 1.4826 * float(np.median(distance))
    inner = distance[NEIGHBOURS // 2 : -(NEIGHBOURS // 2)]  # medfilt pads its ends with zeros
    return np.flatnonzero(inner > max(DEVIATIONS * deviation, SMALLEST_DISTANCE_N)) + NEIGHBOURS // 2

"""Release of a recorded drop: the time at which the simulated motion after the release fits the record best."""

import numpy as np
from scipy.signal import resample_poly

from pantocheck.conformance.array_types import RealArray

ALIGNED_S = 2.0
"""Length of the motion after the release that is aligned [s]: damping and errors of frequency have no effect yet."""

ARRIVAL = 0.01
"""Motion over its largest value at which the first wave has arrived at a sensor [-]."""

SEARCH_S = 1.0
"""Largest distance between the estimated and the aligned release [s]: filters of slow records ring before it."""

UPSAMPLING = 16
"""Samples of the search per sample of the record; at 200 samples per second, a step is 0.3 ms."""


def find_arrival(simulated: RealArray, rate: float) -> float:
    """Time from the release to the first motion of a sensor [s].

    Args:
        simulated: Simulated motion of c sensors from the release on, (m, c).
        rate: Sampling rate [Hz].
    """
    model = simulated[: round(ALIGNED_S * rate)]
    moving = np.any(np.abs(model) > ARRIVAL * np.abs(model).max(axis=0), axis=1)
    return float(np.argmax(moving)) / rate


def align_release(record: RealArray, simulated: RealArray, rate: float, estimate: float) -> tuple[float, float]:
    """Find the release by the correlation of record and simulation at all sensors together.

    Args:
        record: Recorded motion of c sensors, low-pass filtered, (n, c).
        simulated: Simulated motion from the release on, with the same filter, (m, c).
        rate: Sampling rate of both [Hz].
        estimate: Estimate of the release in the time of the record [s].

    Returns:
        Release in the time of the record [s], and correlation over `ALIGNED_S` from this release [-].
    """
    model = simulated[: round(ALIGNED_S * rate)]
    fine = resample_poly(record, UPSAMPLING, 1, axis=0)
    middle, reach = round(estimate * rate * UPSAMPLING), round(SEARCH_S * rate * UPSAMPLING)
    last = fine.shape[0] - UPSAMPLING * (model.shape[0] - 1) - 1
    starts = np.arange(max(middle - reach, 0), min(max(middle, 0) + reach, last) + 1)
    values = np.array([_correlation(fine[s : s + UPSAMPLING * model.shape[0] : UPSAMPLING], model) for s in starts])
    k = int(np.clip(np.argmax(values), 1, starts.size - 2))
    below, middle_value, above = values[k - 1 : k + 2]
    curvature = below - 2 * middle_value + above
    offset = float(np.clip(0.5 * (below - above) / curvature, -1, 1)) if curvature < 0 else 0.0
    return max(float(starts[k] + offset) / (rate * UPSAMPLING), 0.0), float(values[k])


def _correlation(a: RealArray, b: RealArray) -> float:
    norm = float(np.sqrt(np.sum(a**2) * np.sum(b**2)))
    return float(np.sum(a * b)) / norm if norm > 0 else 0.0

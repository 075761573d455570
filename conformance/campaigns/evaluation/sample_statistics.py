"""Statistics of random designs: share of exceedances with its interval, and linear influence of the inputs."""

import numpy as np
from scipy.special import ndtri

from pantocheck.conformance.array_types import RealArray

CONFIDENCE = 0.95
"""Confidence of all intervals."""


def wilson_interval(count: int, runs: int) -> tuple[float, float]:
    """Confidence interval of a probability (Wilson 1927).

    Args:
        count: Number of runs with the event.
        runs: Number of all runs.

    Returns:
        Ends of the 95 % interval. For stratified samples it is too wide rather than too narrow.
    """
    z = float(ndtri((1 + CONFIDENCE) / 2))
    share, weight = count / runs, z**2 / runs
    centre = (share + weight / 2) / (1 + weight)
    half = z * np.sqrt(share * (1 - share) / runs + weight / (4 * runs)) / (1 + weight)
    return (0.0 if count == 0 else centre - half), (1.0 if count == runs else centre + half)


def mean_interval(values: RealArray) -> tuple[float, float]:
    """95 % interval of a mean, from the normal approximation; needs two values or more."""
    half = float(ndtri((1 + CONFIDENCE) / 2) * values.std(ddof=1) / np.sqrt(values.size))
    return float(values.mean()) - half, float(values.mean()) + half


def linear_influences(inputs: RealArray, values: RealArray) -> tuple[RealArray, float]:
    """Change of a value by one standard deviation of each input, from linear regression.

    Args:
        inputs: Random inputs of the runs, (n, k).
        values: Value of the runs, (n,).

    Returns:
        influences: Regression coefficients times the standard deviations of the inputs, in the unit of the value, (k,).
        determination: Share of the variance that the regression explains; far below 1, the influences do not describe
            the value.
    """
    deviation = inputs - inputs.mean(axis=0)
    scale = deviation.std(axis=0)
    scaled = deviation / np.where(scale > 0, scale, 1.0)
    centred = values - values.mean()
    influences, *_ = np.linalg.lstsq(scaled, centred, rcond=None)
    variance = float(np.mean(centred**2))
    residual = float(np.mean((centred - scaled @ influences) ** 2))
    return influences, 1 - residual / variance if variance > 0 else 1.0

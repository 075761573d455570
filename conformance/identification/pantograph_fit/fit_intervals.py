"""Intervals of the parameters of a fitted chain, from the curvature of the sum of squares at its minimum."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.stats import t

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.pantograph_fit.chain_fit import ChainFit

Determination = Literal["fixed", "determined", "weakly_determined", "not_distinguished_from_zero"]
"""How well the measured band determines a parameter."""

INTERVAL_CONFIDENCE = 0.95
"""Confidence of an interval."""

WEAK = 0.2
"""Half-width of an interval over its value above which a parameter is weakly determined: models are compared with
changes of five percent and more."""


@dataclass(frozen=True)
class FitIntervals:
    """Intervals of the parameters."""

    half_width: RealArray
    """Half-widths of the 95 % intervals of masses [kg], stiffnesses [N/m] and dampings [N s/m], (3, n); 0: fixed."""
    correlation: RealArray
    """Correlations of the free parameters, in the order of their mask, (p, p)."""


def compute_intervals(fit: ChainFit, is_noise_stated: bool) -> FitIntervals:
    """Compute the intervals of a fit.

    The deviations of the rows are taken as independent. If they are larger than the stated noise, they count with their
    own size, because the chain is then no exact model.

    Args:
        fit: Fitted chain.
        is_noise_stated: Whether the weights are the inverse standard deviations of the measurement; otherwise, the size
            of the noise follows from the residuals.

    Returns:
        Half-widths and correlations.
    """
    jacobian = fit.problem.value_jacobian(fit.values)
    scale = np.linalg.norm(jacobian, axis=0)
    scale[scale == 0] = 1.0
    _, singular, rows = np.linalg.svd(jacobian / scale, full_matrices=False)
    # A direction that the residuals do not feel has a singular value of rounding: its parameters are not determined.
    roots = rows / np.maximum(singular, np.finfo(float).eps * singular[0])[:, None]
    covariance = roots.T @ roots
    deviation = np.sqrt(np.diag(covariance))
    freedom = max(fit.size - fit.free_count, 1)
    noise = max(fit.variance_ratio, 1.0) if is_noise_stated else fit.variance_ratio
    half_width = np.zeros(fit.values.shape)
    half_width[fit.problem.free] = t.ppf((1 + INTERVAL_CONFIDENCE) / 2, freedom) * np.sqrt(noise) * deviation / scale
    return FitIntervals(half_width, covariance / np.outer(deviation, deviation))


def judge_parameters(fit: ChainFit, intervals: FitIntervals) -> list[list[Determination]]:
    """Determination of every parameter, in the order of `ChainFit.values`."""
    return [
        [
            "fixed"
            if not free
            else "determined"
            if width <= WEAK * value
            else "weakly_determined"
            if width < value
            else "not_distinguished_from_zero"
            for value, width, free in zip(*rows, strict=True)
        ]
        for rows in zip(fit.values, intervals.half_width, fit.problem.free, strict=True)
    ]

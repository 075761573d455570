"""Sobol indices: shares of the variance of a value that the random inputs cause, alone and with their interactions."""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.campaigns.evaluation.sample_statistics import CONFIDENCE

BOOTSTRAP_SAMPLES = 500
"""Number of bootstrap samples of an interval: its ends then vary by less than a tenth of its width."""

BOOTSTRAP_SEED = 1
"""Seed of the bootstrap, so that the same runs give the same intervals."""


@dataclass(frozen=True)
class VarianceShares:
    """Sobol indices of k inputs with their 95 % intervals."""

    first: RealArray
    """Index of first order, lower and upper end, (3, k): share of the variance that the input causes alone."""
    total: RealArray
    """Total index, lower and upper end, (3, k): share that vanishes if the input is fixed, interactions included."""


def estimate_sobol_indices(base: RealArray, other: RealArray, exchanged: RealArray) -> VarianceShares:
    """Estimate Sobol indices of the designs of Saltelli (2010).

    Args:
        base, other: Values of two independent sets of designs, A and B, (n,).
        exchanged: Values of the designs A whose input i is that of B, (n, k).

    Returns:
        First order by Saltelli et al. (2010), total by Jansen (1999), intervals by the bootstrap.
    """
    generator, n = np.random.default_rng(BOOTSTRAP_SEED), base.size
    samples = np.array(
        [_estimate(base[i], other[i], exchanged[i]) for i in generator.integers(0, n, (BOOTSTRAP_SAMPLES, n))]
    )
    ends = np.quantile(samples, [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2], axis=0)
    both = np.concatenate([_estimate(base, other, exchanged)[None], ends])
    return VarianceShares(both[:, 0], both[:, 1])


def _estimate(base: RealArray, other: RealArray, exchanged: RealArray) -> RealArray:
    """First and total indices, (2, k); the mean is removed, because it would add to their scatter."""
    everything = np.concatenate([base, other])
    mean, variance = everything.mean(), everything.var()
    difference = exchanged - base[:, None]
    first = np.mean((other - mean)[:, None] * difference, axis=0)
    total = np.mean(difference**2, axis=0) / 2
    return np.stack([first, total]) / (variance if variance > 0 else np.inf)

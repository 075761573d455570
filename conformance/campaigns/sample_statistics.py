"""Statistics of random designs: share of exceedances with its interval, and linear influence of the inputs."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from pantocheck.conformance.campaigns.campaign_columns import CampaignColumns, EvaluatedValue
from pantocheck.conformance.campaigns.campaign_design import SampleAxis
from pantocheck.conformance.core.array_types import IntegerArray, RealArray
from pantocheck.conformance.results.campaign_format import Estimate, InputShare, SobolIndices

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


# Sobol indices: shares of the variance of a value that the random inputs cause, alone and with their interactions.
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


# Evaluation of the designs of Saltelli (2010): Sobol indices, and the independent designs among them.
FEWEST_DESIGNS = 8
"""Fewest complete designs from which indices are estimated."""


def select_independent(columns: CampaignColumns, axis: SampleAxis) -> CampaignColumns:
    """Runs of the sets A and B, whose inputs are independent; the other sets repeat their inputs."""
    return columns.select(np.flatnonzero(_place(columns, axis)[1] < 2))


def build_indices(
    columns: CampaignColumns, values: Sequence[EvaluatedValue], grid_keys: Sequence[str], axis: SampleAxis
) -> Iterator[SobolIndices]:
    """Sobol indices of each value at each point of the grid, over the designs whose runs are all finished."""
    for name, numbers in columns.group(grid_keys).items():
        design, kind = (parts[numbers] for parts in _place(columns, axis))
        for value in values:
            table = np.full((axis.sampling.runs, len(axis.keys) + 2), np.nan)
            table[design, kind] = columns.values[value.column][numbers]
            complete = table[~np.isnan(table).any(axis=1)]
            if len(complete) < FEWEST_DESIGNS or np.ptp(complete) == 0:
                continue
            shares = estimate_sobol_indices(complete[:, 0], complete[:, 1], complete[:, 2:])
            yield SobolIndices(
                label=value.title,
                group=name,
                runs=len(complete),
                shares=[
                    InputShare(
                        input=key,
                        first=Estimate.model_validate(dict(zip(_PARTS, shares.first[:, i].tolist(), strict=True))),
                        total=Estimate.model_validate(dict(zip(_PARTS, shares.total[:, i].tolist(), strict=True))),
                    )
                    for i, key in enumerate(axis.keys)
                ],
            )


_PARTS = ("value", "low", "high")


def _place(columns: CampaignColumns, axis: SampleAxis) -> tuple[IntegerArray, IntegerArray]:
    """Number of the design in its set and number of the set of every run, from 0; the axis changes fastest."""
    place, sets = (columns.designs - 1) % len(axis), len(axis.keys) + 2
    return place // sets, place % sets

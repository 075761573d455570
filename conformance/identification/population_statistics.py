"""Statistics of a population of tests: interval of a median over tests, and variability against frequency."""

import numpy as np
import scipy.stats

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.population_format import OutlierSide, Variability

FEWEST = 4
"""Smallest number of values that have quartiles."""

REPLICATES = 1000
"""Number of redrawn populations for the interval of a median."""

REDRAW_SEED = 1
"""Seed of the redrawn populations, so that equal records give equal files."""


def median_interval(values: list[RealArray], deviations: list[RealArray]) -> tuple[float, float]:
    """95 % interval of the median over all values of all tests, by redrawing the tests (cluster bootstrap).

    The values of one test are not independent of each other, so that whole tests are redrawn. In each replicate every
    value also varies by its standard deviation.

    Args:
        values: Values of each test, each (n,).
        deviations: Standard deviations of the values of each test, each (n,).

    Returns:
        Quantiles of 2.5 % and 97.5 % of the median.

    References:
        [1] A. C. Davison, D. V. Hinkley, Bootstrap Methods and their Application, Cambridge University Press, 1997,
            section 3.8.
    """
    random = np.random.default_rng(REDRAW_SEED)
    tests = len(values)
    medians = []
    for _ in range(REPLICATES):
        drawn = random.integers(0, tests, tests)
        sample = np.concatenate([values[t] + deviations[t] * random.standard_normal(values[t].size) for t in drawn])
        medians.append(np.median(sample) if sample.size else np.nan)
    low, high = np.nanpercentile(medians, [2.5, 97.5])
    return float(low), float(high)


def measure_variability(groups: list[RealArray], sides: list[OutlierSide | None]) -> Variability:
    """Measure how the dispersion of damping ratios over tests depends on frequency.

    Args:
        groups: Damping ratios of all tests, in the order of the groups, each (n,); groups with fewer than four values
            are left out.
        sides: Side on which each value is an outlier.

    Returns:
        Dispersion against frequency, and share of the outliers that overestimate.
    """
    ranges = np.array([np.subtract(*np.percentile(values, [75, 25])) for values in groups if values.size >= FEWEST])
    outliers = [side for side in sides if side is not None]
    return Variability(
        groups=ranges.size,
        rank_correlation=rank_correlation(ranges),
        last_over_first=float(ranges[-1] / ranges[0]) if ranges.size > 1 and ranges[0] > 0 else None,
        outliers=len(outliers),
        outliers_above_share=outliers.count("above") / len(outliers) if outliers else None,
    )


def rank_correlation(values: RealArray) -> float | None:
    """Spearman's rank correlation of values with their order: -1 for a strict decrease.

    It is None for fewer than three values, and for equal values.
    """
    if values.size < 3 or np.ptp(values) == 0:
        return None
    return float(scipy.stats.spearmanr(np.arange(values.size), values).statistic)

"""Statistics of a population: interval of a median, and variability against frequency."""

import numpy as np
import pytest

from pantocheck.conformance.drops.population_analysis import measure_variability, median_interval, rank_correlation


def test_interval_of_one_test_is_that_of_its_standard_deviations() -> None:
    """One value of deviation 0.1: quantiles of a normal distribution; 1000 replicates give them to 0.1 deviations."""
    low, high = median_interval([np.array([2.0])], [np.array([0.1])])
    assert (low, high) == pytest.approx((2 - 0.196, 2 + 0.196), abs=0.015)


def test_interval_over_tests_reflects_their_differences() -> None:
    """Exact values of tests that differ: the interval of the median of five is at least that of their middle three."""
    tests = [np.full(3, value) for value in (1.0, 2.0, 3.0, 4.0, 5.0)]
    exact = [np.zeros(3)] * 5
    assert median_interval(tests, exact) == (1.0, 5.0)
    assert median_interval([tests[2]] * 5, exact) == (3.0, 3.0)
    assert median_interval(tests, exact) == median_interval(tests, exact)


def test_test_without_values_is_redrawn_like_the_others() -> None:
    assert median_interval([np.array([1.0]), np.zeros(0)], [np.zeros(1), np.zeros(0)]) == (1.0, 1.0)


@pytest.mark.parametrize(
    ("values", "correlation"),
    [([3.0, 2.0, 1.0], -1.0), ([1.0, 2.0, 4.0, 9.0], 1.0), ([4.0, 2.0, 3.0], -0.5)],
)
def test_rank_correlation(values: list[float], correlation: float) -> None:
    """Spearman: 1 - 6 sum d^2 / (n (n^2 - 1)); two values and equal values have none."""
    assert rank_correlation(np.array(values)) == pytest.approx(correlation)
    assert rank_correlation(np.array(values[:2])) is None
    assert rank_correlation(np.ones(4)) is None


def test_variability_uses_groups_with_quartiles() -> None:
    """Quartiles of 0..4 are 1 and 3: the ranges are 2, 1 and 0.5; the group of three values has none."""
    groups = [np.arange(5.0), np.arange(5.0) / 2, np.arange(3.0), np.arange(5.0) / 4]
    measured = measure_variability(groups, ["above", None, "below", "above", "above"])
    assert measured.groups == 3
    assert measured.rank_correlation == pytest.approx(-1)
    assert measured.last_over_first == pytest.approx(0.25)
    assert (measured.outliers, measured.outliers_above_share) == (4, 0.75)
    nothing = measure_variability([np.arange(3.0)], [None])
    assert (nothing.rank_correlation, nothing.last_over_first, nothing.outliers_above_share) == (None, None, None)

"""Statistics of random designs, checked where the answer is known: a linear model of normal inputs."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats

from pantocheck.conformance.campaigns.campaign_evaluation import estimate_exceedance
from pantocheck.conformance.campaigns.sample_statistics import linear_influences, mean_interval, wilson_interval

REPETITIONS, RUNS = 200, 150
COEFFICIENTS = np.array([3.0, -4.0])
"""A linear model of two standard normal inputs with these coefficients is normal with a standard deviation of 5."""


def linear_runs(seed: int) -> tuple[np.ndarray, np.ndarray]:
    inputs = np.random.default_rng(seed).standard_normal((RUNS, 2))
    return inputs, 100 + inputs @ COEFFICIENTS


@pytest.mark.parametrize(("count", "runs"), [(0, 20), (3, 20), (20, 20), (50, 1000)])
def test_interval_of_a_share_is_that_of_scipy(count: int, runs: int) -> None:
    expected = stats.binomtest(count, runs).proportion_ci(0.95, method="wilson")
    assert_allclose(wilson_interval(count, runs), (expected.low, expected.high), rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("limit", [100.0, 105.0, 108.0])
def test_intervals_cover_the_known_exceedance(limit: float) -> None:
    """With 200 repetitions, the share of a 95 % interval is between 91 and 98 %: 2.6 standard errors around 95 %."""
    exact = stats.norm.sf(limit, 100, 5)
    covered = 0
    for seed in range(REPETITIONS):
        estimate = estimate_exceedance(linear_runs(seed)[1] > limit)
        covered += estimate.low <= exact <= estimate.high
    assert 0.91 <= covered / REPETITIONS <= 0.98


def test_intervals_cover_the_known_mean() -> None:
    intervals = np.array([mean_interval(linear_runs(seed)[1]) for seed in range(REPETITIONS)])
    assert 0.91 <= np.mean((intervals[:, 0] <= 100) & (intervals[:, 1] >= 100)) <= 0.98


def test_influences_are_the_coefficients_of_a_linear_model() -> None:
    inputs, values = linear_runs(1)
    influences, determination = linear_influences(inputs, values)
    assert_allclose(influences, COEFFICIENTS * inputs.std(axis=0), rtol=1e-12)
    assert determination == pytest.approx(1, abs=1e-12)


def test_influences_state_the_part_of_a_quadratic_model_that_they_miss() -> None:
    """x + x^2 - 1 of a standard normal x has the variance 1 + 2, of which a line explains 1 in 3."""
    x = stats.norm.ppf((np.arange(2000) + 0.5) / 2000)
    influences, determination = linear_influences(x[:, None], x + x**2 - 1)
    assert_allclose(influences, [1.0], atol=1e-2)
    assert determination == pytest.approx(1 / 3, abs=5e-3)

"""Statistics of random designs, checked where the answer is known: a linear model of normal inputs."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats

from helpers.campaign_columns import build_columns
from pantocheck.conformance.campaigns.campaign_columns import CampaignColumns, EvaluatedValue
from pantocheck.conformance.campaigns.campaign_design import sample_inputs
from pantocheck.conformance.campaigns.campaign_evaluation import estimate_exceedance
from pantocheck.conformance.campaigns.campaign_file import InputSampling
from pantocheck.conformance.campaigns.sample_statistics import (
    build_indices,
    estimate_sobol_indices,
    linear_influences,
    mean_interval,
    select_independent,
    wilson_interval,
)

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


def test_influences_are_those_of_a_linear_model() -> None:
    inputs, values = linear_runs(1)
    influences, determination = linear_influences(inputs, values)
    assert_allclose(influences, COEFFICIENTS * inputs.std(axis=0), rtol=1e-12)
    assert determination == pytest.approx(1, abs=1e-12)
    # x + x^2 - 1 of a standard normal x has the variance 1 + 2, of which a line explains 1 in 3.
    x = stats.norm.ppf((np.arange(2000) + 0.5) / 2000)
    influences, determination = linear_influences(x[:, None], x + x**2 - 1)
    assert_allclose(influences, [1.0], atol=1e-2)
    assert determination == pytest.approx(1 / 3, abs=5e-3)
    # An input that does not vary has no influence.
    influences, _ = linear_influences(np.column_stack([x, np.ones(2000)]), x)
    assert_allclose(influences, [1.0, 0.0], atol=1e-2)
    # The sample 1, 2, 3 has a standard deviation of 1.
    assert_allclose(mean_interval(np.array([1.0, 2.0, 3.0])), 2 + stats.norm.ppf([0.025, 0.975]) / np.sqrt(3))
    intervals = np.array([mean_interval(linear_runs(seed)[1]) for seed in range(REPETITIONS)])
    assert 0.91 <= np.mean((intervals[:, 0] <= 100) & (intervals[:, 1] >= 100)) <= 0.98


# Sobol indices on the function of Ishigami, and their path from the designs to the estimate.


KEYS = ("x1", "x2", "x3")
ISHIGAMI_A, ISHIGAMI_B = 7.0, 0.1
VARIANCE = ISHIGAMI_A**2 / 8 + ISHIGAMI_B * np.pi**4 / 5 + ISHIGAMI_B**2 * np.pi**8 / 18 + 0.5
FIRST = np.array([0.5 * (1 + ISHIGAMI_B * np.pi**4 / 5) ** 2, ISHIGAMI_A**2 / 8, 0.0]) / VARIANCE
TOTAL = FIRST + np.array([1, 0, 1]) * ISHIGAMI_B**2 * np.pi**8 * (1 / 18 - 1 / 50) / VARIANCE
"""Exact indices of the function of Ishigami and Homma (1990)."""


def ishigami(x: np.ndarray) -> np.ndarray:
    return np.sin(x[..., 0]) + ISHIGAMI_A * np.sin(x[..., 1]) ** 2 + ISHIGAMI_B * x[..., 2] ** 4 * np.sin(x[..., 0])


def sample_ishigami(runs: int) -> tuple[CampaignColumns, list[EvaluatedValue], object]:
    """Finished campaign of Saltelli designs of the function."""
    uniform = {"kind": "uniform", "lower": -np.pi, "upper": np.pi}
    table = [{"key": key, "distribution": uniform} for key in KEYS]
    axis = sample_inputs(InputSampling.model_validate({"method": "saltelli", "runs": runs, "seed": 2, "input": table}))
    rows = [axis.row(i) for i in range(len(axis))]
    inputs = {key: tuple(row[key] for row in rows) for key in KEYS}
    value = EvaluatedValue("1.mean_force_N")
    numbers = ishigami(np.column_stack([inputs[key] for key in KEYS]))
    return build_columns(inputs, {value.column: numbers}), [value], axis


def test_indices_of_the_ishigami_function() -> None:
    """With 2048 designs per set, the estimates of a Sobol sequence are within 0.02 of the exact indices."""
    columns, values, axis = sample_ishigami(2048)
    (indices,) = build_indices(columns, values, (), axis)
    assert [share.input for share in indices.shares] == list(KEYS)
    assert_allclose([share.first.value for share in indices.shares], FIRST, atol=0.02)
    assert_allclose([share.total.value for share in indices.shares], TOTAL, atol=0.02)
    for share, first, total in zip(indices.shares, FIRST, TOTAL, strict=True):
        assert share.first.low - 1e-9 <= first <= share.first.high + 1e-9
        assert share.total.low - 1e-9 <= total <= share.total.high + 1e-9


def test_designs_that_are_not_finished_are_left_out_and_others_independent() -> None:
    """ISHIGAMI_A set of 64 designs of three inputs has 320 runs; without runs 6 to 10 the second design is missing."""
    columns, values, axis = sample_ishigami(64)
    some = columns.select(np.array([i for i in range(len(columns.cases)) if i // 5 != 1]))
    (indices,) = build_indices(some, values, (), axis)
    assert indices.runs == 63
    columns, _, axis = sample_ishigami(64)
    independent = select_independent(columns, axis)
    assert len(independent.cases) == 128
    assert len(set(independent.inputs["x1"])) == 128


def test_estimates_are_those_of_scipy() -> None:
    """The same estimators; scipy centres and normalises in the same way."""
    columns, values, _ = sample_ishigami(256)
    table = columns.values[values[0].column].reshape(256, 5)
    shares = estimate_sobol_indices(table[:, 0], table[:, 1], table[:, 2:])
    expected = stats.sobol_indices(
        func={"f_A": table[:, 0][None], "f_B": table[:, 1][None], "f_AB": table[:, 2:].T[:, None, :]}, n=256
    )
    assert_allclose(shares.first[0], expected.first_order, rtol=1e-9)
    assert_allclose(shares.total[0], expected.total_order, rtol=1e-9)


def test_estimates_are_those_of_salib() -> None:
    """The same estimators, centred with the mean of all designs in place of ISHIGAMI_A and ISHIGAMI_B."""
    # With 500 bootstrap samples the half-widths of both scatter by 5 %.
    sobol = pytest.importorskip("SALib.analyze.sobol", reason="SALib is optional: pip install 'pantocheck[peers]'")
    columns, values, _ = sample_ishigami(1024)
    table = columns.values[values[0].column].reshape(1024, 5)
    shares = estimate_sobol_indices(table[:, 0], table[:, 1], table[:, 2:])
    problem = {"num_vars": 3, "names": list(KEYS), "bounds": [[-np.pi, np.pi]] * 3}
    rows = np.column_stack([table[:, 0], table[:, 2:], table[:, 1]]).ravel()  # the order of its own samples
    expected = sobol.analyze(problem, rows, calc_second_order=False, num_resamples=500, seed=1)
    assert_allclose(shares.first[0], expected["S1"], atol=1e-6)
    assert_allclose(shares.total[0], expected["ST"], atol=1e-6)
    assert_allclose((shares.first[2] - shares.first[1]) / 2, expected["S1_conf"], rtol=0.15)
    assert_allclose((shares.total[2] - shares.total[1]) / 2, expected["ST_conf"], rtol=0.15)


@pytest.mark.parametrize("seed", range(3))
def test_interval_of_an_additive_model_contains_the_exact_share(seed: int) -> None:
    """3 x + 4 y of normal inputs: shares 0.36 and 0.64, first order and total alike."""
    points = np.random.default_rng(seed).standard_normal((1024, 4))
    base, other = points[:, :2], points[:, 2:]
    weights = np.array([3.0, 4.0])
    exchanged = np.column_stack([base @ weights + (other[:, i] - base[:, i]) * weights[i] for i in range(2)])
    shares = estimate_sobol_indices(base @ weights, other @ weights, exchanged)
    for estimate in (shares.first, shares.total):
        assert np.all(estimate[1] <= [0.36, 0.64])
        assert np.all(estimate[2] >= [0.36, 0.64])

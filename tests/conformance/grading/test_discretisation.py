"""Uncertainty from mesh and time step: known orders, oscillation, noise, and two meshes."""

import numpy as np
import pytest

from pantocheck.conformance.grading.case_evaluation import discretisation_half_width, observed_order

LIMIT = 50.0


def values(order: float, error: float) -> tuple[float, float, float]:
    """Values with steps doubled, as in the case, and halved, whose error is `error` h^order with h = 1 in the case."""
    coarse, value, fine = (LIMIT + error * step**order for step in (2.0, 1.0, 0.5))
    return coarse, value, fine


@pytest.mark.parametrize("order", [0.6, 1.0, 1.7, 2.0])
@pytest.mark.parametrize("error", [0.3, -0.3])
def test_observed_order_gives_the_error_times_the_safety_factor(order: float, error: float) -> None:
    """The extrapolation is exact for a pure power."""
    assert observed_order(*values(order, error)) == pytest.approx(order, rel=1e-9)
    assert discretisation_half_width(*values(order, error)) == pytest.approx(1.25 * 0.3, rel=1e-9)


@pytest.mark.parametrize("order", [2.5, 3.0, 3.9])
def test_order_above_two_is_taken_as_two(order: float) -> None:
    """Then the error is overestimated by at most a third: 4/3 against 1 + 1/(2^p - 1)."""
    coarse, value, fine = values(order, 0.3)
    half_width = discretisation_half_width(coarse, value, fine)
    assert half_width == pytest.approx(1.25 * 4 / 3 * abs(value - fine), rel=1e-12)
    assert 1.25 * 0.3 < half_width <= 1.25 * 4 / 3 * 0.3


@pytest.mark.parametrize(
    ("coarse", "value", "fine", "half_width"),
    [
        (50.4, 50.0, 50.3, 0.9),  # oscillates: three times 0.3
        (52.0, 50.0, 50.3, 1.5),  # oscillates, from a coarse mesh: three times a quarter of 2
        (50.1, 50.0, 49.8, 0.6),  # diverges, order -1: three times 0.2
        (50.21, 50.0, 49.8, 0.6),  # hardly converges, order 0.07
        (54.0, 50.0, 49.9, 3.0),  # order 5.3, more than the elements have: 0.1 is small by chance
        (50.0, 50.0, 50.3, 0.9),
        (51.2, 50.0, 50.0, 0.9),  # no change on the finer mesh alone is no proof of convergence
    ],
)
def test_difference_without_an_order_counts_more(coarse: float, value: float, fine: float, half_width: float) -> None:
    assert discretisation_half_width(coarse, value, fine) == pytest.approx(half_width, rel=1e-9)
    assert discretisation_half_width(-coarse, -value, -fine) == pytest.approx(half_width, rel=1e-9)


def test_difference_that_doubles_has_the_order_minus_one() -> None:
    assert observed_order(50.1, 50.0, 49.8) == pytest.approx(-1.0, rel=1e-9)
    assert observed_order(50.1, 50.0, 50.3) is None


def test_two_meshes_have_the_large_factor_and_equal_values_no_uncertainty() -> None:
    assert discretisation_half_width(None, 50.0, 49.9) == pytest.approx(0.3, rel=1e-9)
    assert discretisation_half_width(0.0, 0.0, 0.0) == 0.0
    assert discretisation_half_width(None, 0.0, 0.0) == 0.0


def test_interval_contains_the_limit_in_95_percent_of_noisy_sequences() -> None:
    """Second order with a noise of 5 % of the error on every mesh, and a third-order part of up to half of it."""
    # 4000 sequences give the share within 0.7 % (two standard deviations).
    random = np.random.default_rng(3)
    contained = []
    for _ in range(4000):
        third, noise = random.uniform(-0.15, 0.15), random.normal(0.0, 0.015, 3)
        steps = np.array([2.0, 1.0, 0.5])
        coarse, value, fine = LIMIT + 0.3 * steps**2 + third * steps**3 + noise
        contained.append(abs(value - LIMIT) <= discretisation_half_width(coarse, value, fine))
    assert np.mean(contained) > 0.95

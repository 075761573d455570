"""Factors from the Gram matrix against Householder's method and singular values, also for dependent columns."""

import numpy as np
import pytest
import scipy.linalg

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.drops.projection import eliminate_columns, factor_columns, solve_factor, solve_least_squares


def columns_with_condition(condition: float, seed: int = 1) -> RealArray:
    """120 x 12 columns of very different lengths; scaled to unit length, their condition number is about as given."""
    random = np.random.default_rng(seed)
    left, right = (scipy.linalg.qr(random.standard_normal((n, 12)), mode="economic")[0] for n in (120, 12))
    return np.asarray(left * np.geomspace(1, 1 / condition, 12) @ right.T * np.geomspace(1e-3, 1e5, 12))


@pytest.mark.parametrize("condition", [1.0, 1e2, 1e4, 1e5, 1e7, 1e12])
def test_factors_are_those_of_householder(condition: float) -> None:
    """Both are orthogonal and reproduce the columns to rounding, also where the Gram matrix is not used (from 1e6)."""
    columns = columns_with_condition(condition)
    q, r = factor_columns(columns)
    assert q.T @ q == pytest.approx(np.eye(12), abs=1e-13)
    length = np.linalg.norm(columns, axis=0)
    assert q @ r / length == pytest.approx(columns / length, abs=1e-13)
    assert np.tril(r, -1) == pytest.approx(0, abs=0)


@pytest.mark.parametrize("condition", [1.0, 1e2, 1e4, 1e5])
def test_solution_is_that_of_singular_values(condition: float) -> None:
    """The error of either is the condition number times rounding, of the coefficients of columns of unit length."""
    columns, x = columns_with_condition(condition), np.random.default_rng(2).standard_normal((120, 3))
    length = np.linalg.norm(columns, axis=0)
    expected = np.linalg.lstsq(columns / length, x, rcond=None)[0]
    tolerance = 1e-14 * condition * np.abs(expected).max()
    solution, residual = solve_least_squares(columns, x)
    assert solution * length[:, None] == pytest.approx(expected, abs=tolerance)
    assert residual == pytest.approx(x - columns / length @ expected, abs=tolerance)
    q, r = factor_columns(columns)
    assert solve_factor(r, q.T @ x) * length[:, None] == pytest.approx(expected, abs=tolerance)


@pytest.mark.parametrize("repeat", [0.0, 1.0])
def test_dependent_columns_have_the_smallest_solution(repeat: float) -> None:
    """A column of zeros, or a repeated one: the coefficients are those of the pseudo-inverse."""
    columns = np.random.default_rng(3).standard_normal((50, 4))
    columns[:, 3] = repeat * columns[:, 0]
    x = np.random.default_rng(4).standard_normal((50, 2))
    assert solve_least_squares(columns, x)[0] == pytest.approx(np.linalg.pinv(columns) @ x, abs=1e-13)


@pytest.mark.parametrize(("condition", "tolerance"), [(1.0, 1e-9), (1e4, 1e-9), (1e5, 1e-9), (1e7, 1e-4), (1e12, 1e-9)])
def test_products_of_remainders_are_those_of_householder(condition: float, tolerance: float) -> None:
    """A remainder has an error of 1e-16 times the squared condition number; its products have the square of that.

    That is 1e-4 at 1e7, below which the Gram matrix is used. One signal lies in the span of the columns up to 1e-6 of
    its length, as the derivative of a fast decay; the rounding of this signal is 1e-10 of its remainder.
    """
    columns, random = columns_with_condition(condition), np.random.default_rng(5)
    others = random.standard_normal((120, 3))
    length = np.linalg.norm(columns, axis=0)
    others[:, 0] = (columns / length).sum(axis=1) + 1e-6 * others[:, 0]
    q = scipy.linalg.qr(columns, mode="economic")[0]
    expected = others - q @ (q.T @ others)
    expected -= q @ (q.T @ expected)
    remainder = eliminate_columns(columns, others, others).remainder
    size = np.linalg.norm(expected, axis=0)
    assert (remainder.T @ remainder) / np.outer(size, size) == pytest.approx(
        expected.T @ expected / np.outer(size, size), abs=tolerance
    )

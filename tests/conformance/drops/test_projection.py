"""Spectral blocks of the output error: their lines, and the noise that a fit of them gives."""

import numpy as np
import pytest
import scipy.linalg

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.projection import (
    build_block,
    eliminate_columns,
    estimate_noise,
    factor_columns,
    residue_spread,
    solve_factor,
    solve_least_squares,
    solve_residues,
    whiten,
)

DT, N = 0.05, 400


@pytest.mark.parametrize(
    ("low", "high", "first", "last"), [(0.3, 4.0, 6, 80), (0.31, 4.04, 7, 80), (0.0, 4.0, 1, 80), (0.3, 30.0, 6, 199)]
)
def test_block_holds_the_lines_of_its_band(low: float, high: float, first: int, last: int) -> None:
    """Lines at multiples of 1 / 20 s from the lower to the upper edge; neither the offset nor the Nyquist line."""
    samples = np.random.default_rng(1).standard_normal((N, 2)) + np.array([5.0, -3.0])
    block = build_block(samples, DT, low, high)
    assert (block.lines[0], block.lines[-1], block.lines.size) == (first, last, last - first + 1)
    assert block.omega == pytest.approx(2 * np.pi * block.lines / 20.0)
    assert block.duration == pytest.approx(20.0)
    assert block.spectrum == pytest.approx(np.fft.rfft(samples, axis=0)[first : last + 1], abs=1e-9)


def test_noise_is_that_of_the_record_whatever_is_fitted() -> None:
    """White noise of std s has std s sqrt(n / 2) in either part of a line."""
    # Median of 48 lines, of which 12 residual terms and 3 poles take a fifth: 400 channels give it to 1 %; the median
    # of few lines is biased by about 1 / (2 * 48).
    noise, n = np.array([0.1, 3.0]), 800
    random = np.random.default_rng(2)
    samples = np.tile(noise, 200) * random.standard_normal((n, 400))
    poles = np.array([-0.02 + 3.0j, -0.02 + 5.0j, -0.02 + 7.0j])
    block = build_block(samples, DT, 0.3, 1.5)
    for present in (poles[:0], poles):
        level = estimate_noise(solve_residues(present, block), present.size, block)
        assert np.mean(level.reshape(200, 2), axis=0) == pytest.approx(noise * np.sqrt(n / 2), rel=0.03)


def test_spread_of_residues_is_that_of_repeated_noise() -> None:
    """Residues of 2000 channels of unit noise: their standard deviation is known to 1.6 %; five times that."""
    random = np.random.default_rng(3)
    block = build_block(random.standard_normal((N, 2000)), DT, 0.3, 4.0)
    block = whiten([block], [np.full(2000, np.sqrt(N / 2))])[0]
    poles = np.array([-0.03 + 6.0j, -0.2 + 6.4j, -0.05 + 15.0j])
    residues = solve_residues(poles, block).residues
    measured = np.sqrt((np.var(residues.real, axis=1) + np.var(residues.imag, axis=1)) / 2)
    assert measured == pytest.approx(residue_spread(poles, block), rel=0.08)


def test_too_few_lines_for_the_modes_are_refused() -> None:
    """Residues of 3 poles and 12 residual terms are 18 unknowns; 8 lines give 16 equations, and 9 lines give 18."""
    samples = np.random.default_rng(4).standard_normal((N, 2))
    poles = np.array([-0.02 + 3.0j, -0.02 + 5.0j, -0.02 + 7.0j])
    enough = build_block(samples, DT, 0.3, 0.701)
    assert (enough.lines.size, enough.residual_terms.shape[1]) == (9, 12)
    solve_residues(poles, enough)
    with pytest.raises(InputError, match="8 spectral lines in the band, too few for 3 modes"):
        solve_residues(poles, build_block(samples, DT, 0.3, 0.651))


# Factors from the Gram matrix against Householder's method and singular values, also for dependent columns.
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
    """A remainder has an error of 1e-16 times the squared condition number; its products have the square of that."""
    # That is 1e-4 at 1e7, below which the Gram matrix is used. One signal lies in the span of the columns up to 1e-6 of
    # its length, as the derivative of a fast decay; the rounding of this signal is 1e-10 of its remainder.
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

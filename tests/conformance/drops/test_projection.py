"""Spectral blocks of the output error: their lines, and the noise that a fit of them gives."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.decay_kernel import far_pole_columns
from pantocheck.conformance.drops.elimination import (
    StoredColumns,
    factor_columns,
    prepare_elimination,
    solve_factor,
    solve_least_squares,
)
from pantocheck.conformance.drops.model_order import (
    crowded_poles,
    find_best_candidate,
    pole_contributions,
    restrict_fit,
)
from pantocheck.conformance.drops.projection import (
    DataBlock,
    build_block,
    estimate_noise,
    residue_deviation,
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
    assert measured == pytest.approx(residue_deviation(poles, block), rel=0.08)


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
    remainder = prepare_elimination(StoredColumns(columns)).solve(others, 1)[1]
    size = np.linalg.norm(expected, axis=0)
    assert (remainder.T @ remainder) / np.outer(size, size) == pytest.approx(
        expected.T @ expected / np.outer(size, size), abs=tolerance
    )


# Local fit around a frequency, and the trial poles and contributions that it gives.


def build_data(poles: ComplexArray, duration: float, channels: int = 2, seed: int = 1) -> DataBlock:
    """Block of decays without noise."""
    random = np.random.default_rng(seed)
    residues = random.standard_normal((poles.size, channels)) + 1j * random.standard_normal((poles.size, channels))
    samples = 2 * (np.exp(np.outer(np.arange(round(duration / DT)) * DT, poles)) @ residues).real
    return build_block(np.asarray(samples), DT, 0.3, 6.0)


def test_neighbourhood_reaches_to_150_mHz_and_twelve_lines() -> None:
    """200 s: 0.15 Hz are 0.942 rad/s, more than twelve lines. 60 s: twelve lines are 0.2 Hz, 1.257 rad/s."""
    centre = 10.0
    poles = -0.05 + 1j * (centre + np.array([-1.27, -1.24, -0.95, -0.93, 0.0, 0.93, 0.95, 1.24, 1.27]))
    for durations, inside in (((200.0,), 3), ((60.0,), 7), ((200.0, 60.0), 7)):
        blocks = [build_data(poles, duration) for duration in durations]
        local = restrict_fit(poles, blocks, [solve_residues(poles, block) for block in blocks], centre)
        assert (local.near.sum(), local.poles.size, len(local.blocks)) == (inside, inside, len(blocks))
        wide = restrict_fit(poles, blocks, [solve_residues(poles, block) for block in blocks], centre, 1.26)
        assert wide.near.sum() == 7
    lines = local.blocks[1].omega - centre
    step = 2 * np.pi / 60.0
    assert np.abs(lines).max() == pytest.approx(18 * step, abs=step)


def test_local_lines_hold_the_near_decays_alone() -> None:
    """Lines minus the distant poles are those of a record with the near poles only; an exact fit, so rounding."""
    centre = 10.0
    poles = np.array([-0.05 + 5.0j, -0.04 + 9.9j, -0.03 + 10.2j, -0.06 + 15.0j])
    block = build_data(poles, 100.0)
    fit = solve_residues(poles, block)
    local = restrict_fit(poles, [block], [fit], centre)
    (data,) = local.blocks
    exact = solve_residues(local.poles, data)
    assert np.abs(exact.residual).max() < 1e-8 * np.abs(data.spectrum).max()
    assert exact.residues == pytest.approx(fit.residues[1:3], rel=1e-6)
    assert restrict_fit(poles, [block], [fit], 200.0).blocks == []


def test_best_candidate_lies_on_the_grid_of_a_quarter_line() -> None:
    """A missing pole at 5/4 lines beside the centre, with the decay rate of its neighbour."""
    duration, centre = 100.0, 10.0
    missing = -0.05 + 1j * (centre + 1.25 * 2 * np.pi / duration)
    poles = np.array([-0.05 + 9.6j, missing])
    short, long = build_data(poles, 60.0), build_data(poles, duration, seed=2)
    blocks = [short, long]
    local = restrict_fit(poles[:1], blocks, [solve_residues(poles[:1], block) for block in blocks], centre)
    candidate = find_best_candidate(local, centre)
    assert candidate[0] == pytest.approx(missing, rel=1e-12)
    assert candidate[1] > 0
    alone = restrict_fit(poles[:0], [long], [solve_residues(poles[:0], long)], centre)
    nothing = replace(alone, blocks=[replace(alone.blocks[0], spectrum=0 * alone.blocks[0].spectrum)])
    assert find_best_candidate(nothing, centre) is None


def test_crowded_poles_and_contributions() -> None:
    """The other poles fixed: the squared error of a fit without the pole; the complete fit has none."""
    poles = np.array([-0.05 + 5.0j, -0.04 + 9.9j, -0.03 + 10.2j])
    blocks = [build_data(poles, 100.0), build_data(poles, 60.0, 3, seed=2)]
    for j, contribution in enumerate(pole_contributions(poles, blocks)):
        others = np.delete(poles, j)
        without = sum(np.sum(np.abs(solve_residues(others, block).residual) ** 2) for block in blocks)
        assert contribution == pytest.approx(without, rel=1e-6)
    line = 2 * np.pi / 100.0
    poles = -0.05 + 1j * np.array([5.0, 5.0 + 1.4 * line, 8.0, 8.0 + 1.6 * line])
    blocks = [build_data(poles, duration) for duration in (40.0, 100.0)]
    assert list(crowded_poles(poles, blocks)) == [True, True, False, False]
    assert list(crowded_poles(poles[:1], blocks)) == [False]


def test_lines_must_determine_the_local_poles_and_one_more() -> None:
    """Nine lines at the edge of the band hold 18 equations; a pole takes two, the distant modes the others."""
    block = build_data(np.array([-0.02 + 2j * np.pi]), 60.0)
    lines, no_poles = 9, np.zeros(0, dtype=np.complex128)
    terms = far_pole_columns(block.omega[:lines], 2)
    edge = DataBlock(block.lines[:lines], block.spectrum[:lines], block.dt, block.n, terms)
    centre = float(edge.omega.mean())
    spare = 2 * lines - terms.shape[1]
    for count, expected in ((spare // 2 - 1, 1), (spare // 2, 0)):
        poles = -0.02 + 1j * (centre + 0.01 * np.arange(count))
        fit = replace(solve_residues(no_poles, edge), residues=np.zeros((count, 2), dtype=complex))
        assert len(restrict_fit(poles, [edge], [fit], centre).blocks) == expected

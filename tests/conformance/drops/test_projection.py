"""Spectral blocks of the output error: their lines, and the noise that a fit of them gives."""

import numpy as np
import pytest

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.projection import build_block, estimate_noise, residue_spread, solve_residues, whiten

DT, N = 0.05, 400


@pytest.mark.parametrize(
    ("low", "high", "first", "last"),
    [(0.3, 4.0, 6, 80), (0.31, 4.04, 7, 80), (0.0, 4.0, 1, 80), (0.3, 30.0, 6, 199)],
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
    """White noise of std s has std s sqrt(n / 2) in either part of a line.

    Median of 48 lines, of which 12 residual terms and 3 poles take a fifth: 400 channels give it to 1 %; the median of
    few lines is biased by about 1 / (2 * 48).
    """
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

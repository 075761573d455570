"""Benchmark of the fit in two stages: modes sampled by their covariance."""

from dataclasses import replace

import numpy as np
import pytest

from pantocheck.conformance.drops.line_evidence import build_intervals
from verification.tables.field_bound import compute_smallest_widths
from verification.tables.field_coverage import HIGHEST
from verification.tables.sampled_modes import ROWS, SampledLine, build_sampled_line, find_smallest, sample_fit


@pytest.fixture(scope="module")
def line() -> SampledLine:
    return build_sampled_line(ROWS["none"], 1)


def test_fit_of_the_true_modes_is_the_line(line: SampledLine) -> None:
    """The true poles are those of the simulator in its discrete time, which changes damping ratios by up to 0.05 %."""
    assert line.fit.factors[:2] == pytest.approx(np.ones(2), abs=2e-5)
    assert line.fit.values == pytest.approx(line.true, rel=0.005)
    assert len(line.fit.linear.matched.pairs) > 30


@pytest.mark.parametrize(("scatter", "widest"), [(0.0, 2.6), (0.005, 1.3)])
def test_intervals_of_sampled_modes_contain_the_truth(line: SampledLine, scatter: float, widest: float) -> None:
    """20 draws of 4 coefficients, which are correlated; the table has more, with median widths of 2.1 and 1.06."""
    inside, ratio = [], []
    for draw in range(20):
        fit = sample_fit(line, scatter, np.random.default_rng(draw))
        low, high = build_intervals(fit)
        inside.append((low <= line.true) & (line.true <= high))
        ratio.append((high - low) / 2 / find_smallest(line, scatter))
    assert np.mean(inside) > 0.88
    assert 0.9 < np.median(ratio) < widest


def test_covariance_of_the_modes_follows_the_noise(line: SampledLine) -> None:
    double = compute_smallest_widths(replace(line.field, noise=2 * line.field.noise), HIGHEST)
    assert double.covariance == pytest.approx(4 * line.widths.covariance, rel=1e-6)

"""A copy with small changes is found; independent runs and the computed measurements of the example are none."""

import numpy as np
import pytest

from pantocheck.conformance.comparison.force_likeness import ForceLikeness, correlate_at_best


def test_correlation_is_that_of_the_best_shift() -> None:
    """A copy shifted by 7 of 4000 samples loses 7 products; noise of variance v leaves 1 / sqrt(1 + v)."""
    force = np.random.default_rng(1).standard_normal(4000)
    assert correlate_at_best(force, 3.0 * force + 5.0) == pytest.approx(1.0)
    assert correlate_at_best(np.roll(force, 7), force) == pytest.approx(1.0, abs=0.01)
    noise = np.random.default_rng(2).standard_normal(4000)
    assert correlate_at_best(force, force + 0.5 * noise) == pytest.approx(1 / np.sqrt(1.25), abs=0.02)
    assert correlate_at_best(force, noise) < 0.1
    assert correlate_at_best(force, np.ones(4000)) == 0.0


@pytest.mark.parametrize(
    ("correlation", "residual", "copy"),
    [(0.9901, 5.0, True), (0.99, 5.0, False), (0.5, 0.99, True), (0.5, 1.0, False)],
)
def test_either_number_shows_a_copy(correlation: float, residual: float, copy: bool) -> None:
    assert ForceLikeness(1, correlation, residual).is_copy is copy

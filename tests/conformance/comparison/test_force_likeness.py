"""A copy with small changes is found; independent runs and the computed measurements of the example are none."""

from dataclasses import replace

import numpy as np
import pytest

from pantocheck.conformance.comparison.force_difference import (
    COPY_CORRELATION,
    REPEATED_CORRELATION,
    ForceLikeness,
    measure_likeness,
    measure_remainder,
)
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals
from verification.tables.copy_thresholds import make_copies

RATE, SPEED, STD_N = 2000.0, 80.0, 80.0
"""Samples per second [Hz], speed [m/s], and standard deviation of a force over an irregular wire [N]."""


def make_signals(seed: int) -> PantographSignals:
    """A force that is white up to 50 Hz, over 500 m."""
    position = SPEED / RATE * np.arange(16000)
    noise = Filter().change_cutoff(50.0)(np.random.default_rng(seed).standard_normal(16000), RATE)
    force = 120.0 + STD_N * noise / noise.std()
    return PantographSignals(position, ForceChannel(force, RATE, Filter()), (50.0, 550.0))


def test_remainder_is_that_of_the_best_shift() -> None:
    """A shifted copy leaves nothing; noise of variance v leaves sqrt(v / (1 + v)) of the standard deviation."""
    force, noise = (np.random.default_rng(seed).standard_normal(4000) for seed in (1, 2))
    assert measure_remainder(force, 3.0 * force + 5.0) == pytest.approx(0.0, abs=1e-5)
    assert measure_remainder(np.roll(force, 7), force) == pytest.approx(0.0, abs=1e-5)
    assert measure_remainder(force, force + 0.5 * noise) == pytest.approx(np.sqrt(0.2), abs=0.02)
    assert measure_remainder(force, noise) > 0.99
    assert measure_remainder(force, np.ones(4000)) == 1.0


def test_copies_are_found_and_another_passage_is_not() -> None:
    """Noise of 0.5 N, a gain, a shift of 2 m, another rate, and all of them; noise of 5 N hides a repeated run."""
    signals = make_signals(1)
    other = measure_likeness(1, signals, make_signals(2))
    assert other is not None
    assert not other.exceeds(0.5)
    for name, copy in make_copies(signals, (3,)):
        likeness = measure_likeness(1, signals, copy)
        assert likeness is not None
        assert likeness.exceeds(COPY_CORRELATION)
        assert likeness.exceeds(REPEATED_CORRELATION) == (name != "noise of 5 N"), name


def test_force_known_below_50_hz_is_not_compared() -> None:
    signals = make_signals(1)
    filtered = replace(signals, force=replace(signals.force, filter_applied_Hz=20.0))
    assert measure_likeness(1, signals, filtered) is None


@pytest.mark.parametrize(
    ("correlation", "residual", "copy"),
    [(0.9901, 5.0, True), (0.99, 5.0, False), (0.5, 0.99, True), (0.5, 1.0, False)],
)
def test_either_number_shows_a_copy(correlation: float, residual: float, copy: bool) -> None:
    assert ForceLikeness(1, correlation, residual).exceeds(0.99) is copy

"""Block bootstrap: its intervals have the stated coverage, and a short record has none."""

from dataclasses import replace

import numpy as np
import pytest

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.filters import LowPass
from pantocheck.conformance.quantities.signals import ForceChannel, PantographSignals
from pantocheck.conformance.records.measured.block_bootstrap import bootstrap_uncertainties

RATE, SPEED, SPAN = 100.0, 60.0, 60.0  # a span a second
DIGEST = "9f" * 32


def force_signals(force: RealArray, filter_applied_Hz: float | None = None) -> PantographSignals:
    position = np.arange(force.size) * SPEED / RATE
    channel = ForceChannel(force, RATE, LowPass(), filter_applied_Hz)
    return PantographSignals(position, channel, (position[0], position[-1]))


def spans(random: np.random.Generator, count: int) -> RealArray:
    """A sine per span whose amplitude varies from span to span, and slow noise: mean 120, sigma known."""
    amplitude = 30 * (1 + 0.3 * random.standard_normal(count))
    phase = np.arange(count * 100) / 100
    noise = np.repeat(random.standard_normal(count * 4), 25) * 8
    return 120 + np.repeat(amplitude, 100) * np.sin(2 * np.pi * phase) + noise


SIGMA = np.sqrt(30**2 * (1 + 0.3**2) / 2 + 8**2)


@pytest.mark.parametrize("count", [20, 60])
def test_intervals_of_95_percent_cover_the_truth(count: int) -> None:
    """400 records give the coverage within 2.2 % (two standard deviations). A block bootstrap of few blocks is known to
    stay some percent below 95 %, because the distribution of sigma is skewed: 90 % is acceptable, less is a defect."""
    random = np.random.default_rng(4)
    hits = np.zeros(2)
    for i in range(400):
        signals = force_signals(spans(random, count), filter_applied_Hz=20.0)
        found = bootstrap_uncertainties(signals, SPAN / SPEED, f"{i:064x}"[::-1])
        hits += [
            abs(signals.delivered.mean() - 120) < found["mean_force_N"],
            abs(signals.graded.std() - SIGMA) < found["std_force_N"],
        ]
    assert np.all(hits / 400 > 0.88)
    assert np.all(hits / 400 < 0.985)


def test_uncertainty_decreases_with_the_root_of_the_length() -> None:
    random = np.random.default_rng(5)
    short, long = (
        bootstrap_uncertainties(force_signals(spans(random, count), filter_applied_Hz=20.0), 1.0, DIGEST)
        for count in (40, 640)
    )
    for name in ("mean_force_N", "std_force_N", "statistical_min_N", "cov_20"):
        assert short[name] / long[name] == pytest.approx(4, rel=0.35)  # an estimate from 40 blocks is off by a fifth


def test_same_record_has_the_same_uncertainty_and_another_digest_another() -> None:
    signals = force_signals(spans(np.random.default_rng(6), 50))
    first = bootstrap_uncertainties(signals, 1.0, DIGEST)
    assert first == bootstrap_uncertainties(signals, 1.0, DIGEST)
    assert first != bootstrap_uncertainties(signals, 1.0, "ab" * 32)
    assert set(first) >= {"max_force_N", "min_force_N", "contact_loss_pct", "cov_20"}


def test_short_record_has_no_uncertainty() -> None:
    assert bootstrap_uncertainties(force_signals(spans(np.random.default_rng(7), 4)), 1.0, DIGEST) == {}
    cut_short = replace(
        force_signals(spans(np.random.default_rng(7), 40)), section=(0.0, 3000.0)
    )  # 40 spans are 2400 m
    assert bootstrap_uncertainties(cut_short, 1.0, DIGEST) == {}

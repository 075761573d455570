"""Differences of two forces: sums of sines whose bands, coherence and profile are known."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from pantocheck.conformance.comparison.force_difference import (
    PairedForces,
    coherence,
    compare_force_bands,
    compare_spans,
    correlation,
    pair_forces,
    span_profile,
)
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals
from pantocheck.conformance.quantities.unavailable import SectionNotCovered

Force = Callable[[RealArray], RealArray]

SPEED = 75.0
SPAN = 50.0
SECTION = (200.0, 800.0)


def signals(
    force: Force, rate: float, section: tuple[float, float] = SECTION, filtered: float | None = None
) -> PantographSignals:
    """Signals of a run whose force [N] is a function of the time since 0 m [s]."""
    time = np.arange(int(1000 / SPEED * rate)) / rate
    return PantographSignals(SPEED * time, ForceChannel(force(time), rate, Filter(), filtered), section)


def tone(frequency: float, amplitude: float, phase: float = 0.0) -> Force:
    return lambda time: amplitude * np.sin(2 * np.pi * frequency * time + phase)


def base(time: RealArray) -> RealArray:
    return 120 + tone(1.5, 20)(time) + tone(9, 8)(time) + tone(33, 5)(time)


@pytest.mark.parametrize("rates", [(1000.0, 1000.0), (1000.0, 200.0), (200.0, 640.0), (2000.0, 137.0)])
def test_one_force_at_two_rates_has_no_difference(rates: tuple[float, float]) -> None:
    """Interpolation error of a 33 Hz part of 5 N at 137 samples per second, and filters at two rates."""
    forces = pair_forces(*(signals(base, rate) for rate in rates))
    # Interpolation from 137 samples per second: at most 1 % of the 5 N at 33 Hz.
    assert np.abs(forces.difference).max() < 0.05
    assert correlation(forces) > 0.9999
    assert correlation(replace(forces, second=np.full(forces.second.size, 120.0))) == 0
    assert forces.rate == max(rates)


def test_bands_of_a_known_difference() -> None:
    """A second force with 30 % more at 1.5 Hz and a 9 Hz part in quadrature; the RMS of a sine is amplitude/sqrt 2."""

    def other(time: RealArray) -> RealArray:
        return 121 + tone(1.5, 26)(time) + tone(9, 8, np.pi / 2)(time) + tone(33, 5)(time)

    low, middle, high = compare_force_bands(pair_forces(signals(base, 1000.0), signals(other, 1000.0)))
    root = np.sqrt(2)
    assert (low.first_N, low.other_N, low.difference_N) == pytest.approx((20 / root, 26 / root, 6 / root), rel=2e-3)
    assert (middle.first_N, middle.other_N) == pytest.approx((8 / root, 8 / root), rel=5e-3)
    assert middle.difference_N == pytest.approx(8, rel=5e-3)  # two sines in quadrature: amplitude 8 sqrt 2
    assert (high.low_Hz, high.high_Hz) == (20, 50)
    assert high.difference_N < 0.02
    forces = pair_forces(signals(base, 1000.0), signals(base, 1000.0, filtered=20.0))
    assert forces.highest_Hz == 20
    assert [band.high_Hz for band in compare_force_bands(forces)] == [5, 20]


def test_coherence_is_one_for_a_common_part_and_low_for_independent_noise() -> None:
    """Common noise up to 12 Hz, independent noise above: the chance level is that of 5 % of the frequencies."""
    rng = np.random.default_rng(3)
    low_pass = Filter(order=8, cutoff_Hz=12.0)
    # Noise on a grid of 1 kHz, so that every run has the same samples of the common part.
    noise = rng.normal(0, 30, (3, 20000))
    common = low_pass(noise[0], 1000.0)

    def run(own: RealArray) -> Force:
        return lambda time: 120 + common[: time.size] + (own - low_pass(own, 1000.0))[: time.size]

    found = coherence(pair_forces(signals(run(noise[1]), 1000.0), signals(run(noise[2]), 1000.0)))
    assert found.value[(found.frequency > 1) & (found.frequency < 8)].min() > 0.9
    above = found.value[found.frequency > 20]
    assert 0 < found.frequency.min() < found.frequency.max() <= 50
    assert found.segments == 8  # 600 m at 75 m/s: 8 s
    # 5 % of about 30 independent frequencies: at most 5 with a probability of 99 %
    assert np.mean(above > found.chance_level) < 0.17


def test_differences_along_the_spans() -> None:
    """A force that differs by 4 N in the middle third of every span, and by 10 N more in one span."""

    def other(time: RealArray) -> RealArray:
        x = SPEED * time
        place = (x % SPAN) / SPAN
        return base(time) + 4.0 * ((place > 1 / 3) & (place < 2 / 3)) + 10.0 * ((x >= 400) & (x < 450))

    first, second = (signals(force, 1000.0) for force in (base, other))
    position = first.position[first.inside]
    # Without a filter, so that the steps stay steps.
    forces = PairedForces(position, first.delivered, second.delivered, 1000.0, 50.0)
    supports = np.arange(150.0, 901.0, SPAN)
    spans = compare_spans(forces, supports)
    assert [(span.start_m, span.end_m) for span in spans][0::11] == [(200.0, 250.0), (750.0, 800.0)]
    means = {span.start_m: span.mean_difference_N for span in spans}
    assert means[400.0] == pytest.approx(10 + 4 / 3, abs=0.02)  # a sample is 0.075 m of 50 m
    assert means[300.0] == pytest.approx(4 / 3, abs=0.02)
    profile = span_profile(forces, supports)
    assert profile is not None
    assert profile.mean[12] - profile.mean[2] == pytest.approx(4, abs=0.02)  # one sample of 332 at an edge
    assert profile.place[12] == pytest.approx(12.5 / 24)


def test_sections_without_a_common_stretch_or_span_are_not_compared() -> None:
    with pytest.raises(SectionNotCovered, match="no common stretch"):
        pair_forces(signals(base, 1000.0), signals(base, 1000.0, section=(900.0, 950.0)))
    run = signals(base, 1000.0)
    assert span_profile(pair_forces(run, run), [500.0]) is None
    assert compare_spans(pair_forces(run, run), [100.0, 500.0]) == ()

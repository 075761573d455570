"""Low-pass filter: -3 dB point, slope, phase and stability follow from its definition."""

from contextlib import nullcontext
from typing import Literal

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import butter, freqz

from pantocheck.conformance.quantities.filters import CUTOFF_TOLERANCE, Filter, needs_filter
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel
from pantocheck.conformance.quantities.unavailable import AlreadyFiltered, BandNotObservable

RATE = 1000.0


def measured_gain(low_pass: Filter, frequency: float, rate: float = RATE) -> float:
    """Amplitude of a filtered sine, far from the ends; 10 s hold whole periods of the frequencies used."""
    time = np.arange(int(10 * rate)) / rate
    filtered = low_pass(np.sin(2 * np.pi * frequency * time), rate)
    middle = slice(int(4 * rate), int(6 * rate))
    return float(np.sqrt(2) * filtered[middle].std())


@pytest.mark.parametrize("phase", ["zero", "causal"])
@pytest.mark.parametrize("order", [2, 4, 6, 8])
@pytest.mark.parametrize("cutoff", [20.0, 50.0])
def test_whole_filter_has_half_power_at_its_cutoff(phase: Literal["zero", "causal"], order: int, cutoff: float) -> None:
    low_pass = Filter(order=order, cutoff_Hz=cutoff, phase=phase)
    # The bilinear transform is pre-warped at the cut-off, so only rounding is left.
    assert_allclose(low_pass.gain(np.array([cutoff]), RATE), np.sqrt(0.5), rtol=1e-9)
    # Measured on a sine: transients after 4 s are far below the tolerance.
    assert_allclose(measured_gain(low_pass, cutoff), np.sqrt(0.5), rtol=1e-6)


@pytest.mark.parametrize("phase", ["zero", "causal"])
@pytest.mark.parametrize("order", [4, 6])
def test_slope_is_the_total_order(phase: Literal["zero", "causal"], order: int) -> None:
    """Six decibels per octave and order; at 10 kHz, 80 to 160 Hz is far from the bilinear transform's warping (1 %)."""
    low, high = Filter(order=order, phase=phase).gain(np.array([80.0, 160.0]), 10_000.0)
    assert_allclose(np.log2(low / high), order, rtol=0.01)


def test_delay_is_zero_or_that_of_the_order() -> None:
    time = np.arange(4000) / RATE - 2.0
    filtered = Filter()(np.exp(-((time / 0.02) ** 2)), RATE)
    # sosfiltfilt is symmetric up to the transients of the padded ends, 2 s away.
    assert_allclose(filtered[1:], filtered[1:][::-1], atol=1e-9)
    assert abs(time[np.argmax(filtered)]) < 1e-9
    # Group delay of a Butterworth filter at low frequency: sum of 2 sin(..) / w_c = 3.8637 / w_c for order 6.
    time = np.arange(10_000) / RATE
    filtered = Filter(phase="causal")(np.sin(2 * np.pi * 0.5 * time), RATE)
    lag = np.interp(0.0, filtered[3600:4400], time[3600:4400]) - 4.0
    # Delay varies by (f / f_c)^2 at 0.5 Hz of 20 Hz: below 0.1 %.
    assert_allclose(lag, 3.8637 / (2 * np.pi * 20.0), rtol=2e-3)


def test_second_order_sections_are_stable_where_a_polynomial_is_not() -> None:
    """5 Hz at 10 kHz, order 12: the sections have the gain 1 at 0 Hz; the polynomial form is wrong by far."""
    low_pass = Filter(order=12, cutoff_Hz=5.0, phase="causal")
    rate = 10_000.0
    poles = np.concatenate([np.roots(section[3:]) for section in low_pass.sections(rate)])
    assert np.abs(poles).max() < 1
    settled = low_pass(np.r_[np.zeros(100), np.ones(50_000)], rate)[-1]
    assert_allclose(settled, 1.0, rtol=1e-9)
    _, response = freqz(*butter(12, 5.0, fs=rate), worN=[0.0])
    assert abs(abs(response[0]) - 1) > 1e-3


@pytest.mark.parametrize("phase", ["zero", "causal"])
def test_constant_force_passes_unchanged_from_the_first_sample(phase: Literal["zero", "causal"]) -> None:
    filtered = Filter(phase=phase)(np.full(500, 120.0), RATE)
    assert_allclose(filtered, 120.0, rtol=1e-9)


def test_constant_slope_and_short_record_have_little_transient() -> None:
    """A slope of 50 N/s continued at both ends: 2e-4 N are left of the transient (0.69 N without padding)."""
    slope = 120 + 50 * np.arange(2000) / RATE
    assert_allclose(Filter()(slope, RATE), slope, atol=1e-3)
    # Two periods of 20 Hz at 1000 Hz are 100 samples; a record of 20 samples has 19 to mirror.
    assert_allclose(Filter()(np.full(20, 120.0), RATE), 120.0, rtol=1e-9)


def test_force_filtered_at_the_same_cutoff_is_not_filtered_twice() -> None:
    force = np.random.default_rng(1).normal(size=2000)
    assert ForceChannel(force, RATE, Filter(), 20.0).graded is force
    with pytest.raises(AlreadyFiltered, match="filtered at 10 Hz"):
        _ = ForceChannel(force, RATE, Filter(), 10.0).graded
    assert_allclose(ForceChannel(force, RATE, Filter(), 200.0).graded, Filter()(force, RATE))


@pytest.mark.parametrize(
    ("applied", "filtered"),
    [((1 - CUTOFF_TOLERANCE) * 20, False), ((1 + CUTOFF_TOLERANCE) * 20, False), (20.03, True), (None, True)],
)
def test_cutoffs_are_the_same_to_a_thousandth(applied: float | None, filtered: bool) -> None:
    """A force delivered at 20 Hz is taken as it is; one delivered above is filtered, one below cannot be graded."""
    assert needs_filter(Filter(), applied) is filtered
    with pytest.raises(AlreadyFiltered, match=r"at 19\.97 Hz before delivery; its content up to 20 Hz is not known"):
        needs_filter(Filter(), 19.97)


@pytest.mark.parametrize(
    ("order", "phase", "message"),
    [
        *((order, phase, None) for order, phase in ((6, "zero"), (5, "causal"), (1, "causal"))),
        (5, "zero", "5 is odd. Give an even order: a zero-phase filter divides it between two passes"),
        *((order, phase, "greater than or equal to 1") for order, phase in ((0, "zero"), (-2, "zero"), (0, "causal"))),
    ],
)
def test_orders_of_a_filter(order: int, phase: Literal["zero", "causal"], message: str | None) -> None:
    with nullcontext() if message is None else pytest.raises(ValueError, match=message):
        assert Filter(order=order, phase=phase).order == order


@pytest.mark.parametrize("phase", ["zero", "causal"])
def test_filter_acts_up_to_two_fifths_of_the_rate(phase: Literal["zero", "causal"]) -> None:
    """20 Hz is 0.4 of 50 samples per second."""
    assert Filter(phase=phase).sections(50.0).shape[1] == 6
    with pytest.raises(BandNotObservable, match="49 samples per second; a filter at 20 Hz needs at least 50"):
        Filter(phase=phase)(np.ones(100), 49.0)

"""Repeatability of records whose differences are known in time, in size and in delay."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.exact_decays import RATE, RELEASE, build_exact_decay
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.units import MotionQuantity
from pantocheck.conformance.drops.decay_preparation import PreparedDecay
from pantocheck.conformance.drops.release import Release
from pantocheck.conformance.drops.repeatability import compare_records, convert_motion, overlay_records

POLES = 2 * np.pi * np.array([0.9, 1.7, 2.6]) * (-0.002 + 1j)
RESIDUES = np.array([[0.5, -0.4], [0.3j, 0.6j], [0.2, 0.9]])


def build_decay(name: str = "first", duration: float = 80.0, lag: float = 0.0) -> PreparedDecay:
    """Exact decay; its release is detected too early by the lag [s]."""
    decay = build_exact_decay(POLES, RESIDUES, name, duration=duration)
    return replace(decay, release=Release(RELEASE - lag, RELEASE - 0.6))


def times(decay: PreparedDecay) -> RealArray:
    return np.asarray(np.arange(decay.record.signals.shape[0]) / RATE - RELEASE)


def with_signals(decay: PreparedDecay, change: RealArray) -> PreparedDecay:
    return replace(decay, record=replace(decay.record, signals=decay.record.signals + change))


@pytest.mark.parametrize(("begin", "end"), [(1.6, 3.0), (9.0, 11.3), (60.2, 62.0), (67.0, 69.7)])
def test_difference_anywhere_in_the_windows_lowers_their_correlation(begin: float, end: float) -> None:
    """Windows from 1.5 to 11.5 s and from 60 to 70 s; the low-pass at 6 Hz moves energy by 0.1 s only, hence 0.005."""
    first, again = build_decay(), build_decay("second")
    t = times(again)
    size = 1.5 if begin < 20 else 0.5
    inside = (t > begin) & (t < end)
    second = with_signals(again, np.outer(np.where(inside, size * np.sin(2 * np.pi * 2.1 * t), 0.0), [0.0, 1.0]))
    unchanged, changed = compare_records((first, second)).comparisons
    assert (unchanged.channel, changed.channel, changed.second) == ("S1_z", "S2_z", "second")
    for start, late in ((1.5, False), (60.0, True)):
        window = (t >= start - 1e-9) & (t < start + 10.0 - 1e-9)
        a, b = (decay.record.signals[window, 1] for decay in (first, second))
        expected = np.corrcoef(a, b)[0, 1]
        residual = np.std(a - b) / np.std(a)
        correlation = changed.correlation_later if late else changed.correlation_at_start
        assert correlation == pytest.approx(expected, abs=0.005)
        left = changed.residual_later if late else changed.residual_at_start
        assert left == pytest.approx(residual, abs=0.02)
        assert (expected < 0.98) == (late == (begin > 20))
    assert unchanged.correlation_at_start == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("lag", [-0.21, 0.0, 0.13])
def test_delay_of_the_second_record_is_found_between_the_samples(lag: float) -> None:
    """Correlations every 10 ms and a parabola through three of them: to a millisecond."""
    rows = compare_records((build_decay(), build_decay("second", lag=lag))).comparisons
    assert [row.shift_s for row in rows] == pytest.approx([lag] * 2, abs=1e-3)
    assert min(row.correlation_at_start for row in rows) > 0.9999
    assert min(row.correlation_later or 0 for row in rows) > 0.999


def test_noise_at_rest_limits_the_correlation() -> None:
    """A tone of amplitude 0.2 in the rest of the second record: share of its power in that of the window."""
    first, again = build_decay(), build_decay("second")
    t = times(again)
    noisy = with_signals(again, np.outer(np.where(t < -0.5, 0.2 * np.sin(2 * np.pi * 4 * t), 0.0), [1.0, 0.0]))
    row, other = compare_records((first, noisy)).comparisons
    window = (t >= 1.5) & (t < 11.5)
    power = np.var(first.record.signals[window, 0])
    assert row.possible_at_start == pytest.approx(np.sqrt(1 - 0.02 / power), rel=0.01)
    assert other.possible_at_start == pytest.approx(1.0, abs=1e-3)
    late = (t >= 60.0) & (t < 70.0)
    assert row.possible_later == pytest.approx(np.sqrt(1 - 0.02 / np.var(first.record.signals[late, 0])), rel=0.03)


def test_short_records_are_compared_at_the_start_alone() -> None:
    rows = compare_records((build_decay(duration=40.0), build_decay("second"))).comparisons
    assert [row.correlation_later for row in rows] == [None, None]
    assert min(row.correlation_at_start for row in rows) > 0.999


def test_overlay_shows_the_sensor_that_moves_most() -> None:
    """Windows of 10 s from the release and from 60 s on, without their mean; six significant digits."""
    long, short = build_decay(), build_decay("short", duration=40.0)
    overlay = overlay_records((long, short))
    assert (overlay.channel, [len(run.windows) for run in overlay.runs]) == ("S2_z", [2, 1])
    t = times(long)
    for window, begin in zip(overlay.runs[0].windows, (0.0, 60.0), strict=True):
        grid = begin + 0.025 * np.arange(400)
        assert window.time_s == pytest.approx(grid, abs=1e-4)
        signal = np.interp(grid, t, long.record.signals[:, 1])
        later = grid > begin + 0.5  # before it the low-pass smooths the release
        difference = np.array(window.signal) - (signal - signal.mean())
        assert np.abs(difference[later]).max() < 0.03 * np.abs(signal).max()
        assert window.acceleration_m_s2 == window.signal


def test_overlay_has_the_velocity_of_the_decay() -> None:
    """Velocity 2 Re(v exp(p t)) with imaginary v, which is zero at the release; residues of the acceleration are v p.

    Within 5 % of the largest value: the high-pass below 0.08 Hz leaves out the rise of the wire to its new rest.
    """
    velocity = 0.1j * RESIDUES.real
    decay = build_exact_decay(POLES, POLES[:, None] * velocity, duration=80.0)
    overlay = overlay_records((decay,))
    column = ("S1_z", "S2_z").index(overlay.channel)
    for window, begin in zip(overlay.runs[0].windows, (0.0, 60.0), strict=True):
        t = np.array(window.time_s)
        expected = 2 * (np.exp(np.outer(t, POLES)) @ velocity[:, column]).real
        difference = (np.array(window.velocity_m_s) - (expected - expected.mean()))[t > begin + 0.5]
        assert np.abs(difference).max() < 0.05 * np.abs(expected).max()


# Conversion of decays whose derivatives are known in closed form.


SAMPLED_HZ, SLOW = 50.0, 2 * np.pi * 0.9 * (-0.04 + 1j)
T = np.arange(int(80 * SAMPLED_HZ)) / SAMPLED_HZ - 6.0
AFTER = np.maximum(T, 0.0)
QUANTITIES: tuple[MotionQuantity, ...] = ("displacement", "velocity", "acceleration")
POLYNOMIALS = (AFTER**3, 3 * AFTER**2 + SLOW * AFTER**3, 6 * AFTER + 6 * SLOW * AFTER**2 + SLOW**2 * AFTER**3)
MOTION = {q: (p * np.exp(SLOW * AFTER)).imag[:, None] for q, p in zip(QUANTITIES, POLYNOMIALS, strict=True)}
"""t^3 exp(p t) after the release and its derivatives, which have no step at the release."""


@pytest.mark.parametrize("given", QUANTITIES)
@pytest.mark.parametrize("wanted", QUANTITIES)
def test_decay_becomes_its_derivative_or_integral(given: MotionQuantity, wanted: MotionQuantity) -> None:
    """Within 1 % of the largest value, because the high-pass removes the little content below 0.08 Hz."""
    # An offset of the sensor changes nothing else: it fades in the high-pass at the ends of the record.
    offset = 0.0 if given == wanted else 0.1
    result = convert_motion(MOTION[given] + offset, SAMPLED_HZ, given, wanted)
    shown = (T > -2.0) & (T < 60.0)
    assert np.abs(result - MOTION[wanted])[shown].max() < 0.01 * np.abs(MOTION[wanted]).max()


def test_slow_drift_is_left_out() -> None:
    """A drift with a period of 50 s, whose integral would have an amplitude of 8 m/s, and that of a mode 0.18 m/s."""
    drift = np.sin(2 * np.pi * 0.02 * T)[:, None]
    result = convert_motion(drift, SAMPLED_HZ, "acceleration", "velocity")
    assert np.abs(result[(T > 10) & (T < 60)]).max() < 0.4

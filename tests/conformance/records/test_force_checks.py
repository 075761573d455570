"""Checks of a measured force: thresholds of outliers, and bands of the detection of a filter."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals
from pantocheck.conformance.records.force_checks import _leakage_free_rms, detect_filtered, find_clipping, find_outliers


def place_outlier(force: RealArray, index: int, distance: float) -> RealArray:
    """Force with one sample at a distance above the median of itself and three samples on both sides."""
    changed = force.copy()
    others = np.delete(force[index - 3 : index + 4], 3)
    changed[index] = np.sort(others)[3] + distance  # the median of seven, of which this sample is the largest
    return changed


@pytest.mark.parametrize(("factor", "count"), [(11.9, 0), (12.1, 1)])
def test_outlier_is_twelve_standard_deviations_from_the_running_median(factor: float, count: int) -> None:
    """Deviation of the distance: 1.4826 times its median, which one of 2000 samples changes by a thousandth."""
    force = np.random.default_rng(1).normal(120, 15, 2000)
    windows = np.lib.stride_tricks.sliding_window_view(force, 7)
    deviation = 1.4826 * np.median(np.abs(force[3:-3] - np.median(windows, axis=1)))
    assert 12 * deviation > 100  # above the smallest distance
    assert list(find_outliers(place_outlier(force, 700, factor * deviation))) == [700] * count


@pytest.mark.parametrize(("distance", "count"), [(49.9, 0), (50.1, 1)])
@pytest.mark.parametrize("sign", [-1, 1])
def test_outlier_of_a_smooth_force_is_at_least_fifty_newtons_away(distance: float, count: int, sign: int) -> None:
    force = np.full(100, 120.0)
    force[50] += sign * distance
    assert list(find_outliers(force)) == [50] * count


@pytest.mark.parametrize(("index", "found"), [(2, False), (3, True), (6, True), (7, False)])
def test_outlier_has_neighbours(index: int, found: bool) -> None:
    """Ten samples: the running median is not known at the first and the last three."""
    force = np.full(10, 120.0)
    force[index] = 900.0
    assert list(find_outliers(force)) == ([index] if found else [])


@pytest.mark.parametrize(("size", "expected"), [(0, []), (6, []), (7, [3])])
def test_running_median_needs_seven_samples(size: int, expected: list[int]) -> None:
    force = np.full(size, 120.0)
    force[size // 2 : size // 2 + 1] = 900.0
    assert list(find_outliers(force)) == expected


def test_means_and_medians_are_those_of_scipy() -> None:
    """Equal to rounding."""
    random = np.random.default_rng(2)
    force, time = random.normal(120, 30, 5001), np.arange(5001) / 250
    channel = PantographSignals(50 * time, ForceChannel(force, 250.0, Filter()), (0.0, 50 * time[-1]))
    frequency, density = scipy.signal.welch(channel.delivered, 250.0, nperseg=500)
    inside = (frequency >= 5) & (frequency <= 20)
    assert _leakage_free_rms(channel, 5, 20) == pytest.approx(np.sqrt(density[inside].sum() * frequency[1]), rel=1e-12)
    spikes = np.where(random.random(5001) < 0.01, 900.0, force)
    distance = np.abs(spikes - scipy.signal.medfilt(spikes, 7))
    beyond = np.flatnonzero(distance[3:-3] > 12 * 1.4826 * np.median(distance)) + 3
    assert beyond.size > 10
    assert list(find_outliers(spikes)) == list(beyond)


def signals(*tones: tuple[float, float], rate: float = 500.0, seconds: float = 20.0) -> PantographSignals:
    """Force of 120 N with tones of a frequency [Hz] and an amplitude [N]."""
    time = np.arange(int(seconds * rate)) / rate
    force = 120 + sum(amplitude * np.sin(2 * np.pi * frequency * time) for frequency, amplitude in tones)
    channel = ForceChannel(np.asarray(force), rate, Filter())
    return PantographSignals(50 * time, channel, (0.0, 50 * time[-1]))


@pytest.mark.parametrize(
    ("tones", "detected"),
    [
        # RMS at 30-50 Hz below 8 % of that at 5-20 Hz.
        ([(10, 20), (40, 1.59)], True),
        ([(10, 20), (40, 1.61)], False),
        # Tones beside the upper band do not count, those inside do. A Hann window of 2 s spreads a tone over 1 Hz.
        ([(10, 20), (29, 20)], True),
        ([(10, 20), (31, 5)], False),
        ([(10, 20), (49, 5)], False),
        ([(10, 20), (51, 20)], True),
        # One sixth of the power of a tone at 29.5 Hz is at 30 Hz: 12 % of the RMS at 10 Hz.
        ([(10, 20), (29.5, 6)], False),
        # Tones beside the lower band are no reference, those inside are.
        ([(6, 20), (40, 1)], True),
        ([(19, 20), (40, 1)], True),
        ([(4, 20), (40, 0.1)], False),
        ([(21, 20), (40, 0.1)], False),
        # The reference is at least a thousandth of the standard deviation.
        ([(1, 100), (10, 0.11)], True),
        ([(1, 100), (10, 0.09)], False),
        ([(10, 0)], False),
    ],
)
def test_force_without_content_above_30_Hz_is_filtered(tones: list[tuple[float, float]], detected: bool) -> None:
    original = signals(*tones)
    changed, warnings = detect_filtered(original, "pantograph 2")
    assert changed.filter_applied_Hz == (20.0 if detected else None)
    assert [text.startswith("the force of pantograph 2 has almost no content at 30-50 Hz") for text in warnings] == (
        [True] if detected else []
    )
    assert (changed is original) is not detected


@pytest.mark.parametrize(("rate", "detected"), [(124.0, False), (125.0, True)])
def test_band_up_to_50_Hz_needs_125_samples_per_second(rate: float, detected: bool) -> None:
    changed, _ = detect_filtered(signals((10, 20), rate=rate), "pantograph 1")
    assert (changed.filter_applied_Hz is not None) is detected


def test_stated_filter_is_kept_and_a_short_section_is_one_window() -> None:
    original = signals((10, 20))
    stated = replace(original, force=replace(original.force, filter_applied_Hz=40.0))
    assert detect_filtered(stated, "pantograph 1") == (stated, [])
    # 1.5 s are three quarters of a window of 2 s.
    changed, _ = detect_filtered(signals((10, 20), seconds=1.5), "pantograph 1")
    assert changed.filter_applied_Hz == 20.0
    # A tone of amplitude a has an RMS of a / sqrt(2): 14.1 N and 0.71 N.
    _, (warning,) = detect_filtered(signals((10, 20), (40, 1)), "pantograph 1")
    assert "(0.71 N, but 14.1 N at 5-20 Hz): it counts as low-pass filtered at 20 Hz" in warning


# Clipping: flat tops of at least four equal samples, far from the median.


@pytest.mark.parametrize(
    ("places", "found"),
    [
        ([(10, 13)], []),
        ([(10, 14)], [(10, 14)]),
        ([(0, 4), (96, 100)], [(0, 4), (96, 100)]),
        ([(40, 45), (20, 23), (60, 70)], [(40, 45), (60, 70)]),
    ],
)
@pytest.mark.parametrize("sign", [-1, 1])
def test_flat_top_has_four_samples(places: list[tuple[int, int]], found: list[tuple[int, int]], sign: int) -> None:
    """A ramp between -1 and 1 whose samples are all different, with plateaus at its largest or smallest value."""
    signal = np.random.default_rng(4).permutation(np.linspace(-1, 1, 100))
    for start, end in places:
        signal[start:end] = 2 * sign
    assert find_clipping(signal) == found


def test_tops_and_bottoms_follow_each_other_in_time() -> None:
    signal = np.random.default_rng(4).permutation(np.linspace(-1, 1, 100))
    signal[20:26], signal[10:15], signal[50:54] = 2.0, -2.0, 2.0
    assert find_clipping(signal) == [(10, 15), (20, 26), (50, 54)]


@pytest.mark.parametrize(("floor", "clipped"), [(-0.9, False), (-1.1, True)])
def test_flat_bottom_near_the_median_is_the_noise_floor(floor: float, clipped: bool) -> None:
    """The median is 0. A fifth of the range is 0.98 for values of -0.9 to 4, and 1.02 for values of -1.1 to 4."""
    signal = np.concatenate([np.full(6, floor), np.linspace(-0.8, -1e-3, 44), np.linspace(1e-3, 4, 51)])
    signal[50] = 0.0
    assert np.median(signal) == 0.0
    assert find_clipping(signal) == ([(0, 6)] if clipped else [])

"""Usable parts of a measured record: local speed, gaps, shortest part, resampling."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.records.usable_sections import (
    UsableSection,
    find_usable_sections,
    local_speed,
    resample_section,
)


@pytest.mark.parametrize(("size", "rate"), [(1001, 101.0), (301, 51.0)])
def test_speed_is_averaged_over_a_second(size: int, rate: float) -> None:
    """Mean of the slopes at the samples of the surrounding second; both rates are odd, so that it is centred."""
    time = np.arange(size) / rate
    position = 50 * time + np.random.default_rng(3).uniform(0, 0.3, size)
    expected = np.convolve(np.gradient(position, time), np.full(int(rate), 1 / rate), mode="valid")
    half = int(rate) // 2
    assert_allclose(local_speed(time, position)[half:-half], expected, rtol=1e-9)


def test_speed_of_a_short_or_coarse_record() -> None:
    """Five samples in half a second, and samples every 2.5 s: the slope of a straight line."""
    for time in (np.arange(5) / 10, np.arange(4) * 2.5):
        assert_allclose(local_speed(time, 50 * time), 50.0, rtol=1e-12)
    coarse = np.arange(4) * 2.5
    assert_allclose(local_speed(coarse, coarse**2), np.gradient(coarse**2, coarse), rtol=1e-12)


@pytest.mark.parametrize(
    ("step", "gap", "parts"),
    [
        (0.002, 0.0119, 1),  # a step and 10 ms
        (0.002, 0.0121, 2),
        (0.05, 0.074, 1),  # one and a half steps
        (0.05, 0.076, 2),
    ],
)
def test_gap_is_longer_than_ten_milliseconds_and_half_a_step(step: float, gap: float, parts: int) -> None:
    time = np.concatenate([np.arange(0, 2, step), 2 - step + gap + np.arange(0, 3, step)])
    found = find_usable_sections(time, np.full(time.size, True))
    assert len(found) == parts
    assert_array_equal(np.concatenate(found), np.arange(time.size))


def test_unusable_samples_are_a_gap() -> None:
    time = np.arange(1000) / 100
    usable = np.full(1000, True)
    usable[300:310] = False
    first, second = find_usable_sections(time, usable)
    assert (first[0], first[-1], second[0], second[-1]) == (0, 299, 310, 999)
    assert find_usable_sections(time, np.full(1000, False)) == []


@pytest.mark.parametrize(("samples", "found"), [(100, 0), (102, 1)])
def test_part_lasts_at_least_a_second(samples: int, found: int) -> None:
    """At 100 Hz, 100 samples last 0.99 s and 102 samples 1.01 s."""
    assert len(find_usable_sections(np.arange(samples) / 100, np.full(samples, True))) == found


def section(time: RealArray, height: bool = True) -> UsableSection:
    return UsableSection(50 * time, 120 + 3 * time, 0.01 * time if height else None)


def test_even_samples_are_kept() -> None:
    """300 samples, of which one is 0.3 %. The times are rounded by up to 1 % of a step, the rate by 0.1 %."""
    time = np.arange(300) / 100
    channels = section(time)
    rounding = 0.9e-4 * (-1.0) ** np.arange(300)
    rounding[[0, -1]] = 0.0
    for rounded, rate in ((time, 100.0), (time + rounding, 100.0), (time, 100.08), (time, 99.92)):
        kept = resample_section(rounded, channels, rate)
        assert kept.force is channels.force
        assert kept.position is channels.position
        assert kept.height is channels.height


@pytest.mark.parametrize(
    ("time", "rate", "size"),
    [
        (np.arange(300) / 100, 100.2, 300),  # even at another rate
        (np.arange(300) / 100, 99.8, 299),
        (np.arange(300) / 100 + 1.5e-4 * np.sin(np.pi * (np.arange(300) % 3) / 2), 100.0, 300),  # 1.5 % of a step
        (7 + np.linspace(0, 1, 300) ** 1.1 * 2.99, 100.0, 300),  # uneven
    ],
)
@pytest.mark.parametrize("height", [True, False])
def test_uneven_samples_are_interpolated(time: RealArray, rate: float, size: int, height: bool) -> None:
    """Channels that are linear in time remain so: interpolation by cubics is exact for them, up to rounding."""
    resampled = resample_section(time, section(time, height), rate)
    even = time[0] + np.arange(size) / rate
    assert_allclose(resampled.position, 50 * even, rtol=1e-11)
    assert_allclose(resampled.force, 120 + 3 * even, rtol=1e-11)
    if height:
        assert resampled.height is not None
        assert_allclose(resampled.height, 0.01 * even, rtol=1e-11)
    else:
        assert resampled.height is None


def test_interpolation_creates_no_extreme() -> None:
    """A step of the force: a cubic spline would overshoot by some percent."""
    time = np.linspace(0, 1, 300) ** 1.1 * 2.99
    force = np.where(time < 1.5, 0.0, 100.0)
    resampled = resample_section(time, UsableSection(50 * time, force, None), 400.0).force
    assert (resampled.min(), resampled.max()) == (0.0, 100.0)


@pytest.mark.parametrize("rate", [100.0, 100.2])
def test_height_with_a_missing_value_is_dropped(rate: float) -> None:
    time = np.arange(300) / 100
    height = np.where(time == 1.0, np.nan, 0.01)
    assert resample_section(time, UsableSection(50 * time, 3 * time, height), rate).height is None

"""Search for the end of a linear decay: disturbed windows, and a disturbance of one sensor among many."""

import numpy as np
import pytest

from pantocheck.conformance.drops.decay_kernel import FrequencyBand
from pantocheck.conformance.drops.decay_search import DecaySearch, ResidualWindows


def build_windows(pattern: str) -> ResidualWindows:
    """Windows of 20 samples, one every 5 samples; x is disturbed."""
    disturbed = np.array([mark == "x" for mark in pattern])
    return ResidualWindows(5 * np.arange(disturbed.size), disturbed, window=20, reach=30)


@pytest.mark.parametrize(
    ("pattern", "begin", "end"),
    [
        ("xx.....x....xx.xxx..", 0, 55),  # four of six windows, the first of them less a quarter of a window
        ("xxxxxx....xxxx......", 0, 45),  # the disturbance at the very beginning is not the end
        ("xxxxxx....xxxx......", 55, np.iinfo(np.int64).max),
        ("..........xxx.......", 0, np.iinfo(np.int64).max),  # three windows are chance
        ("..........xxx..x....", 0, 45),
        ("xxxxxxxxxxxxxxxxxxxx", 15, 15),  # no calm window
        ("....................", 0, np.iinfo(np.int64).max),
    ],
)
def test_disturbance_after_a_calm_window_lasts(pattern: str, begin: int, end: int) -> None:
    assert build_windows(pattern).first_after_calm(begin) == end


@pytest.mark.parametrize(
    ("pattern", "sample", "stays"),
    [
        (".......xxxxx...", 35, True),  # five of eight windows
        (".......xxxx....", 35, False),  # four of eight
        ("........xxxxxxx", 40, False),  # seven windows are too few
        (".......xxxxxxxx", 35, True),
        ("xxxxxxxxxxxx....xx..", 60, False),
    ],
)
def test_wind_disturbs_most_of_at_least_eight_windows(pattern: str, sample: int, stays: bool) -> None:
    assert build_windows(pattern).stays_disturbed(sample) == stays


@pytest.mark.parametrize(("factor", "ends"), [(1.3, False), (3.5, True)])
def test_one_disturbed_sensor_among_sixteen_ends_the_decay(factor: float, ends: bool) -> None:
    """Noise times 3.5 in one channel from 30 s on: 12 times the mean square there, 1.7 times in the mean of sixteen."""
    # A window of 4 s up to 4 Hz has 30 degrees of freedom: one channel alone counts from 1 + 9 sqrt(2 / 30) = 3.3
    # times, all together from twice.
    dt, n = 0.05, 900
    random = np.random.default_rng(1)
    t = dt * np.arange(n)
    poles = 2 * np.pi * np.array([0.9, 1.7]) * (-0.004 + 1j)
    residues = random.standard_normal((2, 16)) * np.exp(1j * random.uniform(0, 6, (2, 16)))
    noise = 0.02 * random.standard_normal((n, 16))
    noise[t > 30.0, 3] *= factor
    samples = 2 * (np.exp(np.outer(t, poles)) @ residues).real + noise
    search = DecaySearch(np.asarray(samples), 40, dt, FrequencyBand.up_to(4.0, 50.0))
    start, end, found = search.find_linear_part()
    assert start * dt < 2.1
    # A window of 4 s and its filter reach beyond the start of the disturbance.
    assert (25.5 < end * dt < 30.5) if ends else end == n
    for pole in poles:
        assert np.abs(found - pole).min() < 0.1 * -pole.real

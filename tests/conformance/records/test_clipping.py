"""Clipping: flat tops of at least four equal samples, far from the median."""

import numpy as np
import pytest

from pantocheck.conformance.records.force_checks import find_clipping


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
def test_flat_top_has_four_equal_samples(
    places: list[tuple[int, int]], found: list[tuple[int, int]], sign: int
) -> None:
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

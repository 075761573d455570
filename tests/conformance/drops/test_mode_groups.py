"""Groups of span modes: their numbers and their outliers."""

import numpy as np
import pytest

from pantocheck.conformance.drops.mode_groups import (
    assign_groups,
    find_group_outliers,
    number_groups,
    warn_about_overlap,
)
from pantocheck.conformance.results.identified_modes import Mode


def build_mode(frequency: float, damping_ratio: float, certain: bool = True, lateral: bool = False) -> Mode:
    facts = {"damping_ratio_std": 0.0, "sensor_shape": (), "certain": certain, "lateral": lateral}
    return Mode(frequency_Hz=frequency, damping_ratio=damping_ratio, **facts)


def test_outliers_belong_to_their_group() -> None:
    """The second mode is an outlier of the first group, and lies between the ratios of the other two."""
    ratios = {1: (0.010, 0.007, 0.0101, 0.0099, 0.0102), 2: (0.008, 0.0082, 0.0081, 0.0079), 3: (0.006,) * 4}
    modes = [build_mode(k + 0.02 * i, z) for k, row in ratios.items() for i, z in enumerate(row)]
    sideways = build_mode(1.5, 0.05, lateral=True)
    doubtful = build_mode(3.1, 0.05, certain=False)
    rows = assign_groups([*modes[:5], sideways, *modes[5:], doubtful], 6)
    assert [row.group for row in rows] == [1] * 5 + [None] + [2] * 4 + [3] * 5
    assert [i for i, row in enumerate(rows) if row.outlier] == [1]


def test_groups_need_three_certain_modes_and_touch() -> None:
    frequencies = np.array([1.0, 1.05, 2.0, 3.1])
    assert list(number_groups(frequencies[:3], frequencies, None)) == [1, 1, 2, 3]
    assert list(number_groups(frequencies[:2], frequencies, None)) == [0, 0, 0, 0]
    certain = np.concatenate([k * np.array([0.98, 1.0, 1.02]) for k in range(1, 9)])
    assert list(number_groups(certain, np.array([8.2, 8.4, 8.6, 9.0]), 3)) == [8, 8, 0, 0]
    # Twenty modes at 8.3 times the first group: in the eighth group they would be too many, beyond it they are not.
    certain = np.concatenate([[0.99, 1.0, 1.01], 8.3 + 0.001 * np.arange(20)])
    assert list(number_groups(certain, certain, 6)) == [1] * 3 + [0] * 20


def test_gaps_between_groups_follow_bending_and_spans() -> None:
    """Groups at n (1 + 0.02 (n - 1)): 5.4 and 6.6 are the fifth and sixth. The first gap stays near 1.5 (1 + 0.01)."""
    certain = np.concatenate([n * (1 + 0.02 * (n - 1)) * np.array([0.999, 1.0, 1.001]) for n in range(1, 8)])
    assert list(number_groups(certain, certain, 3)) == list(np.repeat(np.arange(1, 8), 3))
    assert list(number_groups(certain, np.array([1.49, 1.53, 5.7, 6.3]), 3)) == [1, 2, 5, 6]
    # Two modes of the first group around 1.2 Hz. Six more at 1.55 Hz belong to the second: two spans have only two.
    # The search may lower the mean by 15 %, so that the gap lies at 1.53 Hz.
    certain = np.array([1.0, 1.4, *1.55 + 0.001 * np.arange(6)])
    assert list(number_groups(certain, certain, 2)) == [1, 1] + [2] * 6
    # Modes next to the gap below the third group are 0.066 Hz from its middle, just beyond the clearance of 0.06.
    certain = np.array([0.822, 1.0, 1.178, 1.566, 2.0, 2.434, 2.566, 3.0, 3.434])
    assert list(number_groups(certain, certain, 3)) == [1] * 3 + [2] * 3 + [3] * 3


@pytest.mark.parametrize(("value", "outlier"), [(13.1, True), (12.9, False), (-3.9, False), (-4.1, True)])
def test_outliers_lie_one_and_a_half_interquartile_ranges_beyond_the_quartiles(value: float, outlier: bool) -> None:
    """1..8 and a large value have the quartiles 3 and 7, with a small value 2 and 6."""
    assert list(find_group_outliers(np.array([*range(1, 9), value]))) == [False] * 8 + [outlier]


def test_four_values_are_needed_for_an_outlier() -> None:
    assert list(find_group_outliers(np.array([1.0, 1.0, 1.0, 10.0]))) == [False, False, False, True]
    assert list(find_group_outliers(np.array([1.0, 1.0, 10.0]))) == [False, False, False]


# Warning about identified modes whose half-power bands overlap.


def build_narrow_mode(frequency: float, **changes: bool) -> Mode:
    return Mode(frequency_Hz=frequency, damping_ratio=0.005, damping_ratio_std=1e-6, sensor_shape=(), **changes)


def test_overlapping_pairs_of_certain_modes_are_counted() -> None:
    """Bandwidth 10 mHz at 1 Hz and 20 mHz at 2 Hz: three modes at 1 Hz make two pairs, those at 2 Hz one."""
    modes = [build_narrow_mode(f) for f in (0.95, 1.0, 1.006, 1.013, 1.5, 1.99, 2.005, 2.03)]
    (warning,) = warn_about_overlap(modes)
    assert warning.startswith("3 near-coincident pairs of modes with overlapping half-power bands: ")
    assert ": 1.000, 1.006, 1.013, 1.990, 2.005 Hz. " in warning
    assert warn_about_overlap(modes[:2]) == ()
    assert warn_about_overlap(modes[:3])[0].startswith("1 near-coincident pair of modes")
    near = build_narrow_mode(1.004)
    for other in (build_narrow_mode(1.0, certain=False), build_narrow_mode(1.0, lateral=True)):
        assert warn_about_overlap([other, near]) == ()
    assert warn_about_overlap([build_narrow_mode(1.0), near]) != ()
    assert warn_about_overlap([near]) == warn_about_overlap([]) == ()

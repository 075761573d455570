"""Groups of modes over all tests of a population: values, outliers, and comparison with the joint identification."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.identification.mode_groups import find_group_outliers
from pantocheck.conformance.identification.population import PopulationTest, find_joint_mode
from pantocheck.conformance.identification.population_format import OutlierSide, PooledGroup
from pantocheck.conformance.identification.population_statistics import median_interval


@dataclass(frozen=True)
class GroupOverTests:
    """Certain modes of one group in each test, and those of the joint identification of its line."""

    number: int
    single: tuple[tuple[Mode, ...], ...]
    joint: tuple[tuple[Mode, ...], ...]

    @cached_property
    def values(self) -> RealArray:
        """Damping ratios of all tests, test by test [-]."""
        return np.array([mode.damping_ratio for modes in self.single for mode in modes])

    @cached_property
    def outliers(self) -> tuple[OutlierSide | None, ...]:
        """Side on which each value is an outlier."""
        middle = float(np.median(self.values)) if self.values.size else 0.0
        flags = find_group_outliers(self.values)
        return tuple(
            None if not flag else "above" if value > middle else "below"
            for value, flag in zip(self.values, flags, strict=True)
        )


def collect_group(tests: tuple[PopulationTest, ...], number: int) -> GroupOverTests:
    """Collect the certain modes of one group of all tests."""
    return GroupOverTests(
        number,
        tuple(_list_group_modes(test.single.modes, number) for test in tests),
        tuple(_list_group_modes(test.joint.modes, number) for test in tests),
    )


def _list_group_modes(modes: tuple[Mode, ...], number: int) -> tuple[Mode, ...]:
    """Modes of a group whose damping ratios are certain."""
    return tuple(mode for mode in modes if mode.group == number and mode.certain)


def summarise_group(group: GroupOverTests) -> PooledGroup:
    """Summarise one group for population.json."""
    low, middle, high = (float(value) for value in np.percentile(group.values, [25, 50, 75]))
    interval = median_interval(*_split(group.single))
    joint_values = np.array([mode.damping_ratio for modes in group.joint for mode in modes])
    joint_median = float(np.median(joint_values)) if joint_values.size else None
    joint_interval = median_interval(*_split(group.joint)) if joint_values.size else None
    frequencies = [mode.frequency_Hz for modes in group.single for mode in modes]
    return PooledGroup(
        group=group.number,
        tests=sum(bool(modes) for modes in group.single),
        values=group.values.size,
        from_Hz=min(frequencies),
        to_Hz=max(frequencies),
        lower_quartile=low,
        median=middle,
        upper_quartile=high,
        interval=interval,
        joint_median=joint_median,
        joint_interval=joint_interval,
        agrees=_agree(middle, interval, joint_median, joint_interval),
        test_spread=_test_spread(group),
        outliers_above=group.outliers.count("above"),
        outliers_below=group.outliers.count("below"),
    )


def _split(tests: tuple[tuple[Mode, ...], ...]) -> tuple[list[RealArray], list[RealArray]]:
    """Damping ratios of each test, and their standard deviations."""
    return (
        [np.array([mode.damping_ratio for mode in modes]) for modes in tests],
        [np.array([mode.damping_ratio_std for mode in modes]) for modes in tests],
    )


def _agree(
    median: float, interval: tuple[float, float], joint: float | None, joint_interval: tuple[float, float] | None
) -> bool | None:
    if joint is None or joint_interval is None:
        return None
    half_widths = [(high - low) / 2 for low, high in (interval, joint_interval)]
    return abs(median - joint) <= math.hypot(*half_widths)


def _test_spread(group: GroupOverTests) -> float | None:
    """Interquartile range of damping ratios minus those of the same modes in the joint identification."""
    differences = [
        mode.damping_ratio - other.damping_ratio
        for modes, joint in zip(group.single, group.joint, strict=True)
        for mode in modes
        if (other := find_joint_mode(mode, joint)) is not None
    ]
    return float(np.subtract(*np.percentile(differences, [75, 25]))) if len(differences) >= 4 else None

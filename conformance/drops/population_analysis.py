"""Analysis of a population of tests: boxes and outliers per group of modes, beside the joint identification."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.drops.mode_groups import find_group_outliers
from pantocheck.conformance.drops.population import (
    Population,
    PopulationTest,
    find_joint_mode,
    list_levels,
    list_sensors,
    measure_variability,
    median_interval,
)
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.results.population_format import (
    OmittedRecord,
    OutlierSide,
    PooledGroup,
    PooledRecord,
    PooledValue,
    PopulationFile,
)


# Groups of modes over all tests of a population: values, outliers, and comparison with the joint identification.
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


SUSPICIOUS = 0.5
"""Share of outliers among the values of a test above which its record is suspicious [-]."""


def analyse_population(population: Population) -> PopulationFile:
    """Analyse a population of tests, for population.json."""
    numbers = sorted({mode.group for test in population.tests for mode in test.single.modes if mode.group is not None})
    groups = [collect_group(population.tests, number) for number in numbers]
    groups = [group for group in groups if group.values.size]
    pooled = tuple(summarise_group(group) for group in groups)
    records = tuple(_describe_record(test, groups, t) for t, test in enumerate(population.tests))
    variability = measure_variability(
        [group.values for group in groups], [side for group in groups for side in group.outliers]
    )
    unusable = tuple(OmittedRecord(record=each.record.name, reason=str(each.error)) for each in population.unusable)
    return PopulationFile(
        records=records,
        unusable=unusable,
        groups=pooled,
        variability=variability,
        levels=list_levels(population.tests, numbers),
        warnings=_list_warnings(records, unusable),
    )


def _describe_record(test: PopulationTest, groups: list[GroupOverTests], t: int) -> PooledRecord:
    record, modes = test.record, test.single.modes
    values = tuple(value for group in groups for value in _list_values(group, t))
    above, below = (sum(value.outlier == side for value in values) for side in ("above", "below"))
    return PooledRecord(
        record=record.name,
        source=record.source,
        mass_kg=record.drop.mass,
        drop_wire=record.drop.wire,
        drop_position_m=record.drop.position,
        line=record.line,
        sensors=list_sensors(test),
        modes=len(modes),
        certain=sum(mode.certain for mode in modes),
        misfit=test.single.fit.misfit,
        outliers_above=above,
        outliers_below=below,
        suspicious=above + below > SUSPICIOUS * len(values),
        values=values,
    )


def _list_values(group: GroupOverTests, t: int) -> list[PooledValue]:
    first = sum(len(modes) for modes in group.single[:t])
    values = []
    for mode, side in zip(group.single[t], group.outliers[first:], strict=False):
        joint = find_joint_mode(mode, group.joint[t])
        values.append(
            PooledValue(
                group=group.number,
                frequency_Hz=mode.frequency_Hz,
                damping_ratio=mode.damping_ratio,
                damping_ratio_std=mode.damping_ratio_std,
                joint_damping_ratio=None if joint is None else joint.damping_ratio,
                outlier=side,
            )
        )
    return values


def _list_warnings(records: tuple[PooledRecord, ...], unusable: tuple[OmittedRecord, ...]) -> tuple[str, ...]:
    warnings = [
        f"{record.record}: {record.outliers_above} of its {len(record.values)} damping ratios are outliers above the "
        f"other tests and {record.outliers_below} below; check its sensors, release and weather, or leave it out"
        for record in records
        if record.suspicious
    ]
    warnings += [f"left out: {record.reason}" for record in unusable]
    return tuple(warnings)

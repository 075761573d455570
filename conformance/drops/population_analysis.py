"""Analysis of a population of tests: boxes and outliers per group of modes, beside the joint identification."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.drops.mode_groups import find_group_outliers
from pantocheck.conformance.drops.population import Population, PopulationTest
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.results.population_format import (
    FactorName,
    OmittedRecord,
    OutlierSide,
    PooledGroup,
    PooledLevel,
    PooledRecord,
    PooledValue,
    PopulationFile,
    Variability,
)


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
    """Collect the modes of one group whose damping ratios are certain, of all tests."""
    single, joint = (
        tuple(tuple(mode for mode in modes if mode.group == number and mode.certain) for modes in identified)
        for identified in ([test.single.modes for test in tests], [test.joint.modes for test in tests])
    )
    return GroupOverTests(number, single, joint)


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


def find_joint_mode(mode: Mode, joint: tuple[Mode, ...]) -> Mode | None:
    """Mode of the joint identification nearest in frequency; None beyond half of the half-power bandwidth."""
    nearest = min(joint, key=lambda other: abs(other.frequency_Hz - mode.frequency_Hz), default=None)
    if nearest is None or abs(nearest.frequency_Hz - mode.frequency_Hz) > mode.damping_ratio * mode.frequency_Hz:
        return None
    return nearest


# Statistics of a population of tests: interval of a median over tests, and variability against frequency.
FEWEST = 4
"""Smallest number of values that have quartiles."""


REPLICATES = 1000
"""Number of redrawn populations for the interval of a median."""


REDRAW_SEED = 1
"""Seed of the redrawn populations, so that equal records give equal files."""


def median_interval(values: list[RealArray], deviations: list[RealArray]) -> tuple[float, float]:
    """95 % interval of the median over all values of all tests, by redrawing the tests (cluster bootstrap).

    The values of one test, (n,), are not independent of each other, so that whole tests are redrawn. In each replicate
    every value also varies by its standard deviation.

    References:
        [1] A. C. Davison, D. V. Hinkley, Bootstrap Methods and their Application, Cambridge University Press, 1997,
            section 3.8.
    """
    random = np.random.default_rng(REDRAW_SEED)
    tests = len(values)
    medians = []
    for _ in range(REPLICATES):
        drawn = random.integers(0, tests, tests)
        sample = np.concatenate([values[t] + deviations[t] * random.standard_normal(values[t].size) for t in drawn])
        medians.append(np.median(sample) if sample.size else np.nan)
    low, high = np.nanpercentile(medians, [2.5, 97.5])
    return float(low), float(high)


def measure_variability(groups: list[RealArray], sides: list[OutlierSide | None]) -> Variability:
    """Measure how the dispersion of damping ratios over tests depends on frequency.

    Args:
        groups: Damping ratios of all tests, in the order of the groups, each (n,); groups with fewer than four values
            are left out.
        sides: Side on which each value is an outlier.
    """
    ranges = np.array([np.subtract(*np.percentile(values, [75, 25])) for values in groups if values.size >= FEWEST])
    outliers = [side for side in sides if side is not None]
    return Variability(
        groups=ranges.size,
        rank_correlation=rank_correlation(ranges),
        last_over_first=float(ranges[-1] / ranges[0]) if ranges.size > 1 and ranges[0] > 0 else None,
        outliers=len(outliers),
        outliers_above_share=outliers.count("above") / len(outliers) if outliers else None,
    )


def rank_correlation(values: RealArray) -> float | None:
    """Spearman's rank correlation of values with their order: -1 for a strict decrease.

    It is None for fewer than three values, and for equal values.
    """
    if values.size < 3 or np.ptp(values) == 0:
        return None
    return float(scipy.stats.spearmanr(np.arange(values.size), values).statistic)


# Levels of the properties in which tests of a population differ: mass, place, sensors, tensions.
def list_sensors(test: PopulationTest) -> tuple[str, ...]:
    """Wire and position of the vertical sensors of a test; without a position, their names."""
    channels = test.single.fit.records[0].decay.channels
    return tuple(
        channel.name if channel.position is None else f"{channel.wire} {channel.position:g}".strip()
        for channel in channels
    )


def _format_known(value: float | None, unit: str) -> str:
    return "unknown" if value is None else f"{value:g} {unit}"


FACTORS: dict[FactorName, Callable[[PopulationTest], str]] = {
    "mass": lambda test: _format_known(test.record.drop.mass, "kg"),
    "drop wire": lambda test: test.record.drop.wire or "unknown",
    "drop position": lambda test: _format_known(test.record.drop.position, "m"),
    "sensors": lambda test: ", ".join(list_sensors(test)),
    "contact wire tension": lambda test: _format_known(test.record.line.contact_wire_tension_N, "N"),
    "messenger wire tension": lambda test: _format_known(test.record.line.messenger_wire_tension_N, "N"),
}
"""Level of a test in each factor."""


def list_levels(tests: Sequence[PopulationTest], groups: Sequence[int]) -> tuple[PooledLevel, ...]:
    """Median damping ratios of the tests at each level of every factor with at least two levels, by group."""
    levels = []
    for factor, level_of in FACTORS.items():
        by_level: dict[str, list[PopulationTest]] = {}
        for test in tests:
            by_level.setdefault(level_of(test), []).append(test)
        if len(by_level) > 1:
            levels += [
                PooledLevel(factor=factor, level=level, tests=len(members), medians=_median_by_group(members, groups))
                for level, members in by_level.items()
            ]
    return tuple(levels)


def _median_by_group(tests: Sequence[PopulationTest], groups: Sequence[int]) -> dict[int, float]:
    certain = [mode for test in tests for mode in test.single.modes if mode.certain]
    values = {number: [mode.damping_ratio for mode in certain if mode.group == number] for number in groups}
    return {number: float(np.median(ratios)) for number, ratios in values.items() if ratios}

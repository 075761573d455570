"""Population of tests: every mass-drop record identified on its own, whatever its mass, place, sensors and tensions."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
import scipy.stats

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.decay_preparation import PreparedDecay, prepare_decay
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.identify import Identification, choose_band, group_by_line, identify_decays
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.results.population_format import FactorName, OutlierSide, PooledLevel, Variability
from pantocheck.model.description.one_thread import use_one_thread


@dataclass(frozen=True)
class UnusableRecord:
    """Record that cannot be identified on its own, and the reason."""

    record: DropRecord
    error: InputError


@dataclass(frozen=True)
class PopulationTest:
    """One record with its own identification, and the joint identification of all records of its line."""

    record: DropRecord
    single: Identification
    joint: Identification


@dataclass(frozen=True)
class Population:
    """Tests of a population, the joint identifications of their lines, and the records that are left out."""

    tests: tuple[PopulationTest, ...]
    joint: tuple[Identification, ...]
    unusable: tuple[UnusableRecord, ...]


@use_one_thread
def identify_population(
    records: tuple[DropRecord, ...],
    highest: float = 10.0,
    poles: ComplexArray | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> Population:
    """Identify every record on its own, and the records of each line together.

    A record that cannot be identified on its own is left out of both.

    Returns:
        At least one test; the tests of a line follow each other.

    Raises:
        InputError: No record can be identified; the error is that of the first one. Or the sampling rate of one record
            is too low for any mode, so that its line has no band.
    """
    lines = [_identify_line(line_records, highest, poles, progress) for line_records in group_by_line(records)]
    population = Population(*(tuple(chain.from_iterable(parts)) for parts in zip(*lines, strict=True)))
    if not population.tests:
        raise population.unusable[0].error
    return population


def _identify_line(
    records: list[DropRecord], highest: float, poles: ComplexArray | None, progress: Callable[[str], None]
) -> tuple[list[PopulationTest], list[Identification], list[UnusableRecord]]:
    """Tests, joint identification and unusable records of one line; every record is prepared once."""
    band = choose_band(records, highest)
    usable: list[tuple[PreparedDecay, Identification]] = []
    unusable = []
    for record in records:
        progress(f"{record.name} on its own")
        try:
            decay = prepare_decay(record, band)
            usable.append((decay, identify_decays([decay], band, poles, progress)))
        except InputError as error:
            unusable.append(UnusableRecord(record, error))
    if not usable:
        return [], [], unusable
    (_, joint), *others = usable
    if others:
        joint = identify_decays([decay for decay, _ in usable], band, poles, progress)
    return [PopulationTest(decay.record, single, joint) for decay, single in usable], [joint], unusable


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

    The values of one test are not independent of each other, so that whole tests are redrawn. In each replicate every
    value also varies by its standard deviation.

    Args:
        values: Values of each test, each (n,).
        deviations: Standard deviations of the values of each test, each (n,).

    Returns:
        Quantiles of 2.5 % and 97.5 % of the median.

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

    Returns:
        Dispersion against frequency, and share of the outliers that overestimate.
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

"""Format of population.json: damping ratios of many tests, each identified on its own."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.json_file import Rounded, RoundedModel
from pantocheck.conformance.results.identified_modes import MeasuredLine

OutlierSide = Literal["above", "below"]
"""Side of the box on which a value is an outlier."""


FactorName = Literal["mass", "drop wire", "drop position", "sensors", "contact wire tension", "messenger wire tension"]
"""Property in which tests differ."""


class PooledValue(RoundedModel):
    """Certain damping ratio of one mode in one test."""

    group: int
    """Number of the group of span modes, from 1."""
    frequency_Hz: Rounded
    damping_ratio: Rounded
    damping_ratio_std: Rounded
    """Standard deviation of the damping ratio [-]."""
    joint_damping_ratio: Rounded | None
    """Damping ratio of the same mode in the joint identification; null: no mode."""
    outlier: OutlierSide | None
    """More than 1.5 interquartile ranges above or below the quartiles of its group."""


class PooledRecord(RoundedModel):
    """One record, identified on its own."""

    record: str
    source: str
    """Name of the file."""
    mass_kg: Rounded | None
    drop_wire: str
    drop_position_m: Rounded | None
    line: MeasuredLine
    sensors: tuple[str, ...]
    """Wire and position [m] of each vertical sensor, e.g. 'CW 195.75'."""
    modes: int
    """Number of identified modes."""
    certain: int
    """Number of modes whose damping ratio is certain."""
    misfit: Rounded
    """Squared residual over its expectation for noise [-]."""
    outliers_above: int
    """Number of values above the box of their group."""
    outliers_below: int
    """Number of values below the box of their group."""
    suspicious: bool
    """true: more than half of the values are outliers."""
    values: tuple[PooledValue, ...]


class PooledGroup(RoundedModel):
    """Damping ratios of one group of span modes over all tests, beside those of the joint identification."""

    group: int
    tests: int
    """Number of tests with a value."""
    values: int
    """Number of values."""
    from_Hz: Rounded
    to_Hz: Rounded
    lower_quartile: Rounded
    median: Rounded
    upper_quartile: Rounded
    interval: tuple[Rounded, Rounded]
    """95 % interval of the median, tests redrawn."""
    joint_median: Rounded | None
    """Median of the joint identification, each test with the modes of its line."""
    joint_interval: tuple[Rounded, Rounded] | None
    """95 % interval of `joint_median`."""
    agrees: bool | None
    """true: the medians differ by less than the half-widths of both intervals, added in squares."""
    test_spread: Rounded | None
    """Interquartile range of damping ratios minus those of the same modes in the joint result."""
    outliers_above: int
    outliers_below: int


class Variability(RoundedModel):
    """Dispersion of the damping ratios over tests, as a function of frequency."""

    groups: int
    """Number of groups with at least four values."""
    rank_correlation: Rounded | None
    """Spearman's correlation of interquartile range and group: -1, if it always decreases."""
    last_over_first: Rounded | None
    """Interquartile range of the last group over that of the first [-]."""
    outliers: int
    outliers_above_share: Rounded | None
    """Share of the outliers that lie above their box [-]; null: no outlier."""


class PooledLevel(RoundedModel):
    """Tests with one value of a factor."""

    factor: FactorName
    """Property in which tests differ."""
    level: str
    tests: int
    """Number of tests."""
    medians: dict[int, Rounded]
    """Median damping ratio of these tests by group [-]."""


class OmittedRecord(RoundedModel):
    """Record that cannot be identified on its own."""

    record: str
    reason: str


class PopulationFile(RoundedModel):
    """Content of population.json."""

    schema_: Annotated[Literal["pantocheck.population/1"], Field(alias="schema")] = "pantocheck.population/1"
    records: tuple[PooledRecord, ...]
    unusable: tuple[OmittedRecord, ...]
    groups: tuple[PooledGroup, ...]
    variability: Variability
    levels: tuple[PooledLevel, ...]
    """Factors in which the tests differ."""
    warnings: tuple[str, ...]

"""Format of population.json: damping ratios of many tests, each identified on its own."""

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from pantocheck.conformance.identification.mode import MeasuredLine
from pantocheck.conformance.identification.rounded_model import Rounded, RoundedModel

OutlierSide = Literal["above", "below"]
"""Side of the box on which a value is an outlier."""


FactorName = Literal["mass", "drop wire", "drop position", "sensors", "contact wire tension", "messenger wire tension"]
"""Property in which tests differ."""


class PooledValue(RoundedModel):
    """Certain damping ratio of one mode in one test."""

    group: Annotated[int, Field(description="number of the group of span modes, from 1")]
    frequency_Hz: Rounded
    damping_ratio: Rounded
    damping_ratio_std: Annotated[Rounded, Field(description="standard deviation of the damping ratio [-]")]
    joint_damping_ratio: Annotated[
        Rounded | None, Field(description="damping ratio of the same mode in the joint identification; null: no mode")
    ]
    outlier: Annotated[
        OutlierSide | None,
        Field(description="more than 1.5 interquartile ranges above or below the quartiles of its group"),
    ]


class PooledRecord(RoundedModel):
    """One record, identified on its own."""

    record: str
    source: Annotated[str, Field(description="name of the file")]
    mass_kg: Rounded | None
    drop_wire: str
    drop_position_m: Rounded | None
    line: MeasuredLine
    sensors: Annotated[
        tuple[str, ...], Field(description="wire and position [m] of each vertical sensor, e.g. 'CW 195.75'")
    ]
    modes: Annotated[int, Field(description="number of identified modes")]
    certain: Annotated[int, Field(description="number of modes whose damping ratio is certain")]
    misfit: Annotated[Rounded, Field(description="squared residual over its expectation for noise [-]")]
    outliers_above: Annotated[int, Field(description="number of values above the box of their group")]
    outliers_below: Annotated[int, Field(description="number of values below the box of their group")]
    suspicious: Annotated[bool, Field(description="true: more than half of the values are outliers")]
    values: tuple[PooledValue, ...]


class PooledGroup(RoundedModel):
    """Damping ratios of one group of span modes over all tests, beside those of the joint identification."""

    group: int
    tests: Annotated[int, Field(description="number of tests with a value")]
    values: Annotated[int, Field(description="number of values")]
    from_Hz: Rounded
    to_Hz: Rounded
    lower_quartile: Rounded
    median: Rounded
    upper_quartile: Rounded
    interval: Annotated[tuple[Rounded, Rounded], Field(description="95 % interval of the median, tests redrawn")]
    joint_median: Annotated[
        Rounded | None, Field(description="median of the joint identification, each test with the modes of its line")
    ]
    joint_interval: Annotated[tuple[Rounded, Rounded] | None, Field(description="95 % interval of `joint_median`")]
    agrees: Annotated[
        bool | None,
        Field(description="true: the medians differ by less than the half-widths of both intervals, added in squares"),
    ]
    test_spread: Annotated[
        Rounded | None,
        Field(description="interquartile range of damping ratios minus those of the same modes in the joint result"),
    ]
    outliers_above: int
    outliers_below: int


class Variability(RoundedModel):
    """Dispersion of the damping ratios over tests, as a function of frequency."""

    groups: Annotated[int, Field(description="number of groups with at least four values")]
    rank_correlation: Annotated[
        Rounded | None,
        Field(description="Spearman's correlation of interquartile range and group: -1, if it always decreases"),
    ]
    last_over_first: Annotated[
        Rounded | None, Field(description="interquartile range of the last group over that of the first [-]")
    ]
    outliers: int
    outliers_above_share: Annotated[
        Rounded | None, Field(description="share of the outliers that lie above their box [-]; null: no outlier")
    ]


class PooledLevel(RoundedModel):
    """Tests with one value of a factor."""

    factor: Annotated[FactorName, Field(description="property in which tests differ")]
    level: str
    tests: Annotated[int, Field(description="number of tests")]
    medians: Annotated[dict[int, Rounded], Field(description="median damping ratio of these tests by group [-]")]


class OmittedRecord(RoundedModel):
    """Record that cannot be identified on its own."""

    record: str
    reason: str


class PopulationFile(RoundedModel):
    """Content of population.json."""

    model_config = ConfigDict(populate_by_name=True)

    schema_: Annotated[Literal["pantocheck.population/1"], Field(alias="schema")] = "pantocheck.population/1"
    records: tuple[PooledRecord, ...]
    unusable: tuple[OmittedRecord, ...]
    groups: tuple[PooledGroup, ...]
    variability: Variability
    levels: Annotated[tuple[PooledLevel, ...], Field(description="factors in which the tests differ")]
    warnings: tuple[str, ...]

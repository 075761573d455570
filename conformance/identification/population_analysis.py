"""Analysis of a population of tests: boxes and outliers per group of modes, beside the joint identification."""

from pantocheck.conformance.identification.group_over_tests import GroupOverTests, collect_group, summarise_group
from pantocheck.conformance.identification.mode_building import describe_line
from pantocheck.conformance.identification.population import Population, PopulationTest, find_joint_mode
from pantocheck.conformance.identification.population_format import (
    OmittedRecord,
    PooledRecord,
    PooledValue,
    PopulationFile,
)
from pantocheck.conformance.identification.population_levels import list_levels, list_sensors
from pantocheck.conformance.identification.population_statistics import measure_variability

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
        line=describe_line(record.line),
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

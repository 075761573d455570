"""Levels of the properties in which tests of a population differ: mass, place, sensors, tensions."""

from collections.abc import Callable, Sequence

import numpy as np

from pantocheck.conformance.identification.population import PopulationTest
from pantocheck.conformance.identification.population_format import FactorName, PooledLevel


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
    "contact wire tension": lambda test: _format_known(test.record.line.contact_wire_tension, "N"),
    "messenger wire tension": lambda test: _format_known(test.record.line.messenger_wire_tension, "N"),
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

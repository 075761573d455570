"""Tests as a population: boxes over tests, a damaged record among good ones, agreement with the joint result."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.synthetic_drops import drop
from pantocheck.conformance.core.array_types import ComplexArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.population import Population, identify_population
from pantocheck.conformance.drops.population_analysis import (
    analyse_population,
    find_joint_mode,
    measure_variability,
    median_interval,
    rank_correlation,
)
from pantocheck.conformance.results.identified_modes import MeasuredLine
from pantocheck.conformance.results.population_format import PopulationFile

RATIOS = {1: 0.0050, 2: 0.0030, 3: 0.0024}
"""Damping ratio of the middle mode of each group; the others differ by 5 % and 10 %."""

ROPE = 0.03
"""Additional decay rate of the damaged test, in which the rope of the mass stayed on the wire [1/s]."""


def line_poles(stretch: float, rope: float = 0.0) -> ComplexArray:
    """Three groups of five modes; the tension stretches their frequencies, and a rope damps all of them."""
    places = np.array([-2, -1, 0, 1, 2])
    frequency = np.concatenate([stretch * group * (0.9 + 0.03 * places) for group in RATIOS])
    ratio = np.concatenate([value * (1 - 0.05 * places) for value in RATIOS.values()])
    omega = 2 * np.pi * frequency
    return np.asarray(-(ratio * omega + rope) + 1j * omega)


def build_record(name: str, seed: int, tension: float, rope: float = 0.0) -> DropRecord:
    poles = line_poles(np.sqrt(tension / 15e3), rope)
    synthetic = drop(np.random.default_rng(seed), poles, 3, 60.0, rate=25.0, noise=0.002, nonlinear=0.0, weak=0.0)
    channels = tuple(DropChannel(f"S{i}_z", i, "z", "CW", 40.0 * i) for i in (1, 2, 3))
    facts = DropDescription(40.0, "CW", 100.0, 5.0)
    line = MeasuredLine(spans_m=(60.0,) * 5, contact_wire_tension_N=20e3, messenger_wire_tension_N=tension)
    return DropRecord(name, name, 25.0, synthetic.samples, channels, drop=facts, line=line)


@pytest.fixture(scope="module")
def population() -> Population:
    """Four good tests at two tensions and two masses, one damaged test, and a record that is too short."""
    good = [build_record(name, seed, 15e3 if seed < 4 else 16e3) for seed, name in enumerate("ABCD", 1)]
    good[1] = replace(good[1], drop=replace(good[1].drop, mass=30.0))
    short = replace(good[0], name="short", signals=good[0].signals[:200])
    return identify_population((*good, build_record("rope", 5, 16e3, ROPE), short), highest=3.4)


@pytest.fixture(scope="module")
def content(population: Population) -> PopulationFile:
    return analyse_population(population)


def test_damaged_record_is_an_outlier_above(content: PopulationFile) -> None:
    """The rope adds 0.53, 0.27 and 0.18 % to ratios whose boxes are 0.05, 0.03 and 0.024 % high."""
    by_name = {record.record: record for record in content.records}
    assert list(by_name) == ["A", "B", "C", "D", "rope"]
    assert [name for name, record in by_name.items() if record.suspicious] == ["rope"]
    assert {value.outlier for value in by_name["rope"].values} == {"above"}
    assert sum(record.outliers_above for name, record in by_name.items() if name != "rope") == 0
    assert content.variability.outliers_above_share == 1
    assert "rope" in content.warnings[0]
    assert "outliers above" in content.warnings[0]


def test_medians_and_levels_are_those_of_the_good_tests(content: PopulationFile) -> None:
    """One damaged test of five moves the median of each group from the middle mode at most to the next, by 5 %."""
    assert [group.group for group in content.groups] == [1, 2, 3]
    for group in content.groups:
        assert group.median == pytest.approx(RATIOS[group.group], rel=0.06)
        assert group.interval[0] <= group.median <= group.interval[1]
        assert group.tests == 5
    # Modes differ by 10 % in each group, and the rope adds a decay rate: both are less at higher frequencies.
    heights = [group.upper_quartile - group.lower_quartile for group in content.groups]
    assert heights == sorted(heights, reverse=True)
    assert content.variability.rank_correlation == pytest.approx(-1)
    assert content.variability.last_over_first == pytest.approx(heights[-1] / heights[0])
    levels = {(level.factor, level.level): level.tests for level in content.levels}
    assert levels == {
        ("mass", "40 kg"): 4,
        ("mass", "30 kg"): 1,
        ("messenger wire tension", "15000 N"): 3,
        ("messenger wire tension", "16000 N"): 2,
    }


def test_record_that_cannot_be_identified_is_left_out(population: Population, content: PopulationFile) -> None:
    assert [record.record for record in content.unusable] == ["short"]
    assert "after the release" in content.unusable[0].reason
    assert sum(len(line.fit.records) for line in population.joint) == 5
    with pytest.raises(InputError, match="after the release"):
        identify_population((population.unusable[0].record,))


def test_joint_modes_agree_within_half_a_bandwidth(population: Population) -> None:
    """Three tests of one line, without the damaged one: they differ by noise, less than 1 % of the median."""
    for group in analyse_population(replace(population, tests=population.tests[:3])).groups:
        assert group.agrees
        assert group.joint_median == pytest.approx(RATIOS[group.group], rel=0.01)
        assert group.test_spread < 0.01 * group.median
    (mode, *_) = population.tests[0].single.modes
    reach = mode.damping_ratio * mode.frequency_Hz
    near, far = (mode.model_copy(update={"frequency_Hz": mode.frequency_Hz + k * reach}) for k in (0.99, 1.01))
    assert find_joint_mode(mode, (far, near)) is near
    assert find_joint_mode(mode, (far,)) is None
    assert find_joint_mode(mode, ()) is None


# Statistics of a population: interval of a median, and variability against frequency.
def test_interval_of_a_median_reflects_deviations_and_differences() -> None:
    """One value of deviation 0.1: quantiles of a normal distribution; 1000 replicates give them to 0.1 deviations."""
    low, high = median_interval([np.array([2.0])], [np.array([0.1])])
    assert (low, high) == pytest.approx((2 - 0.196, 2 + 0.196), abs=0.015)
    # Exact values of tests that differ: the interval of the median of five is at least that of their middle three.
    tests = [np.full(3, value) for value in (1.0, 2.0, 3.0, 4.0, 5.0)]
    exact = [np.zeros(3)] * 5
    assert median_interval(tests, exact) == (1.0, 5.0)
    assert median_interval([tests[2]] * 5, exact) == (3.0, 3.0)
    assert median_interval(tests, exact) == median_interval(tests, exact)
    assert median_interval([np.array([1.0]), np.zeros(0)], [np.zeros(1), np.zeros(0)]) == (1.0, 1.0)


@pytest.mark.parametrize(
    ("values", "correlation"), [([3.0, 2.0, 1.0], -1.0), ([1.0, 2.0, 4.0, 9.0], 1.0), ([4.0, 2.0, 3.0], -0.5)]
)
def test_rank_correlation(values: list[float], correlation: float) -> None:
    """Spearman: 1 - 6 sum d^2 / (n (n^2 - 1)); two values and equal values have none."""
    assert rank_correlation(np.array(values)) == pytest.approx(correlation)
    assert rank_correlation(np.array(values[:2])) is None
    assert rank_correlation(np.ones(4)) is None


def test_variability_uses_groups_with_quartiles() -> None:
    """Quartiles of 0..4 are 1 and 3: the ranges are 2, 1 and 0.5; the group of three values has none."""
    groups = [np.arange(5.0), np.arange(5.0) / 2, np.arange(3.0), np.arange(5.0) / 4]
    measured = measure_variability(groups, ["above", None, "below", "above", "above"])
    assert measured.groups == 3
    assert measured.rank_correlation == pytest.approx(-1)
    assert measured.last_over_first == pytest.approx(0.25)
    assert (measured.outliers, measured.outliers_above_share) == (4, 0.75)
    nothing = measure_variability([np.arange(3.0)], [None])
    assert (nothing.rank_correlation, nothing.last_over_first, nothing.outliers_above_share) == (None, None, None)

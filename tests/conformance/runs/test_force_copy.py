"""Copied force: found where the uplift shows that the pantographs did not meet the same line, accepted elsewhere."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.extreme_runs import build_case, simulate
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.force_content import COPY, find_likeness
from pantocheck.conformance.runs.record_checks import check_record


@pytest.fixture(scope="module")
def run() -> tuple[Case, Record]:
    """Two pantographs with a soft contact, 100 m apart at 120 km/h: the lift of the wire differs by 0.7 to 1.2 mm."""
    case = build_case(speed=120.0, contact={"stiffness_N_m": 5e3})
    return case, simulate(case)


def read_signals(case: Case, record: Record) -> RecordSignals:
    return RecordSignals(record, case.file.filter, case.line.geometry.supports)


def take(record: Record, source: int, delay: float) -> Record:
    """Force and height of one pantograph as those of the other, later by a delay [s]."""
    channels = {name: getattr(record, name).copy() for name in ("force", "contact_height")}
    for rows in channels.values():
        rows[1 - source] = np.interp(record.time - delay, record.time, rows[source])
    return replace(record, **channels)


def test_different_pantographs_are_no_copies(run: tuple[Case, Record]) -> None:
    case, record = run
    assert COPY.run(case, read_signals(case, record)) is None


@pytest.mark.parametrize("source", [0, 1])
def test_force_and_height_of_the_other_pantograph_are_found(run: tuple[Case, Record], source: int) -> None:
    """At the same place; no other check finds it. Rounding to 1 N leaves 0.003 of the standard deviation."""
    case, record = run
    delay = (1 - 2 * source) * 100.0 / record.speed
    copy = take(record, source, delay)
    for force in (copy.force, copy.force.round()):
        findings = check_record(case, read_signals(case, replace(copy, force=force)))
        assert {name: finding.kind for name, finding in findings.items()} == {"copy": "doubt"}
        assert "is a copy of that of pantograph" in findings["copy"].text
        assert " mm" in findings["copy"].text


@pytest.mark.parametrize("source", [0, 1])
def test_copy_of_the_same_time_is_in_another_part_of_the_span(run: tuple[Case, Record], source: int) -> None:
    """The spacing of 100 m is not a multiple of the span of 55 m."""
    case, record = run
    finding = COPY.run(case, read_signals(case, take(record, source, 0.0)))
    assert finding.text.endswith("in another part of the span")


@pytest.fixture
def alike(wave: type[Wave], two_pantograph_case: Case) -> Record:
    """Two pantographs that meet the same line: the same force and uplift in every span."""
    return wave().record(two_pantograph_case)


def lift(record: Record, second: float) -> Record:
    """The uplift where the second pantograph passes, 1 + second times that of the first."""
    near = np.abs(record.position[1] - record.support_position[:, None]) < 30.0
    return replace(record, support_uplift=np.where(near, (1 + second) * record.support_uplift, record.support_uplift))


@pytest.mark.parametrize(("second", "found"), [(0.0, False), (0.004, False), (0.03, True)])
def test_equal_forces_need_equal_uplifts(two_pantograph_case: Case, alike: Record, second: float, found: bool) -> None:
    """Differences of 0, 0.2 and 1.5 mm of 50 mm; the tolerance is 0.5 mm."""
    finding = COPY.run(two_pantograph_case, read_signals(two_pantograph_case, lift(alike, second)))
    assert (finding is not None) == found


def test_copy_stays_unverified_without_the_uplift_to_compare(run: tuple[Case, Record]) -> None:
    """A copy at the same time, two spans of 55 m behind, needs the uplift at supports two spans apart."""
    # A record without these supports, or without their uplift at the passage, does not become verified.
    case, record = run
    spaced = replace(record, position=np.array([record.position[0], record.position[0] - 110.0]))
    copy = take(spaced, 0, 0.0)
    assert COPY.run(case, read_signals(case, copy)) is not None
    two = slice(0, 2)
    few = replace(copy, support_position=record.support_position[two], support_uplift=record.support_uplift[two])
    finding = COPY.run(case, read_signals(case, few))
    assert (finding.kind, finding.text[-42:]) == ("unchecked", "lacks the uplift at 2 of 2 supports to compare"[-42:])
    before = record.support_position < case.analysis_section[0]
    passes = np.abs(spaced.position[1] - record.support_position[:, None]) < 1.0
    gaps = np.where(before[:, None] & passes, np.nan, record.support_uplift)
    finding = COPY.run(case, read_signals(case, replace(copy, support_uplift=gaps)))
    assert finding is not None


def test_record_without_uplift_is_left_to_other_checks(two_pantograph_case: Case, alike: Record) -> None:
    bare = replace(alike, support_uplift=None, support_position=None)
    assert COPY.run(two_pantograph_case, read_signals(two_pantograph_case, bare)) is None


def test_likeness_of_exact_parts() -> None:
    """A scaled and shifted part is found between samples; the negative one is no copy; short and constant have none."""
    time = np.arange(4000) / 500.0
    noise = np.random.default_rng(1).normal(0.0, 1.0, time.size)
    signal = Filter(cutoff_Hz=20.0)(noise, 500.0)
    shifted = np.interp(time[700:1700] + 0.3 / 500.0, time, signal)
    likeness = find_likeness(2.0 * shifted + 5.0, signal)
    assert_allclose(likeness.lag, 700.3, atol=0.02)
    assert likeness.remainder < 0.01
    opposite = find_likeness(-signal[700:1700], signal)
    assert opposite.remainder > 0.8
    assert find_likeness(signal, signal[:-1]) is None
    assert find_likeness(np.ones(100), signal) is None

"""Content of the force at 30-50 Hz: the same filter of force and contact height is found, a stated one is accepted."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from helpers.extreme_runs import build_case, list_kinds, list_problems, read_signals, simulate
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.runs.force_content import (
    CONTENT,
    COPY,
    bending_length,
    find_likeness,
    force_content,
    kink_content,
)
from pantocheck.conformance.runs.record_checks import check_record

Series = NDArray[np.float64]


@pytest.fixture(scope="module")
def run() -> tuple[Case, Record]:
    """Two pantographs 100 m apart at 250 km/h on the AC simple line."""
    case = build_case()
    return case, simulate(case)


def smooth(record: Record, rows: tuple[int, ...], low_pass: Callable[[Series, float], Series]) -> Record:
    """Force and contact height of some pantographs after the same filter."""
    force, height = record.force.copy(), np.array(record.contact_height)
    for row in rows:
        force[row], height[row] = (low_pass(channel[row], record.rate) for channel in (force, height))
    return replace(record, force=force, contact_height=height)


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize("phase", ["zero", "causal"])
def test_same_filter_of_force_and_height_is_found(run: tuple[Case, Record], row: int, phase: str) -> None:
    """At 10 Hz; the equations of the pantograph hold for the filtered channels too."""
    case, record = run
    filtered = smooth(record, (row,), Filter(cutoff_Hz=10.0, phase=phase))
    finding = check_record(case, read_signals(case, filtered))["content"]
    assert finding.kind == "doubt"
    assert finding.text.startswith(f"pantograph {row + 1}: the force has 0.0")


@pytest.mark.parametrize("row", [0, 1])
def test_no_other_check_finds_the_same_filter(run: tuple[Case, Record], row: int) -> None:
    case, record = run
    assert list_kinds(case, smooth(record, (row,), Filter(cutoff_Hz=10.0))) == {"content": "doubt"}


@pytest.mark.parametrize("phase", ["zero", "causal"])
@pytest.mark.parametrize(("cutoff", "stated"), [(20.0, 20.0), (40.0, 40.0), (100.0, None)])
def test_stated_filter_is_accepted(run: tuple[Case, Record], phase: str, cutoff: float, stated: float | None) -> None:
    """A filter at 100 Hz, as against aliasing, need not be stated."""
    case, record = run
    filtered = replace(smooth(record, (0, 1), Filter(cutoff_Hz=cutoff, phase=phase)), filter_applied_Hz=stated)
    assert "content" not in list_kinds(case, filtered)


def test_slow_train_and_low_rate(run: tuple[Case, Record]) -> None:
    """Bending of the wire, over 0.094 m, rounds kinks at 50 Hz below 29.6 m/s; 80 samples per second end at 32 Hz."""
    case, record = run
    filtered = smooth(record, (0, 1), Filter(cutoff_Hz=10.0))
    assert_allclose(bending_length(case), np.sqrt(195.0 / 22e3))
    for speed, found in ((29.0, False), (30.0, True)):
        assert (CONTENT.run(case, read_signals(case, replace(filtered, speed=speed))).kind == "doubt") == found
    slow = {name: getattr(record, name)[:, ::6] for name in ("position", "force", "contact_height", "support_uplift")}
    finding = CONTENT.run(case, read_signals(case, replace(record, time=record.time[::6], **slow)))
    assert finding.kind == "unchecked"


def test_content_of_a_rigid_head_on_a_rigid_wire(run: tuple[Case, Record]) -> None:
    """A stiff contact on a heavy wire: F ~ w^2 m / f^2 of the head of 7.51 kg, which vibrates freely above 5 Hz."""
    case, _ = run
    wire = case.line.contact_wire.model_copy(update={"mass_kg_m": 1e12})
    (pantograph, *_) = case.pantographs
    chain = pantograph.chain.model_copy(update={"stiffness_N_m": (0.0, 0.0, 0.0), "damping_N_s_m": (0.0, 0.0, 0.0)})
    contact = pantograph.contact.model_copy(update={"stiffness_N_m": 1e12})
    rigid = pantograph.model_copy(update={"chain": chain, "contact": contact})
    changed = replace(
        case, line=case.line.model_copy(update={"contact_wire": wire}), pantographs=(rigid, case.pantographs[1])
    )
    # A spectrum that is constant: the bands of 20 and 15 Hz have the ratio of the roots of their widths.
    assert_allclose(kink_content(changed, 1, 50.0), np.sqrt(20 / 15), rtol=5e-3)


def test_content_of_sines_and_of_a_filter_stated_as_that_of_the_case(run: tuple[Case, Record]) -> None:
    """Sines of 10 and 40 Hz with amplitudes 20 and 3 N: 0.15, up to leakage of the window."""
    case, record = run
    time = record.time
    sines = 20.0 * np.sin(2 * np.pi * 10.0 * time) + 3.0 * np.sin(2 * np.pi * 40.0 * time)
    signals = read_signals(case, replace(record, force=np.array([sines, sines])))
    for number in (1, 2):
        assert_allclose(force_content(signals, number, 50.0), 0.15, rtol=1e-3)
    # The stated filter is divided out: the filter at 10 Hz still leaves 64 times less content at 30-50 Hz.
    case, record = run
    filtered = replace(smooth(record, (0, 1), Filter(cutoff_Hz=10.0)), filter_applied_Hz=20.0)
    assert list_kinds(case, filtered)["content"] == "doubt"


# Copied force: found where the uplift shows that the pantographs did not meet the same line.


@pytest.fixture(scope="module")
def slow_run() -> tuple[Case, Record]:
    """Two pantographs with a soft contact, 100 m apart at 120 km/h: the lift of the wire differs by 0.7 to 1.2 mm."""
    case = build_case(speed=120.0, contact={"stiffness_N_m": 5e3})
    return case, simulate(case)


def take(record: Record, source: int, delay: float) -> Record:
    """Force and height of one pantograph as those of the other, later by a delay [s]."""
    channels = {name: getattr(record, name).copy() for name in ("force", "contact_height")}
    for rows in channels.values():
        rows[1 - source] = np.interp(record.time - delay, record.time, rows[source])
    return replace(record, **channels)


def test_other_records_are_no_copies(slow_run: tuple[Case, Record], two_pantograph_case: Case, alike: Record) -> None:
    case, record = slow_run
    assert COPY.run(case, read_signals(case, record)).kind == "confirmed"
    bare = replace(alike, support_uplift=None, support_position=None)
    assert COPY.run(two_pantograph_case, read_signals(two_pantograph_case, bare)).kind == "confirmed"


@pytest.mark.parametrize("source", [0, 1])
def test_force_and_height_of_the_other_pantograph_are_found(slow_run: tuple[Case, Record], source: int) -> None:
    """At the same place; no other check finds it. Rounding to 1 N leaves 0.003 of the standard deviation."""
    case, record = slow_run
    delay = (1 - 2 * source) * 100.0 / record.speed
    copy = take(record, source, delay)
    for force in (copy.force, copy.force.round()):
        findings = list_problems(case, read_signals(case, replace(copy, force=force)))
        assert {name: finding.kind for name, finding in findings.items()} == {"copy": "doubt"}
        assert "is a copy of that of pantograph" in findings["copy"].text
        assert " mm" in findings["copy"].text


@pytest.mark.parametrize("source", [0, 1])
def test_copy_of_the_same_time_is_in_another_part_of_the_span(slow_run: tuple[Case, Record], source: int) -> None:
    """The spacing of 100 m is not a multiple of the span of 55 m."""
    case, record = slow_run
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
    assert (finding.kind != "confirmed") == found


def test_copy_stays_unconfirmed_without_the_uplift_to_compare(slow_run: tuple[Case, Record]) -> None:
    """A copy at the same time, two spans of 55 m behind, needs the uplift at supports two spans apart."""
    # A record without these supports, or without their uplift at the passage, does not become verified.
    case, record = slow_run
    spaced = replace(record, position=np.array([record.position[0], record.position[0] - 110.0]))
    copy = take(spaced, 0, 0.0)
    assert COPY.run(case, read_signals(case, copy)).kind != "confirmed"
    two = slice(0, 2)
    few = replace(copy, support_position=record.support_position[two], support_uplift=record.support_uplift[two])
    finding = COPY.run(case, read_signals(case, few))
    assert (finding.kind, finding.text[-42:]) == ("unchecked", "lacks the uplift at 2 of 2 supports to compare"[-42:])
    before = record.support_position < case.analysis_section[0]
    passes = np.abs(spaced.position[1] - record.support_position[:, None]) < 1.0
    gaps = np.where(before[:, None] & passes, np.nan, record.support_uplift)
    finding = COPY.run(case, read_signals(case, replace(copy, support_uplift=gaps)))
    assert finding.kind


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
    assert find_likeness(np.array([0.0, 1.0]), np.array([5.0, 5.0, 7.0, 5.0])).lag == 1.0
    assert find_likeness(signal, signal[:-1]) is None
    assert find_likeness(np.ones(100), signal) is None

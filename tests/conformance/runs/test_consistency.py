"""Consistency checks: no finding on correct records, a diagnosis of wrong ones, a note on missing channels."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import lsim

from helpers.extreme_runs import list_problems
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs import force_dynamics
from pantocheck.conformance.runs.check import HOLDS, CheckName, Finding, Measure, report_low_rate, report_missing
from pantocheck.conformance.runs.force_dynamics import (
    DYNAMICS,
    LATE_MISFIT,
    MISFIT,
    ResponseFit,
    compare_motion,
    head_responses,
)
from pantocheck.conformance.runs.record_checks import (
    MOTION,
    RECORD_CHECKS,
    _compare,
    judge_record_state,
    list_check_rows,
)
from pantocheck.conformance.runs.system import Delivered


@pytest.fixture
def record(wave: type[Wave], case_250: Case) -> Record:
    """A sine of the force and the motion that follows from it; no content above the span-passing frequency."""
    return wave().record(case_250)


@pytest.fixture
def rough(record: Record) -> Record:
    """The same force with white noise up to 100 Hz from a fixed seed; no contact height."""
    noise = np.random.default_rng(1).normal(0.0, 12.0, record.time.size)
    return replace(record, force=record.force + Filter(cutoff_Hz=100.0)(noise, record.rate), contact_height=None)


def findings(case: Case, record: Record) -> dict[CheckName, Finding]:
    return list_problems(case, RecordSignals(record, case.file.filter))


def kinds(case: Case, record: Record) -> list[tuple[CheckName, str]]:
    return [(name, finding.kind) for name, finding in findings(case, record).items()]


def test_correct_record_has_no_finding_as_it_is_rounded_or_at_the_wire(case_250: Case, record: Record) -> None:
    assert findings(case_250, record) == {}
    # Heights to 0.1 mm, and heights of the wire, which the head penetrates by force over stiffness.
    assert findings(case_250, replace(record, contact_height=np.round(record.contact_height, 4))) == {}
    wire = record.contact_height - record.force / case_250.pantographs[0].contact.stiffness_N_m
    assert findings(case_250, replace(record, contact_height=wire + 5.5)) == {}
    for gain in (0.98, 1.02):  # within the tolerance
        assert findings(case_250, replace(record, force=gain * record.force)) == {}


@pytest.mark.parametrize("gain", [1e-3, 0.05, 0.9, 1.05, 1000.0, -1.0])
def test_wrong_gain_of_the_force_is_found_and_stated(case_250: Case, record: Record, gain: float) -> None:
    found = findings(case_250, replace(record, force=gain * record.force))
    assert [name for name, finding in found.items() if finding.kind == "contradiction"] == ["dynamics"]
    assert f"corresponds to {1 / gain:.3g} times the force" in found["dynamics"].text


@pytest.mark.parametrize(
    ("samples", "delay"), [(100, "lags the height by about 0.1 s"), (-50, "leads the height by about 0.05 s")]
)
def test_shift_in_time_is_found_and_stated(case_250: Case, record: Record, samples: int, delay: str) -> None:
    """A shifted slow sine looks like one of another amplitude: the test needs a force with more content."""
    chain, time = case_250.pantographs[0].chain, record.time
    k, c = chain.stiffness_N_m, chain.damping_N_s_m
    stiffness, damping = (np.array([[pair[0] + pair[1], -pair[1]], [-pair[1], pair[1]]]) for pair in (k, c))
    inverse = np.diag(1 / np.array(chain.masses_kg))
    state = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ stiffness, -inverse @ damping]])
    drive = np.array([[0.0], [0.0], [0.0], [-1 / chain.masses_kg[1]]])
    system = (state, drive, np.array([[0.0, 1.0, 0.0, 0.0]]), np.zeros((1, 1)))
    slow = Filter(cutoff_Hz=3.0)(np.random.default_rng(2).normal(0.0, 300.0, time.size), record.rate)
    force = 119.0 + slow + 0.5 * np.sin(2 * np.pi * 40.0 * time)  # every contact force has content above 20 Hz
    height = lsim(system, slow, time)[1]
    passing = np.interp(record.support_position, record.position[0], time)
    wire = np.interp(passing, time, height - force / case_250.pantographs[0].contact.stiffness_N_m)
    uplift = record.support_uplift + wire[:, None]  # contact height and uplift agree at every support
    whole = replace(record, force=force[None], contact_height=height[None], support_uplift=uplift)
    assert kinds(case_250, whole) == []
    finding = findings(case_250, replace(whole, force=np.roll(force, samples)[None]))["dynamics"]
    assert finding.kind == "contradiction"
    assert delay in finding.text
    # A filter that only runs forwards delays the force by 0.02 s at 20 Hz: that is no contradiction.
    causal = Filter(phase="causal")(force, record.rate)
    late = replace(whole, force=causal[None], filter_applied_Hz=20.0)
    assert kinds(case_250, late) == [("dynamics", "doubt")]


def fit_file(file: PantographFile, force: RealArray, height: RealArray, step: float) -> ResponseFit:
    fit = compare_motion(file, force, height, head_responses(file, force, step))
    assert fit is not None
    return fit


def test_constant_force_and_exact_fit(case_250: Case, record: Record) -> None:
    """The response to straight lines between samples is exact up to (w dt)^2/12 = 4e-6 at 1.16 Hz and 1 ms."""
    fit = fit_file(case_250.pantographs[0], record.force[0], record.contact_height[0], 1e-3)
    assert_allclose([fit.gain, fit.misfit], [1.0, 0.0], atol=1e-4)
    # A dead channel: 119 N throughout, while the contact point goes up and down.
    ((name, finding),) = findings(case_250, replace(record, force=np.full_like(record.force, 119.0))).items()
    assert (name, finding.kind) == ("dynamics", "contradiction")


def test_missing_or_weak_filter_is_found(case_250: Case, rough: Record) -> None:
    def kinds_after_filter(order: int | None) -> list[tuple[CheckName, str]]:
        force = rough.force if order is None else Filter(order=order)(rough.force[0], rough.rate)[None]
        return kinds(case_250, replace(rough, force=force, filter_applied_Hz=20.0))

    without_height = ("dynamics", "unchecked")
    assert kinds_after_filter(None) == [("roll-off", "contradiction")]
    assert kinds_after_filter(2) == [("roll-off", "contradiction")]
    assert kinds_after_filter(6) == kinds_after_filter(8) == [without_height]
    assert kinds(case_250, rough) == [without_height]
    # At 100 samples per second nothing is known of 40 to 50 Hz.
    slow = replace(
        rough, time=rough.time[::10], position=rough.position[:, ::10], force=rough.force[:, ::10],
        support_uplift=rough.support_uplift[:, ::10], filter_applied_Hz=20.0,
    )  # fmt: skip
    assert kinds(case_250, slow) == [("roll-off", "unchecked"), without_height]


def test_positions_that_contradict_speed_or_supports_are_found(case_250: Case, record: Record) -> None:
    start = record.position[:, :1]
    for speed in (0.99, 1.01):
        moved = replace(record, position=start + speed * (record.position - start))
        assert ("motion", "contradiction") in kinds(case_250, moved)
    assert kinds(case_250, moved) == [("motion", "contradiction")]
    exact = SimpleNamespace(time=np.linspace(0.0, 1.0, 11), position=np.linspace(0.0, 50.0, 11)[None], speed=50.0)
    assert MOTION.run(case_250, SimpleNamespace(record=exact)).kind == "confirmed"
    for shift, found in ((10.0, [("support passing", "contradiction")]), (3.0, [])):
        assert kinds(case_250, replace(record, position=record.position + shift)) == found
    assert kinds(case_250, replace(record, support_position=None, support_uplift=None)) == [
        ("support passing", "unchecked")
    ]


def test_contradiction_is_an_error_and_a_missing_channel_a_note(case_250: Case, record: Record) -> None:
    wrong = grade_case(case_250, Delivered(replace(record, force=1.05 * record.force)), "secondary")
    assert (wrong.verdict, wrong.criteria) == ("error", [])
    assert "check gain and unit of the force" in (wrong.reason or "")
    assert wrong.quantities["1"]["mean_force_N"] == pytest.approx(1.05 * 119.0, rel=1e-4)
    bare = grade_case(case_250, Delivered(replace(record, contact_height=None)), "secondary")
    assert bare.criteria
    assert any(note.startswith("the dynamics check was not made") for note in bare.notes)


# State of a record by the findings of its checks.
def test_state_follows_from_the_worst_finding() -> None:
    """Beside a contradiction, a missing channel is not the reason: the record cannot be graded even with it."""
    confirmed = {check.name: HOLDS for check in RECORD_CHECKS}
    rows = list_check_rows(confirmed)
    assert {row.outcome for row in rows} == {"confirmed"}
    assert judge_record_state(rows) == ("consistent", "every consistency check that applies confirms the record")
    findings = confirmed | {"support passing": report_missing("no uplift")}
    late = {"dynamics": LATE_MISFIT.compare(0.2, text="late force")}
    assert judge_record_state(list_check_rows(findings | late)) == (
        "unconfirmed",
        "no uplift; late force",
    )
    reached = dict(list(findings.items())[:5])
    rows = list_check_rows(reached | {"dynamics": MISFIT.compare(0.2, text="gain")})
    assert judge_record_state(rows) == ("contradicted", "gain")
    outcomes = {row.check: row.outcome for row in rows}
    assert (outcomes["roll-off"], outcomes["implied force"]) == ("confirmed", "not reached")


# Dynamics check: thresholds on both sides, the stated cause, and either pantograph alone.


Disturb = Callable[[int, float], Record]
"""Function that disturbs the motion of one head."""


def check(case: Case, train_record: Record) -> Finding:
    return DYNAMICS.run(case, RecordSignals(train_record, case.file.filter))


def check_outcome(case: Case, train_record: Record) -> tuple[str, str]:
    found = check(case, train_record)
    return found.kind, found.text


def fit_pantograph(case: Case, train_record: Record, row: int) -> ResponseFit:
    """Fit of one pantograph to every second sample of the section: 25 per period of 20 Hz, at 1000 Hz."""
    low_pass, signals = case.file.filter, RecordSignals(train_record, case.file.filter)
    first, last = np.searchsorted(train_record.position[row], signals.pantographs[row + 1].section)
    force, height = (
        low_pass(channel[row], train_record.rate)[first:last:2]
        for channel in (train_record.force, train_record.contact_height)
    )
    return fit_file(case.pantographs[row], force, height, 2 / train_record.rate)


@pytest.fixture
def train_record(two_pantograph_case: Case) -> Record:
    return Wave().record(two_pantograph_case)


@pytest.fixture
def disturb(train_record: Record) -> Disturb:
    """Record with a motion of one head that the force does not explain, as a share of its motion."""

    def disturb(row: int, share: float) -> Record:
        height = train_record.contact_height.copy()
        other = np.sin(2 * np.pi * train_record.position[row] / 20.0)
        height[row] += share / np.sqrt(1 - share**2) * height[row].std() * other / other.std()
        return replace(train_record, contact_height=height)

    return disturb


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize("share", [0.13, 0.4])
def test_motion_that_the_force_does_not_explain_is_stated(
    two_pantograph_case: Case, disturb: Disturb, row: int, share: float
) -> None:
    """Three periods per span are added to one; the fit of free motions takes a part of either away."""
    train_record = disturb(row, share)
    unexplained = fit_pantograph(two_pantograph_case, train_record, row).unexplained
    assert unexplained == pytest.approx(share, abs=0.05)
    assert check_outcome(two_pantograph_case, train_record) == (
        "contradiction",
        f"pantograph {row + 1}: the contact force contradicts the contact height: "
        f"the force explains only {100 * (1 - unexplained):.0f} % of the motion",
    )


@pytest.mark.parametrize(("share", "accepted"), [(0.09, True), (0.12, False)])
def test_misfit_up_to_a_tenth_is_accepted(
    two_pantograph_case: Case, disturb: Disturb, share: float, accepted: bool
) -> None:
    """The misfit s / sqrt(1 - s^2) is 0.09 and 0.12; its threshold is 0.1."""
    assert (check(two_pantograph_case, disturb(1, share)).kind == "confirmed") is accepted


def test_value_on_a_threshold_is_accepted(
    two_pantograph_case: Case, disturb: Disturb, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each threshold in turn is set to the very number of the record."""
    train_record = disturb(0, 0.12)
    result = fit_pantograph(two_pantograph_case, train_record, 0)
    numbers = {"misfit": result.misfit, "gain": abs(1 / result.gain - 1)}
    exact = tuple(Measure(name, "", {"contradiction": number}) for name, number in numbers.items())
    assert force_dynamics._compare(1, result, measures=exact).kind == "confirmed"
    monkeypatch.setattr(force_dynamics, "CLEAR", result.unexplained)
    found = check(two_pantograph_case, train_record)
    assert "explains only" in found.text, "the share that remains is not below the threshold"


def test_causal_filter_delays_by_less_than_its_period_by_three_quarters() -> None:
    """Force 8 samples of 1/64 s late, 0.125 s: three quarters of the period of 6 Hz, and less than that of 5.9 Hz."""
    motion = np.random.default_rng(2).normal(size=600)
    fit = ResponseFit(1.0, 1.0, 1.0, motion[8:], motion[:-8])
    kinds = [force_dynamics._diagnose(1, fit, 1 / 64, cutoff).kind for cutoff in (5.9, 6.0)]
    assert kinds == ["doubt", "contradiction"]


def test_tolerance_of_the_mean_force_has_the_change_of_momentum(case_250: Case) -> None:
    """By hand: 3 % of 120 N, 2 * 50 N/m * 0.25 m, and 22.2 kg * 1.98 m/s in 1.01 s from z = t^2 - t: 72 N."""
    time = np.linspace(0.0, 1.0, 101)
    pantograph = SimpleNamespace(
        delivered=np.full(101, 300.0), height=time**2 - time, force=SimpleNamespace(rate=100.0)
    )
    finding = _compare(1, pantograph, case_250.pantographs[0], case_250.lift_forces[0], 0.0)
    assert finding.text.endswith("120 N allows a difference of 72 N")


@pytest.mark.parametrize(("rate", "made"), [(50.0, True), (49.0, False)])
def test_check_needs_a_rate_for_the_filter(two_pantograph_case: Case, rate: float, made: bool) -> None:
    """20 Hz are 0.4 of 50 samples per second."""
    found = check(two_pantograph_case, Wave(rate=rate).record(two_pantograph_case))
    too_low = report_low_rate("dynamics", rate)
    assert found.text == ("" if made else f"the dynamics check was not made: a rate of {rate:g} Hz is too low")
    assert made or found == too_low


@pytest.mark.parametrize("row", [0, 1])
def test_still_head_under_a_constant_force_is_not_checked(
    two_pantograph_case: Case, train_record: Record, row: int
) -> None:
    """RMS of 0.9 mm without a response: below the millimetre to which heights are rounded; 1.4 mm are above it."""
    # The fit of free motions takes a fifth of the motion away.
    force, height = train_record.force.copy(), train_record.contact_height.copy()
    force[row] = 119.0
    height[row] *= 0.9e-3 / height[row].std()
    found = check(two_pantograph_case, replace(train_record, force=force, contact_height=height))
    assert (found.kind, found.text) == (
        "unchecked",
        f"the dynamics check was not made: the head of pantograph {row + 1} hardly moves",
    )
    height[row] *= 1.6
    moving = check(two_pantograph_case, replace(train_record, force=force, contact_height=height))
    assert moving.kind == "contradiction"

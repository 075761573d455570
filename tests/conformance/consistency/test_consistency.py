"""Checks of a record: silent on right ones, telling on wrong ones, and honest about what they cannot see."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import lsim

from pantocheck.conformance.consistency.force_dynamics import fit_motion
from pantocheck.conformance.consistency.record_checks import check_record
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.quantities.filters import LowPass
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.results.outcome import Delivered


@pytest.fixture
def record(wave, case_250):
    """A sine of the force and the motion that follows from it; no content above the span passing frequency."""
    return wave().record(case_250)


@pytest.fixture
def rough(record):
    """The same with white noise up to 100 Hz, as a seventh of the whole, from a fixed seed."""
    noise = np.random.default_rng(1).normal(0.0, 12.0, record.time.size)
    return replace(record, force=record.force + LowPass(cutoff_Hz=100.0)(noise, record.rate), contact_height=None)


def findings(case, record):
    return check_record(case, RecordSignals(record, case.file.filter.low_pass))


def kinds(case, record):
    return [(name, finding.kind) for name, finding in findings(case, record).items()]


def test_right_record_raises_nothing(case_250, record):
    assert findings(case_250, record) == {}


def test_right_record_rounded_or_given_at_the_wire_raises_nothing(case_250, record):
    """Heights in whole millimetres; and the wire, into which the head sinks by force over contact stiffness."""
    assert findings(case_250, replace(record, contact_height=np.round(record.contact_height, 3))) == {}
    wire = record.contact_height - record.force / case_250.pantographs[0].contact.stiffness_N_m
    assert findings(case_250, replace(record, contact_height=wire + 5.5)) == {}


@pytest.mark.parametrize("gain", [1e-3, 0.05, 0.9, 1.05, 1000.0, -1.0])
def test_gain_of_the_force_is_seen_and_named(case_250, record, gain):
    ((name, finding),) = findings(case_250, replace(record, force=gain * record.force)).items()
    assert (name, finding.kind) == ("dynamics", "contradiction")
    assert f"follows from {1 / gain:.3g} times the force" in finding.text


def test_force_that_does_not_move_what_moves_is_seen(case_250, record):
    """A dead channel: 119 N throughout, while the contact point goes up and down."""
    ((name, finding),) = findings(case_250, replace(record, force=np.full_like(record.force, 119.0))).items()
    assert (name, finding.kind) == ("dynamics", "contradiction")


@pytest.mark.parametrize("gain", [0.98, 1.02])
def test_gain_within_the_tolerance_is_not(case_250, record, gain):
    assert findings(case_250, replace(record, force=gain * record.force)) == {}


@pytest.mark.parametrize(("samples", "said"), [(100, "0.1 s later"), (-50, "0.05 s earlier")])
def test_shift_in_time_is_seen_and_named(case_250, record, samples, said):
    """A slow sine shifted in time looks like one of another amplitude: the shift needs a force with more in it."""
    chain, time = case_250.pantographs[0].chain, record.time
    k, c = chain.stiffness_N_m, chain.damping_N_s_m
    stiffness, damping = (np.array([[one[0] + one[1], -one[1]], [-one[1], one[1]]]) for one in (k, c))
    inverse = np.diag(1 / np.array(chain.masses_kg))
    state = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ stiffness, -inverse @ damping]])
    drive = np.array([[0.0], [0.0], [0.0], [-1 / chain.masses_kg[1]]])
    system = (state, drive, np.array([[0.0, 1.0, 0.0, 0.0]]), np.zeros((1, 1)))
    slow = LowPass(cutoff_Hz=3.0)(np.random.default_rng(2).normal(0.0, 300.0, time.size), record.rate)
    force = 119.0 + slow
    height = lsim(system, slow, time)[1]
    whole = replace(record, force=force[None], contact_height=height[None])
    assert kinds(case_250, whole) == []
    ((name, finding),) = findings(case_250, replace(whole, force=np.roll(force, samples)[None])).items()
    assert (name, finding.kind) == ("dynamics", "contradiction")
    assert f"about {said}" in finding.text
    # A filter that only runs forwards delays the force by 0.02 s at 20 Hz: that is no contradiction.
    causal = LowPass(phase="causal")(force, record.rate)
    late = replace(whole, force=causal[None], filter_applied_Hz=20.0)
    assert kinds(case_250, late) == [("dynamics", "doubt")]


def test_fit_of_a_record_of_its_own_is_exact(case_250, record):
    """The response to straight lines between samples is exact up to (w dt)^2/12 = 4e-6 at 1.16 Hz and 1 ms."""
    fit = fit_motion(case_250.pantographs[0], record.force[0], record.contact_height[0], 1e-3)
    assert_allclose([fit.gain, fit.misfit], [1.0, 0.0], atol=1e-4)


def test_force_that_was_not_filtered_or_too_weakly_is_seen(case_250, rough):
    def said(order):
        force = rough.force if order is None else LowPass(order=order)(rough.force[0], rough.rate)[None]
        return kinds(case_250, replace(rough, force=force, filter_applied_Hz=20.0))

    without_height = ("dynamics", "unchecked")
    assert said(None) == [("roll-off", "contradiction")]
    assert said(2) == [("roll-off", "contradiction")]
    assert said(6) == said(8) == [without_height]
    assert kinds(case_250, rough) == [without_height]
    # At 100 samples per second nothing is known of 40 to 50 Hz.
    slow = replace(
        rough, time=rough.time[::10], position=rough.position[:, ::10], force=rough.force[:, ::10],
        support_uplift=rough.support_uplift[:, ::10], filter_applied_Hz=20.0,
    )  # fmt: skip
    assert kinds(case_250, slow) == [("roll-off", "unchecked"), without_height]


def test_positions_against_speed_supports_and_stretch(case_250, record):
    start = record.position[:, :1]
    faster = replace(record, position=start + 1.01 * (record.position - start))
    assert kinds(case_250, faster) == [("motion", "contradiction")]
    for shift, found in ((10.0, [("support passing", "contradiction")]), (3.0, [])):
        assert kinds(case_250, replace(record, position=record.position + shift)) == found
    assert kinds(case_250, replace(record, support_position=None, support_uplift=None)) == [
        ("support passing", "unchecked")
    ]


def test_contradiction_is_the_error_of_its_case_and_a_missing_channel_a_note(case_250, record):
    wrong = grade_case(case_250, Delivered(replace(record, force=1.05 * record.force)), "secondary")
    assert (wrong.verdict, wrong.criteria) == ("error", [])
    assert "check its gain and unit" in (wrong.reason or "")
    assert wrong.quantities["1"]["mean_force_N"] == pytest.approx(1.05 * 119.0, rel=1e-4)
    bare = grade_case(case_250, Delivered(replace(record, contact_height=None)), "secondary")
    assert bare.criteria
    assert any(note.startswith("not checked, force against motion") for note in bare.notes)

"""Dynamics check: thresholds on both sides, the stated cause, and either pantograph alone."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs import force_dynamics
from pantocheck.conformance.runs.check import Finding
from pantocheck.conformance.runs.force_dynamics import DYNAMICS, ResponseFit, fit_motion

Disturb = Callable[[int, float], Record]
"""Function that disturbs the motion of one head."""


def check(case: Case, record: Record) -> Finding | None:
    return DYNAMICS.run(case, RecordSignals(record, case.file.filter))


def fit(case: Case, record: Record, row: int) -> ResponseFit:
    """Fit of one pantograph to every second sample of the section: 25 per period of 20 Hz, at 1000 Hz."""
    low_pass, signals = case.file.filter, RecordSignals(record, case.file.filter)
    first, last = np.searchsorted(record.position[row], signals.pantographs[row + 1].section)
    force, height = (
        low_pass(channel[row], record.rate)[first:last:2] for channel in (record.force, record.contact_height)
    )
    return fit_motion(case.pantographs[row], force, height, 2 / record.rate)


@pytest.fixture
def record(two_pantograph_case: Case) -> Record:
    return Wave().record(two_pantograph_case)


@pytest.fixture
def disturb(record: Record) -> Disturb:
    """Record with a motion of one head that the force does not explain, as a share of its motion."""

    def disturb(row: int, share: float) -> Record:
        height = record.contact_height.copy()
        other = np.sin(2 * np.pi * record.position[row] / 20.0)
        height[row] += share / np.sqrt(1 - share**2) * height[row].std() * other / other.std()
        return replace(record, contact_height=height)

    return disturb


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize("share", [0.13, 0.4])
def test_motion_that_the_force_does_not_explain_is_stated(
    two_pantograph_case: Case, disturb: Disturb, row: int, share: float
) -> None:
    """Three periods per span are added to one; the fit of free motions takes a part of either away."""
    record = disturb(row, share)
    unexplained = fit(two_pantograph_case, record, row).unexplained
    assert unexplained == pytest.approx(share, abs=0.05)
    assert check(two_pantograph_case, record) == Finding(
        "contradiction",
        f"pantograph {row + 1}: the contact force contradicts the contact height: "
        f"the force explains only {100 * (1 - unexplained):.0f} % of the motion",
    )


@pytest.mark.parametrize(("share", "accepted"), [(0.09, True), (0.12, False)])
def test_misfit_up_to_a_tenth_is_accepted(
    two_pantograph_case: Case, disturb: Disturb, share: float, accepted: bool
) -> None:
    """The misfit s / sqrt(1 - s^2) is 0.09 and 0.12; its threshold is 0.1."""
    assert (check(two_pantograph_case, disturb(1, share)) is None) is accepted


def test_value_on_a_threshold_is_accepted(
    two_pantograph_case: Case, disturb: Disturb, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each threshold in turn is set to the very number of the record."""
    record = disturb(0, 0.12)
    result = fit(two_pantograph_case, record, 0)
    monkeypatch.setattr(force_dynamics, "LARGEST_MISFIT", result.misfit)
    monkeypatch.setattr(force_dynamics, "LARGEST_GAIN_ERROR", abs(1 / result.gain - 1))
    assert check(two_pantograph_case, record) is None
    monkeypatch.setattr(force_dynamics, "LARGEST_MISFIT", 0.1)
    monkeypatch.setattr(force_dynamics, "CLEAR", result.unexplained)
    found = check(two_pantograph_case, record)
    assert "explains only" in found.text, "the share that remains is not below the threshold"


@pytest.mark.parametrize(("rate", "made"), [(50.0, True), (49.0, False)])
def test_check_needs_a_rate_for_the_filter(two_pantograph_case: Case, rate: float, made: bool) -> None:
    """20 Hz are 0.4 of 50 samples per second."""
    found = check(two_pantograph_case, Wave(rate=rate).record(two_pantograph_case))
    too_low = Finding("unchecked", f"the dynamics check was not made: a rate of {rate:g} Hz is too low")
    assert found == (None if made else too_low)


@pytest.mark.parametrize("row", [0, 1])
def test_still_head_under_a_constant_force_is_not_checked(two_pantograph_case: Case, record: Record, row: int) -> None:
    """RMS of 0.9 mm without a response: below the millimetre to which heights are rounded; 1.4 mm are above it."""
    # The fit of free motions takes a fifth of the motion away.
    force, height = record.force.copy(), record.contact_height.copy()
    force[row] = 119.0
    height[row] *= 0.9e-3 / height[row].std()
    found = check(two_pantograph_case, replace(record, force=force, contact_height=height))
    assert found == Finding(
        "unchecked", f"the dynamics check was not made: the head of pantograph {row + 1} hardly moves"
    )
    height[row] *= 1.6
    moving = check(two_pantograph_case, replace(record, force=force, contact_height=height))
    assert moving.kind == "contradiction"

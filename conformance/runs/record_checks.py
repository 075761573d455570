"""All checks of a record, in the order in which they build on each other, and the state of a record.

The checks of positions, roll-off and mean force stand here; the others have a file each.
"""

from collections.abc import Iterable, Mapping
from typing import Literal

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.lift_force import LiftForce
from pantocheck.conformance.core.check_row import CheckRow, NotMeasured
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.quantities.filters import is_observable, is_same_cutoff
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable, SectionNotCovered
from pantocheck.conformance.records.record import SPEED_TOLERANCE
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.check import (
    DOES_NOT_APPLY,
    HOLDS,
    NAMED_ELSEWHERE,
    TINY,
    Check,
    CheckName,
    Finding,
    Measure,
    report_low_rate,
    report_not_made,
    windowed_spectrum,
    worst_finding,
)
from pantocheck.conformance.runs.force_content import CONTENT, COPY
from pantocheck.conformance.runs.force_dynamics import DYNAMICS
from pantocheck.conformance.runs.implied_force import IMPLIED_FORCE
from pantocheck.conformance.runs.support_coincidence import COINCIDENCE
from pantocheck.conformance.runs.support_passing import SUPPORT_PASSING


def _check_coverage(_: Case, signals: RecordSignals) -> Finding:
    for number, pantograph in signals.pantographs.items():
        try:
            pantograph.inside  # noqa: B018 - raises where the section is not covered
        except SectionNotCovered as reason:
            basis = NotMeasured(cause="does not hold")
            return Finding(basis, f"the record of pantograph {number} is cut short: {reason}")
    return HOLDS


SPEED_ERROR = Measure("difference of the speed by position and time", "", {"contradiction": SPEED_TOLERANCE})


def _check_motion(_: Case, signals: RecordSignals) -> Finding:
    record, findings = signals.record, []
    elapsed = record.time[-1] - record.time[0]
    for number, position in enumerate(record.position, 1):
        speed = (position[-1] - position[0]) / elapsed
        text = (
            f"pantograph {number} advances at {3.6 * speed:.4g} km/h by position and time, "
            f"the record states {3.6 * record.speed:.4g} km/h"
        )
        findings.append(SPEED_ERROR.compare(abs(speed / record.speed - 1), f"pantograph {number}", text))
    return worst_finding(findings)


COVERAGE = Check(
    name="coverage",
    must_hold="every pantograph crosses the whole analysis section",
    purpose="a record that ends early can have plausible statistics",
    needs="position",
    run=_check_coverage,
    causes=("holds", "does not hold"),
)

MOTION = Check(
    name="motion",
    must_hold="the positions advance with the speed of the train",
    purpose="a wrong sampling rate or unit of position shifts the analysis section",
    needs="position, time and speed",
    run=_check_motion,
    measures=(SPEED_ERROR,),
    causes=(),
)


# Roll-off check: above the cut-off, the spectrum of a filtered force must agree with the stated filter.
STOP_BAND = (2.0, 2.5)
"""Edges of the compared band, in cut-offs: high enough for orders to differ, low enough to stay above rounding."""

MIN_ROLL_OFF_LINES = 10
"""Smallest number of spectral lines in the band; with fewer, one peak decides."""

CONTENT_ABOVE = Measure("implied content above the cut-off", "", {"contradiction": 1.0, "doubt": 0.5})
"""Ratio: RMS of the implied unfiltered force in the band, divided by its RMS below the cut-off.

The ratio of the reference cases is about 0.14. No contact force reaches a ratio of 1."""


def _check_roll_off(case: Case, signals: RecordSignals) -> Finding:
    """Check that the unfiltered force implied by the delivered one is plausible.

    The spectrum is divided by the gain of the filter of the case. A force that was not filtered, or by a filter of
    too low an order, then has more content above the cut-off than any contact force.
    """
    record, low_pass = signals.record, case.file.filter
    applied, cutoff = record.filter_applied_Hz, low_pass.cutoff_Hz
    if applied is None or not is_same_cutoff(applied, cutoff):
        return DOES_NOT_APPLY  # delivered unfiltered, or filtered again by the suite
    if not is_observable(STOP_BAND[1] * cutoff, record.rate):
        return report_low_rate("roll-off", record.rate)
    if (STOP_BAND[1] - STOP_BAND[0]) * cutoff * (record.time[-1] - record.time[0]) < MIN_ROLL_OFF_LINES:
        return report_not_made("roll-off", "the record is too short")
    frequency = np.asarray(np.fft.rfftfreq(record.time.size, 1 / record.rate), dtype=np.float64)
    below = (frequency > 0) & (frequency <= cutoff)
    above = (frequency > STOP_BAND[0] * cutoff) & (frequency <= STOP_BAND[1] * cutoff)
    gain = low_pass.gain(frequency[above], record.rate)
    findings = []
    for number, force in enumerate(record.force, 1):
        amplitude = windowed_spectrum(force, record.rate)[1]
        implied = np.sqrt(np.sum((amplitude[above] / gain) ** 2))
        share = float(implied / max(np.sqrt(np.sum(amplitude[below] ** 2)), TINY))
        text = (
            f"pantograph {number}: the stated filter of the force ({applied:g} Hz, order {low_pass.order}) is not "
            f"plausible; before this filter, the force would have {share:.2g} times as much content in "
            f"{STOP_BAND[0] * cutoff:g}-{STOP_BAND[1] * cutoff:g} Hz as below {cutoff:g} Hz; "
            "deliver the unfiltered force"
        )
        findings.append(CONTENT_ABOVE.compare(share, f"pantograph {number}", text))
    return worst_finding(findings)


ROLL_OFF = Check(
    name="roll-off",
    must_hold="above the cut-off, a filtered force falls off like the stated filter",
    purpose="a weaker filter, or none, increases the standard deviation by a few percent",
    needs="filtered contact force",
    run=_check_roll_off,
    measures=(CONTENT_ABOVE,),
    causes=("does not apply", "not possible"),
)


# Mean contact force against the uplift force: balance of the pantograph over the analysis section.
#
# The sum of the forces on the pantograph is the rate of its momentum. Over a section of duration T,
#
# mean(F)  =  F_0  -  K (mean(z) - z_0)  -  [M v + C z] / T,
#
# with the uplift force F_0, the stiffness K, damping C and mass M of the pantograph as a rigid body on its base, and
# the height z_0 at which its base spring is unstretched. Readings of z_0 differ: static height of the head or of the
# frame, or nominal height of the wire. They lie within twice the lift of the wire, which the largest uplift and the
# range of the contact height measure. The other checks compare changes of the force; this one bounds its constant part.
FORCE_DIFFERENCE = Measure("mean force beyond the allowance for base spring and momentum", "", {"doubt": 0.03})
"""Difference beyond the other tolerances, over the expected force; its threshold is the accepted error of the gain."""

LIFTS = 2.0
"""Accepted difference between the mean height and the unstretched base spring, over the lift of the wire."""


def _check_mean_force(case: Case, signals: RecordSignals) -> Finding:
    try:
        uplift = signals.delivered_line.largest_uplift
        parts = zip(signals.pantographs.items(), case.pantographs, case.lift_forces, strict=True)
        return worst_finding(
            _compare(number, pantograph, file, lift, uplift) for (number, pantograph), file, lift in parts
        )
    except QuantityUnavailable:
        return NAMED_ELSEWHERE


def _compare(
    number: int, pantograph: PantographSignals, file: PantographFile, lift: LiftForce, uplift: float
) -> Finding:
    force, height, rate = pantograph.delivered, pantograph.height, pantograph.force.rate
    expected = lift.target_mean_force or lift.uplift_force
    if height.size < 3:
        return DOES_NOT_APPLY
    allowed = 0.0
    if lift.target_mean_force is None:
        mass, damping, stiffness = _rigid_coefficients(file)
        velocity = np.gradient(height, 1 / rate)
        impulse = mass * (velocity[-1] - velocity[0]) + damping * (height[-1] - height[0])
        allowed = stiffness * LIFTS * max(uplift, float(np.ptp(height))) + abs(float(impulse)) * rate / height.size
    difference = float(force.mean()) - expected
    tolerance = FORCE_DIFFERENCE.thresholds["doubt"] * expected + allowed
    text = (
        f"the mean force of pantograph {number} is {force.mean():.4g} N; the balance of the pantograph with "
        f"{expected:g} N allows a difference of {tolerance:.2g} N"
    )
    share = (abs(difference) - allowed) / max(expected, TINY)
    return FORCE_DIFFERENCE.compare(share, f"pantograph {number}", text)


def _rigid_coefficients(file: PantographFile) -> tuple[float, float, float]:
    """Mass, damper and spring of a slow motion of the whole pantograph [kg, N s/m, N/m]."""
    model = build_pantograph(file, 0.0, 0.0)
    if file.transfer_function is not None:
        # Dynamic stiffness at a real frequency s and at -s, of a pole at 0 as well.
        s = 1e-2
        rising, falling = (
            1 / (model.head @ np.linalg.solve(model.stiffness + x * model.damping, model.head)) for x in (s, -s)
        )
        return 0.0, float(rising - falling) / (2 * s), float(rising + falling) / 2
    rigid = file.rigid_motion(model.head.size) if file.chain is not None else model.head / (model.head @ model.head)
    mass, damping, stiffness = (float(rigid @ part @ rigid) for part in (model.mass, model.damping, model.stiffness))
    return mass, damping, stiffness


MEAN_FORCE = Check(
    name="mean force",
    must_hold="the mean contact force balances the uplift force, up to the base spring and the momentum",
    purpose="a constant added to the force changes its extremes, but neither its variation nor the motion",
    needs="contact force, contact height and uplift at supports",
    run=_check_mean_force,
    measures=(FORCE_DIFFERENCE,),
    causes=("does not apply", "named by another check"),
)


RECORD_CHECKS: tuple[Check, ...] = (
    COVERAGE, MOTION, SUPPORT_PASSING, COINCIDENCE, ROLL_OFF, DYNAMICS, IMPLIED_FORCE, MEAN_FORCE,
    CONTENT, COPY,
)  # fmt: skip


def check_record(case: Case, signals: RecordSignals) -> dict[CheckName, Finding]:
    """Findings by check. The first contradiction ends the checks, because later checks rely on earlier ones."""
    findings: dict[CheckName, Finding] = {}
    for check in RECORD_CHECKS:
        finding = findings[check.name] = check.run(case, signals)
        if finding.kind == "contradiction":
            break
    return findings


def list_check_rows(findings: Mapping[CheckName, Finding]) -> tuple[CheckRow, ...]:
    """Row of every check, from `check_record`."""
    not_reached = Finding(NotMeasured(cause="not reached"))
    found = [(check.name, findings.get(check.name, not_reached)) for check in RECORD_CHECKS]
    return tuple(
        CheckRow(check=name, outcome=finding.kind, text=finding.text, basis=finding.basis) for name, finding in found
    )


# State of a record: consistent, unconfirmed or contradicted.
STATES: dict[str, Literal["unconfirmed", "contradicted"]] = {
    "contradiction": "contradicted",
    "doubt": "unconfirmed",
    "unchecked": "unconfirmed",
}
"""State of a record with a finding of each kind.

A doubt neither confirms nor refutes a record, so that the record is unconfirmed. Every check is needed.
Otherwise a record could avoid a check by leaving out its channels.
"""


def judge_record_state(
    rows: Iterable[CheckRow],
) -> tuple[Literal["consistent", "unconfirmed", "contradicted"], str]:
    """State of a record and its reason.

    Args:
        rows: Outcomes of all checks.

    Returns:
        state: `contradicted` if a check refutes the record; `unconfirmed` if a check doubts it or could not be made;
            `consistent` otherwise.
        reason: One line: the texts of the findings that decide; the confirming checks if there are none.
    """
    findings = [row for row in rows if row.outcome in STATES]
    for state in ("contradicted", "unconfirmed"):
        texts = [row.text for row in findings if STATES[row.outcome] == state]
        if texts:
            return state, "; ".join(texts)
    return "consistent", "every consistency check that applies confirms the record"

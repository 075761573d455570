"""Mean contact force against the uplift force: balance of the pantograph over the analysis section.

The sum of the forces on the pantograph is the rate of its momentum. Over a section of duration T,

    mean(F)  =  F_0  -  K (mean(z) - z_0)  -  [M v + C z] / T,

with the uplift force F_0, the stiffness K, damping C and mass M of the pantograph as a rigid body on its base, and the
height z_0 at which its base spring is unstretched. Readings of z_0 differ: static height of the head or of the frame,
or nominal height of the wire. They lie within twice the lift of the wire, which the largest uplift and the range of the
contact height measure. The other checks compare changes of the force; this one bounds its constant part.
"""

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.lift_force import LiftForce
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.consistency.check import Check, Finding, worst_finding
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.simulation.pantograph_model import build_pantograph

SHARE = 0.03
"""Accepted relative difference of the mean force: the accepted error of the gain."""

LIFTS = 2.0
"""Accepted difference between the mean height and the unstretched base spring, over the lift of the wire."""


def _check_mean_force(case: Case, signals: RecordSignals) -> Finding | None:
    try:
        uplift = signals.line.largest_uplift
        parts = zip(signals.pantographs.items(), case.pantographs, case.lift_forces, strict=True)
        return worst_finding(
            finding
            for (number, pantograph), file, lift in parts
            if (finding := _compare(number, pantograph, file, lift, uplift)) is not None
        )
    except QuantityUnavailable:
        return None  # other checks state which channel is missing


def _compare(
    number: int, pantograph: PantographSignals, file: PantographFile, lift: LiftForce, uplift: float
) -> Finding | None:
    force, height, rate = pantograph.delivered, pantograph.height, pantograph.force.rate
    expected = lift.target_mean_force or lift.uplift_force
    if height.size < 3:
        return None
    tolerance = SHARE * expected
    if lift.target_mean_force is None:
        model = build_pantograph(file, 0.0, 0.0)
        rigid = np.ones(model.head.size) if file.chain is not None else model.head / (model.head @ model.head)
        mass, damping, stiffness = (
            float(rigid @ part @ rigid) for part in (model.mass, model.damping, model.stiffness)
        )
        velocity = np.gradient(height, 1 / rate)
        impulse = mass * (velocity[-1] - velocity[0]) + damping * (height[-1] - height[0])
        tolerance += stiffness * LIFTS * max(uplift, float(np.ptp(height))) + abs(float(impulse)) * rate / height.size
    difference = float(force.mean()) - expected
    if abs(difference) <= tolerance:
        return None
    return Finding(
        "doubt",
        f"the mean force of pantograph {number} is {force.mean():.4g} N; the balance of the pantograph with "
        f"{expected:g} N allows a difference of {tolerance:.2g} N",
    )


MEAN_FORCE = Check(
    name="mean force",
    must_hold="the mean contact force balances the uplift force, up to the base spring and the momentum",
    why="a constant added to the force changes its extremes, but neither its variation nor the motion",
    needs="contact force, contact height and uplift at supports",
    run=_check_mean_force,
)

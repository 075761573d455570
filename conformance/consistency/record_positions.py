"""Where the pantographs are, and when: positions against the stretch, the speed and the supports."""

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.consistency.finding import Finding
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable, StretchNotCovered
from pantocheck.conformance.records.evaluation import line_signals, pantograph_signals
from pantocheck.conformance.records.record import Record

SPEED_TOLERANCE = 0.005
"""Relative; a tenth of what would move a resonance by its own width."""
PASSING_TOLERANCE_M = 5.0
"""The lift of a support is highest within some decimetres of a pantograph, in simulation as in measurement [m]."""
SMALLEST_LIFT_M = 0.005
"""A lift has a clear maximum from here on [m]."""


def check_coverage(case: Case, record: Record) -> list[Finding]:
    """Every pantograph crosses the whole evaluated stretch, or the record is a piece of one."""
    for number in range(1, record.pantographs + 1):
        try:
            _ = pantograph_signals(record, number, case.file.filter.low_pass).inside
        except StretchNotCovered as reason:
            return [Finding("coverage", "contradiction", f"the record of pantograph {number} is cut short: {reason}")]
    return []


def check_motion(case: Case, record: Record) -> list[Finding]:
    """Positions advance with the speed of the train."""
    elapsed = record.time[-1] - record.time[0]
    for number, position in enumerate(record.position, 1):
        speed = (position[-1] - position[0]) / elapsed
        if abs(speed / record.speed - 1) > SPEED_TOLERANCE:
            text = (
                f"pantograph {number} advances at {3.6 * speed:.4g} km/h by position and time, "
                f"the record says {3.6 * record.speed:.4g} km/h"
            )
            return [Finding("motion", "contradiction", text)]
    return []


def check_support_passing(case: Case, record: Record) -> list[Finding]:
    """A support is lifted most while a pantograph is near it; else positions and uplift are of different times."""
    try:
        uplift = line_signals(record).uplift
    except QuantityUnavailable as reason:
        return [Finding("support passing", "unchecked", f"position against uplift: {reason}")]
    if record.support_position is None:
        return []
    start, end = record.evaluated
    supports = record.support_position
    supports = supports[(supports >= start - 1e-6) & (supports <= end + 1e-6)]
    lifted = uplift.max(axis=1) > SMALLEST_LIFT_M
    if not lifted.any():
        return []
    ahead = record.position[:, uplift.argmax(axis=1)] - supports
    nearest = ahead[np.abs(ahead).argmin(axis=0), np.arange(supports.size)]
    typical = float(np.median(nearest[lifted]))
    if abs(typical) <= PASSING_TOLERANCE_M:
        return []
    side = "past" if typical > 0 else "before"
    text = (
        f"supports are lifted most when the nearest pantograph is {abs(typical):.3g} m {side} them by its position: "
        "position and uplift are not of the same time"
    )
    return [Finding("support passing", "contradiction", text)]

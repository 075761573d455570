"""Positions of the pantographs against the analysis section, the speed of the train and the supports."""

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.consistency.check import Check, Finding
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable, SectionNotCovered
from pantocheck.conformance.records.record import SPEED_TOLERANCE
from pantocheck.conformance.records.record_signals import RecordSignals

PASSING_TOLERANCE_M = 5.0
"""Distance between support and pantograph at the largest uplift [m]: some decimetres in simulation and measurement."""

SMALLEST_UPLIFT_M = 0.005
"""Uplift from which its maximum is clear [m]."""


def _check_coverage(_: Case, signals: RecordSignals) -> Finding | None:
    for number, pantograph in signals.pantographs.items():
        try:
            pantograph.inside  # noqa: B018 - raises where the section is not covered
        except SectionNotCovered as reason:
            return Finding("contradiction", f"the record of pantograph {number} is cut short: {reason}")
    return None


def _check_motion(_: Case, signals: RecordSignals) -> Finding | None:
    record = signals.record
    elapsed = record.time[-1] - record.time[0]
    for number, position in enumerate(record.position, 1):
        speed = (position[-1] - position[0]) / elapsed
        if not abs(speed / record.speed - 1) <= SPEED_TOLERANCE:
            return Finding(
                "contradiction",
                f"pantograph {number} advances at {3.6 * speed:.4g} km/h by position and time, "
                f"the record states {3.6 * record.speed:.4g} km/h",
            )
    return None


def _check_support_passing(_: Case, signals: RecordSignals) -> Finding | None:
    try:
        supports, uplift = signals.line.supports, signals.line.uplift
    except QuantityUnavailable as reason:
        return Finding("unchecked", f"position against uplift: {reason}")
    lifted = uplift.max(axis=1) > SMALLEST_UPLIFT_M
    if not lifted.any():
        return None
    distance = signals.record.position[:, uplift.argmax(axis=1)] - supports
    nearest = distance[np.abs(distance).argmin(axis=0), np.arange(supports.size)]
    typical = float(np.median(nearest[lifted]))
    if abs(typical) <= PASSING_TOLERANCE_M:
        return None
    side = "past" if typical > 0 else "before"
    return Finding(
        "contradiction",
        f"the uplift at the supports is largest when the nearest pantograph is {abs(typical):.3g} m {side} them: "
        "position and uplift are not synchronous",
    )


COVERAGE = Check(
    name="coverage",
    must_hold="every pantograph crosses the whole analysis section",
    why="statistics of half a section look like any others",
    needs="position",
    run=_check_coverage,
)

MOTION = Check(
    name="motion",
    must_hold="positions advance with the speed of the train",
    why="a wrong rate or unit of position moves the analysis section",
    needs="position, time and speed",
    run=_check_motion,
)

SUPPORT_PASSING = Check(
    name="support passing",
    must_hold=f"the uplift at a support is largest while a pantograph is within {PASSING_TOLERANCE_M:g} m",
    why="shifted positions hardly change the statistics",
    needs="position and uplift at supports",
    run=_check_support_passing,
)

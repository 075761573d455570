"""Checks of the positions: coverage of the analysis section, and motion with the speed of the train."""

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.consistency.check import Check, Finding
from pantocheck.conformance.quantities.unavailable import SectionNotCovered
from pantocheck.conformance.records.record import SPEED_TOLERANCE
from pantocheck.conformance.records.record_signals import RecordSignals


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


COVERAGE = Check(
    name="coverage",
    must_hold="every pantograph crosses the whole analysis section",
    why="a record that ends early can have plausible statistics",
    needs="position",
    run=_check_coverage,
)

MOTION = Check(
    name="motion",
    must_hold="the positions advance with the speed of the train",
    why="a wrong sampling rate or unit of position shifts the analysis section",
    needs="position, time and speed",
    run=_check_motion,
)

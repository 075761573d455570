"""All checks of a record, in the order in which they build on each other."""

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.consistency.check import Check, CheckName, Finding
from pantocheck.conformance.consistency.force_content import CONTENT
from pantocheck.conformance.consistency.force_copy import COPY
from pantocheck.conformance.consistency.force_dynamics import DYNAMICS
from pantocheck.conformance.consistency.implied_force import IMPLIED_FORCE
from pantocheck.conformance.consistency.mean_force import MEAN_FORCE
from pantocheck.conformance.consistency.record_positions import COVERAGE, MOTION
from pantocheck.conformance.consistency.roll_off import ROLL_OFF
from pantocheck.conformance.consistency.support_coincidence import COINCIDENCE
from pantocheck.conformance.consistency.support_passing import SUPPORT_PASSING
from pantocheck.conformance.records.record_signals import RecordSignals

RECORD_CHECKS: tuple[Check, ...] = (
    COVERAGE, MOTION, SUPPORT_PASSING, COINCIDENCE, ROLL_OFF, DYNAMICS, IMPLIED_FORCE, MEAN_FORCE,
    CONTENT, COPY,
)  # fmt: skip


def check_record(case: Case, signals: RecordSignals) -> dict[CheckName, Finding]:
    """Findings by check. The first contradiction ends the checks, because later checks rely on earlier ones."""
    findings: dict[CheckName, Finding] = {}
    for check in RECORD_CHECKS:
        if (finding := check.run(case, signals)) is not None:
            findings[check.name] = finding
            if finding.kind == "contradiction":
                break
    return findings

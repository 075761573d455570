"""All checks of a record, in the order in which they make sense of it."""

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.consistency.finding import Finding
from pantocheck.conformance.consistency.force_dynamics import dynamics
from pantocheck.conformance.consistency.record_positions import coverage, motion, support_passing
from pantocheck.conformance.consistency.roll_off import roll_off
from pantocheck.conformance.records.record import Record


def findings(case: Case, record: Record) -> list[Finding]:
    """What the checks find in a record of a case: a contradiction ends them, because the rest builds on it."""
    found: list[Finding] = []
    for check in (coverage, motion, support_passing, roll_off, dynamics):
        found += check(case, record)
        if any(finding.kind == "contradiction" for finding in found):
            break
    return found

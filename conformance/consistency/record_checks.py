"""All checks of a record, in the order in which they make sense of it."""

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.consistency.finding import Finding
from pantocheck.conformance.consistency.force_dynamics import check_force_dynamics
from pantocheck.conformance.consistency.record_positions import check_coverage, check_motion, check_support_passing
from pantocheck.conformance.consistency.roll_off import check_roll_off
from pantocheck.conformance.records.record import Record


def check_record(case: Case, record: Record) -> list[Finding]:
    """What the checks find in a record of a case: a contradiction ends them, because the rest builds on it."""
    found: list[Finding] = []
    for check in (check_coverage, check_motion, check_support_passing, check_roll_off, check_force_dynamics):
        found += check(case, record)
        if any(finding.kind == "contradiction" for finding in found):
            break
    return found

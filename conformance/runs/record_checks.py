"""All checks of a record, in the order in which they build on each other."""

from collections.abc import Mapping
from typing import Literal

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.check import Check, CheckName, Finding
from pantocheck.conformance.runs.force_content import CONTENT, COPY
from pantocheck.conformance.runs.force_dynamics import DYNAMICS
from pantocheck.conformance.runs.implied_force import IMPLIED_FORCE
from pantocheck.conformance.runs.record_positions import COVERAGE, MEAN_FORCE, MOTION, ROLL_OFF
from pantocheck.conformance.runs.support_coincidence import COINCIDENCE
from pantocheck.conformance.runs.support_passing import SUPPORT_PASSING

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


# State of a record: verified, unverified or contradicted.
STATES: dict[str, Literal["unverified", "contradicted"]] = {
    "contradiction": "contradicted",
    "doubt": "unverified",
    "unchecked": "unverified",
}
"""State of a record with a finding of each kind.

A doubt neither confirms nor refutes a record, so that the record is unverified. Every check is needed.
Otherwise a record could avoid a check by leaving out its channels.
"""


def record_state(
    findings: Mapping[CheckName, Finding],
) -> tuple[Literal["verified", "unverified", "contradicted"], str]:
    """State of a record and its reason.

    Args:
        findings: Findings of `check_record`; a check without a finding has confirmed the record or does not apply to
            it.

    Returns:
        state: `contradicted` if a check refutes the record; `unverified` if a check doubts it or could not be made;
            `verified` otherwise.
        reason: One line: the texts of the findings that decide; the confirming checks if there are none.
    """
    for state in ("contradicted", "unverified"):
        texts = [finding.text for finding in findings.values() if STATES[finding.kind] == state]
        if texts:
            return state, "; ".join(texts)
    return "verified", "every consistency check that applies confirms the record"

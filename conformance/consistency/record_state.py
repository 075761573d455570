"""State of a record: verified, unverified or contradicted."""

from collections.abc import Mapping
from typing import Literal

from pantocheck.conformance.consistency.check import CheckName, Finding

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

"""State of a record by the findings of its checks."""

from pantocheck.conformance.runs.check import CheckName, Finding
from pantocheck.conformance.runs.record_checks import record_state


def test_record_without_findings_is_verified() -> None:
    assert record_state({}) == ("verified", "every consistency check that applies confirms the record")


def test_missing_channels_and_doubts_leave_a_record_unverified() -> None:
    findings: dict[CheckName, Finding] = {
        "support passing": Finding("unchecked", "no uplift"),
        "dynamics": Finding("doubt", "late force"),
    }
    assert record_state(findings) == ("unverified", "no uplift; late force")


def test_contradiction_outweighs_missing_channels() -> None:
    """The missing channel is not the reason: the record cannot be graded even if it is delivered."""
    findings: dict[CheckName, Finding] = {
        "support passing": Finding("unchecked", "no uplift"),
        "dynamics": Finding("contradiction", "wrong gain"),
    }
    assert record_state(findings) == ("contradicted", "wrong gain")

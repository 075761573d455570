"""Findings of publications in results.json: their outcomes and the numbers of each outcome."""

from collections import Counter
from collections.abc import Iterable
from typing import Literal

from pantocheck.conformance.cases.finding import PublishedFinding, Role
from pantocheck.conformance.grading.verdicts import Verdict
from pantocheck.conformance.results.results_part import ResultsPart

FindingOutcome = Literal["imposed", "reproduced", "not_reproduced", "not_evaluated"]

IMPOSED_REASON = "imposed: the inputs were chosen to meet this finding, so meeting it does not count"


class GradedFinding(PublishedFinding):
    """Finding of a publication, and its outcome in this run."""

    outcome: FindingOutcome
    """reproduced: held out and inside its limits; imposed: imposed and inside; not_reproduced: outside;
    not_evaluated: no value.
    """


class FindingCounts(ResultsPart):
    """Numbers of findings by outcome."""

    imposed: int = 0
    reproduced: int = 0
    not_reproduced: int = 0
    not_evaluated: int = 0


def judge_finding(role: Role, verdict: Verdict) -> FindingOutcome:
    """FindingOutcome of a finding from the verdict of its value between the limits, whether or not the limits count."""
    if verdict == "fail":
        return "not_reproduced"
    if verdict != "pass":
        return "not_evaluated"
    return "imposed" if role == "imposed" else "reproduced"


def grade_finding(finding: PublishedFinding, verdict: Verdict) -> GradedFinding:
    """Finding with its outcome; parameters as in `judge_finding`."""
    return GradedFinding(**finding.model_dump(), outcome=judge_finding(finding.role, verdict))


def count_verdict(role: Role | None, verdict: Verdict) -> Verdict:
    """Verdict that counts: an imposed finding inside its limits is information, because its inputs were chosen so."""
    return "info" if role == "imposed" and verdict == "pass" else verdict


def count_findings(findings: Iterable[GradedFinding | None]) -> FindingCounts | None:
    """Numbers of findings by outcome; None without findings."""
    counts: Counter[str] = Counter(finding.outcome for finding in findings if finding is not None)
    return FindingCounts.model_validate(counts) if counts else None

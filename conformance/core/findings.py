"""Findings of publications: their sentence, limit and outcome."""

from collections import Counter
from collections.abc import Iterable
from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.core.results_part import ResultsPart
from pantocheck.conformance.core.sourced_table import InputTable
from pantocheck.conformance.core.verdicts import Verdict

Role = Literal["imposed", "held_out", "inferred"]
"""`imposed`: the inputs of the case were chosen with the finding; `held_out`: they were chosen without it; `inferred`:
the publication does not state it.
"""


class PublishedFinding(InputTable):
    """Finding of a publication: its place, our reading of it, and the choices behind the bounds of its limit."""

    section: Annotated[str, Field(max_length=40)]
    """Section of the publication, and the figure or table."""
    statement: Annotated[str, Field(max_length=500)] = ""
    """Statement of the publication at this place, in our words."""
    sentence: Annotated[str, Field(max_length=500)]
    """Our reading of the statement in one sentence."""
    role: Role
    """imposed: the search for the inputs used the finding; held_out: it did not; inferred: the publication does not
    state it, we infer it from the statement.
    """
    printed: Annotated[str, Field(max_length=100)] = "none"
    """Number in the publication; none: it states no number."""
    tolerance: Annotated[str, Field(max_length=500)]
    """Origin of the bounds and of their tolerance."""
    sensitivity: Annotated[str, Field(max_length=1000)] = ""
    """Reason, with numbers, why the case does not reproduce the finding."""


# Findings of publications in results.json: their outcomes and the numbers of each outcome.
FindingOutcome = Literal["imposed", "reproduced", "not_reproduced", "not_evaluated", "inferred_met", "inferred_not_met"]

IMPOSED_REASON = "imposed: the inputs were chosen to meet this finding, so meeting it does not count"


class GradedFinding(PublishedFinding):
    """Finding of a publication, and its outcome in this run."""

    outcome: FindingOutcome
    """reproduced: held out and inside its limits; imposed: imposed and inside; not_reproduced: outside;
    not_evaluated: no value; inferred_met and inferred_not_met: inferred, inside or outside.
    """


class FindingCounts(ResultsPart):
    """Numbers of findings by outcome."""

    imposed: int = 0
    reproduced: int = 0
    not_reproduced: int = 0
    not_evaluated: int = 0
    inferred_met: int = 0
    inferred_not_met: int = 0


def judge_finding(role: Role, verdict: Verdict) -> FindingOutcome:
    """Outcome of a finding by the verdict of its value against the limits, whether or not these count."""
    if verdict not in ("pass", "fail"):
        return "not_evaluated"
    if role == "inferred":
        return "inferred_met" if verdict == "pass" else "inferred_not_met"
    if verdict == "fail":
        return "not_reproduced"
    return "imposed" if role == "imposed" else "reproduced"


def grade_finding(finding: PublishedFinding, verdict: Verdict) -> GradedFinding:
    """Finding with its outcome; parameters as in `judge_finding`."""
    return GradedFinding(**finding.model_dump(), outcome=judge_finding(finding.role, verdict))


def lower_imposed_verdict(role: Role | None, verdict: Verdict) -> Verdict:
    """Verdict that counts: an imposed finding inside its limits is information, because its inputs were chosen so."""
    return "info" if role == "imposed" and verdict == "pass" else verdict


def count_findings(findings: Iterable[GradedFinding | None]) -> FindingCounts | None:
    """Numbers of findings by outcome; None without findings."""
    counts: Counter[str] = Counter(finding.outcome for finding in findings if finding is not None)
    return FindingCounts.model_validate(counts) if counts else None

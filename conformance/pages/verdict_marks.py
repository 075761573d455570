"""Criteria that decide on a case and on a run, and the mark of a verdict: `close` for a pass with close values."""

from collections.abc import Iterable, Iterator

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.results.results_format import CaseResult, Results

NAMES = {
    "criteria": "EN 50318 criteria",
    "verification": "Verification against the converged solution, up to 50 Hz",
    "baseline": "Drift from the baseline",
}
"""Title of each verdict."""

CLOSE = "close"
"""Mark of a pass with values closer to a limit than their uncertainty."""


def case_verdict(case: CaseResult, name: str) -> Verdict | None:
    """One of the verdicts of a case; None if the case has no converged values, or no baseline."""
    if name == "criteria":
        return case.criteria_verdict or case.verdict
    part = case.verification if name == "verification" else case.baseline
    return None if part is None else part.verdict


def list_criteria(case: CaseResult, name: str) -> list[Criterion]:
    """Criteria of one of the verdicts of a case."""
    if name == "verification":
        return [] if case.verification is None else case.verification.criteria
    return [row for row in case.criteria if row.is_drift == (name == "baseline")]


def select_criteria(results: Results, case: CaseResult) -> Iterator[Criterion]:
    """Criteria of the verdicts that decide on a case; its drift from a baseline always belongs to them."""
    for name in NAMES:
        left_out = name == "criteria" and case.id in results.verification_only
        decides = name in results.requested and not left_out
        yield from (row for row in list_criteria(case, name) if decides or row.is_drift)


def count_close(results: Results) -> int:
    """Number of values inside limits that count, closer to a limit than their uncertainty; of required steps, too."""
    cases = [case for case in results.cases if case.id not in results.information]
    rows = [row for case in cases for row in select_criteria(results, case)]
    steps = () if results.procedure is None else results.procedure.steps
    rows += [row for step in steps if step.required for row in step.criteria]
    return sum(row.verdict == "pass" and row.is_close for row in rows)


def mark_results(results: Results) -> str:
    """Mark of a run: its verdict, or `close` for a pass with close values."""
    return CLOSE if results.verdict == "pass" and count_close(results) else results.verdict


def mark_case(case: CaseResult) -> str:
    """Mark of the verdict of a case."""
    return mark_rows(case.verdict, case.criteria)


def mark_rows(verdict: str, rows: Iterable[Criterion]) -> str:
    """Mark of a verdict on criteria: `close` for a pass with close values."""
    return CLOSE if verdict == "pass" and any(row.verdict == "pass" and row.is_close for row in rows) else verdict

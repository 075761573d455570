"""Check of a comparison with a baseline: bounds, numbers and verdict must follow from the criteria of drift."""

from collections.abc import Iterator

from pantocheck.conformance.grading.baseline import bound_drift
from pantocheck.conformance.grading.case_verdict import judge_baseline
from pantocheck.conformance.results.criterion_format import Criterion
from pantocheck.conformance.results.results_format import CaseResult


def list_graded(case: CaseResult) -> list[Criterion]:
    """Criteria that `criteria_verdict` counts: all but those of drift."""
    return [row for row in case.criteria if not row.is_drift]


def check_baseline(case: CaseResult) -> Iterator[str]:
    """Find contradictions between a comparison with a baseline and the criteria of drift.

    Yields:
        One line per contradiction.
    """
    comparison = case.baseline
    rows = [row for row in case.criteria if row.is_drift]
    if comparison is None:
        yield from (f"{row.quantity}: drift without a comparison with a baseline" for row in rows)
        return
    for row in rows:
        if row.verdict not in ("fail", "skip"):
            yield f"{row.quantity}: verdict '{row.verdict}' among the values that drifted"
        if row.baseline is not None:
            yield from _check_bounds(row, row.baseline, comparison.drift_pct)
    verdict = judge_baseline((row.verdict for row in rows), comparison.values)
    if comparison.verdict != verdict:
        yield f"baseline '{comparison.verdict}' stated, '{verdict}' follows from the criteria of drift"
    drifted = sum(row.baseline is not None for row in rows)
    if comparison.drifted != drifted or drifted > comparison.values:
        yield f"{comparison.drifted} of {comparison.values} values drifted are stated, {drifted} are listed"


def _check_bounds(row: Criterion, baseline: float, drift_pct: float) -> Iterator[str]:
    if (row.lower, row.upper) != bound_drift(row.quantity, baseline, drift_pct):
        yield f"{row.quantity}: the bounds do not follow from the baseline and the accepted drift"

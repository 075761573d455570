"""Check of statements of results that other parts determine: lists without repetition, reasons, and the date."""

from collections import Counter
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta

from pantocheck.conformance.core.criterion import EVERYWHERE, Criterion, Requirement
from pantocheck.conformance.core.decision import DecisionRule
from pantocheck.conformance.core.findings import PublishedFinding
from pantocheck.conformance.core.near_limit import ValueErrors
from pantocheck.conformance.core.trust import Computed, Trust
from pantocheck.conformance.documents.authenticity_check import format_exact
from pantocheck.conformance.grading.case_verification import UNCHECKED_START
from pantocheck.conformance.grading.criterion_grading import build_criterion
from pantocheck.conformance.grading.results_building import TIME_FORMAT
from pantocheck.conformance.results.results_format import CaseResult, Results

FAST_CLOCK = timedelta(days=1)
"""Largest accepted time by which a date is later than the clock of this machine: clocks may differ."""


def check_run_statements(results: Results) -> Iterator[str]:
    """Contradictions in the statements of a run."""
    ids = [case.id for case in results.cases]
    yield from (f"the case {name} occurs {count} times" for name, count in Counter(ids).items() if count > 1)
    yield from check_date(results.started)


def check_date(started: str | None, subject: str = "the run started at") -> Iterator[str]:
    """Contradiction of the start of a run, or of another date, with its format or with the clock of this machine."""
    now = datetime.now(UTC)
    if started is None:
        return
    try:
        start = datetime.strptime(started, TIME_FORMAT).replace(tzinfo=UTC)
    except ValueError:
        yield f"the start of the run '{started}' is not a time such as {now:{TIME_FORMAT}}"
        return
    if start > now + FAST_CLOCK:
        yield f"{subject} {started}, in the future: the clock of this machine shows {now:{TIME_FORMAT}}"


def check_case_statements(case: CaseResult) -> Iterator[str]:
    """Contradictions in the statements of a case."""
    targets = Counter(row.target for row in (() if case.verification is None else case.verification.criteria))
    if max(targets.values(), default=0) > 1:
        yield "a criterion of the verification occurs twice"
    targets = Counter(row.target for row in case.criteria if not row.is_drift)
    if case.library == "identical" and case.profile is None and max(targets.values(), default=0) > 1:
        yield "a criterion of the case occurs twice"
    yield from _check_reason(case)


def _check_reason(case: CaseResult) -> Iterator[str]:
    """A graded record gives no reason but its contradiction."""
    record = case.record
    if record is None or not record.checks or case.criteria_verdict is None:
        return
    texts = [row.text for row in record.checks if row.outcome == "contradiction"]
    if case.reason != next(iter(texts), None):
        yield f"the reason '{case.reason}' does not follow from the checks of the record"
    if not record.demanded:
        yield "the consistency of the record is not demanded, which only a profile can state"


def check_criterion_statements(
    case: CaseResult, row: Criterion, errors: ValueErrors, trust: Trust | Computed, rule: DecisionRule
) -> Iterator[str]:
    """Contradictions in the statements of a criterion of a case: its place, errors and reason.

    Args:
        case: The case.
        row: One of its criteria, or of its verification.
        errors: Errors of the value.
        trust: Lowest trust of the limits that count.
        rule: Decision rule.
    """
    if row.is_drift or case.criteria_verdict is None:
        return  # a comparison with a measured run or earlier values has places and uncertain limits
    if row.where != EVERYWHERE or row.limit_uncertainty != 0.0:
        yield "a place or an uncertain limit, which only a comparison has"
    spread = None if trust == "computed" else case.spread.get(str(row.pantograph), {}).get(row.quantity)
    if row.value is not None and row.spread != spread:
        texts = map(format_exact, (row.spread, spread))
        yield "change along the line {} stated, {} stated with the quantity".format(*texts)
    again = build_criterion(extract_requirement(row), row.value, None, trust, errors, rule=rule, doubt=row.doubt)
    reasons = {again.reason}
    if trust == "computed" and case.record is not None and case.record.start == "differs":
        reasons |= {row.reason} if (row.reason or "").endswith(UNCHECKED_START) else set()
    if again.verdict == row.verdict and row.verdict != "skip" and row.value is not None and row.reason not in reasons:
        yield f"reason '{row.reason}' stated, '{again.reason}' follows"


def extract_requirement(row: Criterion) -> Requirement:
    """Limits that a criterion states, with its finding before it was graded."""
    stated = {name: getattr(row, name) for name in Requirement.model_fields}
    if row.finding is not None:
        names = PublishedFinding.model_fields
        stated["finding"] = PublishedFinding.model_construct(**{name: getattr(row.finding, name) for name in names})
    return Requirement.model_construct(**stated)

"""Grades under every documented reading of the evaluation: filter, bands and analysis section."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from pantocheck.conformance.cases.case_file import Reading
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.results_part import select_item
from pantocheck.conformance.core.verdicts import Verdict, judge
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.results_building import key_by_owner, select_finite
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.quantities.filters import needs_filter
from pantocheck.conformance.quantities.limit_text import format_graded
from pantocheck.conformance.quantities.unavailable import AlreadyFiltered
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.results.case_facts_format import ConditionFacts, ReadingFacts


def evaluate_readings(evaluation: CaseEvaluation) -> list[ReadingFacts]:
    """Evaluate a delivered record under every further reading of its case; none without a record."""
    record = evaluation.delivered.record
    readings = evaluation.case.file.reading
    return [] if record is None else [_evaluate_reading(evaluation, record, reading) for reading in readings]


def _evaluate_reading(evaluation: CaseEvaluation, record: Record, reading: Reading) -> ReadingFacts:
    case, reason = evaluation.case.with_reading(reading), _find_obstacle(reading, record.filter_applied_Hz)
    read = record if reading.evaluated_m is None else replace(record, evaluated=reading.evaluated_m)
    values: dict[int, dict[str, Value]] = {}
    if reason is None:
        read_again = CaseEvaluation(case, replace(evaluation.delivered, record=read)).evaluation
        values, skipped = read_again.values, read_again.skipped.get(1, {})
        reason = None if values.get(1) else next(iter(skipped.values()), None)
    return ReadingFacts(
        id=reading.id,
        trust=reading.trust,
        source=source_text((reading.source,) if isinstance(reading.source, str) else tuple(reading.source)),
        filter=case.file.filter,
        evaluated_m=case.analysis_section,
        quantities=key_by_owner(select_finite(values)),
        reason=reason,
    )


def _find_obstacle(reading: Reading, filter_applied_Hz: float | None) -> str | None:
    """Reason why a record does not support the filter of a reading: a filter before delivery cannot be replaced."""
    if reading.filter is None:
        return None
    try:
        if needs_filter(reading.filter, filter_applied_Hz):
            return None
    except AlreadyFiltered as error:
        return str(error)
    return f"the force was low-pass filtered at {filter_applied_Hz:g} Hz before delivery, by the filter of its program"


def judge_reading(criterion: Criterion, reading: ReadingFacts) -> tuple[float | None, Verdict]:
    """Value of a criterion under a reading, and its verdict by the same limits; `skip` without a value or limit."""
    value = select_item(reading.quantities.get(str(criterion.pantograph), {}).get(criterion.quantity), criterion.item)
    limits = (criterion.lower, criterion.upper)
    return value, "skip" if value is None or limits == (None, None) else judge(value, *limits)


def list_reading_remarks(
    criterion: Criterion, readings: Sequence[ReadingFacts], conditions: Sequence[ConditionFacts]
) -> list[str]:
    """Remarks on readings and contacts under which the value of a criterion lies on the other side of a limit."""
    if criterion.value is None or criterion.is_drift or (criterion.lower, criterion.upper) == (None, None):
        return []
    judged = judge(criterion.value, criterion.lower, criterion.upper)
    others = [(f"under the reading '{reading.id}'", *judge_reading(criterion, reading)) for reading in readings]
    others += [
        (f"with {name}, an effect computed with the reference simulator,", value, verdict)
        for name, value, verdict in _judge_contacts(criterion, conditions)
    ]
    return [
        f"{name} the value is {format_graded(value, criterion.lower, criterion.upper).value} {criterion.unit}".rstrip()
        + f", {'inside' if verdict == 'pass' else 'outside'} the limits"
        for name, value, verdict in others
        if verdict not in ("skip", judged)
    ]


def _judge_contacts(
    criterion: Criterion, conditions: Sequence[ConditionFacts]
) -> Iterator[tuple[str, float | None, Verdict]]:
    """Name of each other contact, the value with it by its stored relative change, and its verdict."""
    for condition in conditions:
        change = condition.changes.get(str(criterion.pantograph), {}).get(criterion.quantity)
        if condition.is_contact and change is not None and criterion.value is not None:
            value = criterion.value + abs(criterion.value) * change / 100
            yield condition.name, value, judge(value, criterion.lower, criterion.upper)


def mark_readings(
    criteria: Sequence[Criterion], readings: Sequence[ReadingFacts], conditions: Sequence[ConditionFacts]
) -> list[Criterion]:
    """Criteria with the remarks of `list_reading_remarks`."""
    return [row.model_copy(update={"readings": list_reading_remarks(row, readings, conditions)}) for row in criteria]

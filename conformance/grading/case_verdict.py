"""Verdict of a case, and of a run, from the grades of criteria and the state of records."""

from collections.abc import Iterable

from pantocheck.conformance.grading.verdicts import Verdict, worst_verdict
from pantocheck.conformance.results.results_format import RecordState


def judge_case(criteria: Iterable[Verdict], record: RecordState | None) -> Verdict:
    """Verdict of a case: its worst counted criterion, lowered by the state of its record.

    Parameters
    ----------
    criteria : iterable of Verdict
        Verdicts of the criteria; `info` marks a criterion that does not count.
    record : RecordState or None
        State of the record; None for a case without a record.

    Returns
    -------
    Verdict
        `info` if no criterion counts, `unverified` if all counted criteria pass on an unverified record, `error` if the
        record is contradicted.
    """
    if record == "contradicted":
        return "error"
    verdict = worst_verdict(verdict for verdict in criteria if verdict != "info")
    return "unverified" if verdict == "pass" and record == "unverified" else verdict

"""Verdict of a case, and of a run, from the grades of criteria and the state of records."""

from collections.abc import Iterable
from dataclasses import dataclass

from pantocheck.conformance.grading.verdicts import Verdict, worst_verdict
from pantocheck.conformance.results.results_format import RecordFacts


def judge_case(criteria: Iterable[Verdict], record: RecordFacts | None) -> Verdict:
    """Verdict of a case: its worst counted criterion, lowered by the state of its record.

    Parameters
    ----------
    criteria : iterable of Verdict
        Verdicts of the criteria; `info` marks a criterion that does not count.
    record : RecordFacts or None
        State of the record; None for a case without a record.

    Returns
    -------
    Verdict
        `info` if no criterion counts; `unverified` if all counted criteria pass on an unverified record; `error` if the
        record is contradicted.
    """
    if record is not None and record.state == "contradicted":
        return "error"
    verdict = worst_verdict(verdict for verdict in criteria if verdict != "info")
    lowered = record is not None and record.state == "unverified" and record.demanded
    return "unverified" if verdict == "pass" and lowered else verdict


@dataclass(frozen=True)
class Participation:
    """Cases that do not take part in the verdict of a run, and records that need no verification.

    Parameters
    ----------
    information : tuple of str
        Ids of the cases that are shown for information.
    accepted_unverified : tuple of str
        Names of systems whose unverified records count as a pass.
    """

    information: tuple[str, ...] = ()
    accepted_unverified: tuple[str, ...] = ()

    def judge_run(self, cases: Iterable[tuple[str, Verdict]], system: str) -> Verdict:
        """Verdict of a run: the worst case that takes part; `info` if none does.

        Parameters
        ----------
        cases : iterable of tuple of (str, Verdict)
            Id and verdict of each case.
        system : str
            Name of the graded system.
        """
        accepted = system in self.accepted_unverified
        return worst_verdict(
            "pass" if accepted and verdict == "unverified" else verdict
            for case, verdict in cases
            if case not in self.information
        )


EVERY_CASE = Participation()
"""Every case takes part, and unverified records are not accepted."""

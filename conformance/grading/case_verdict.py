"""Verdict of a case, and of a run, from the grades of criteria and the state of records."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import get_args

from pantocheck.conformance.core.decision import SIMPLE, DecisionRule, format_decision, parse_decision
from pantocheck.conformance.core.verdicts import Verdict, judge_parts, worst_verdict
from pantocheck.conformance.grading.case_conformity import find_conformity
from pantocheck.conformance.grading.procedure_verdict import decide_procedure, judge_procedure
from pantocheck.conformance.results.case_facts_format import RecordFacts
from pantocheck.conformance.results.results_format import CaseResult, Results, VerdictName


def judge_case(criteria: Iterable[Verdict], record: RecordFacts | None) -> Verdict:
    """Verdict of a case: its worst counted criterion, lowered by the state of its record.

    Args:
        criteria: Verdicts of the criteria; `info` marks a criterion that does not count.
        record: State of the record; None for a case without a record.

    Returns:
        `info` if no criterion counts; `unconfirmed` if all counted criteria pass on an unconfirmed record; `error` if
        the record is contradicted.
    """
    if record is not None and record.state == "contradicted":
        return "error"
    verdict = judge_parts(criteria)
    lowered = record is not None and record.state == "unconfirmed" and record.demanded
    return "unconfirmed" if verdict == "pass" and lowered else verdict


def judge_baseline(drifts: Iterable[Verdict], values: int) -> Verdict:
    """Verdict of a case by its baseline: the worst of the criteria of drift; `info` if no value was compared.

    Args:
        drifts: Verdicts of the values that drifted or are missing, and of a comparison that is impossible.
        values: Number of compared values.
    """
    return worst_verdict([*drifts, "pass" if values else "info"])


@dataclass(frozen=True)
class Participation:
    """Cases and verdicts that decide the verdict of a run, and records that need no confirmation."""

    information: tuple[str, ...] = ()
    """Ids of the cases that are shown for information."""
    accepted_unconfirmed: tuple[str, ...] = ()
    """Names of systems whose unconfirmed records count as a pass."""
    requested: tuple[VerdictName, ...] = ("criteria",)
    """Verdicts that decide; the worst of them is the verdict of the run."""
    verification_only: tuple[str, ...] = ()
    """Ids of the cases that take part in the verification only."""
    decision: DecisionRule = SIMPLE
    """Decision rule of the criteria."""

    def judge_run(self, cases: Iterable[tuple[str, Verdict]], system: str) -> Verdict:
        """Verdict of a run: the worst judged case that takes part; `info` if none is judged.

        Args:
            cases: Id and verdict of each case.
            system: Name of the graded system.
        """
        accepted = system in self.accepted_unconfirmed
        return judge_parts(
            "pass" if accepted and verdict == "unconfirmed" else verdict
            for case, verdict in cases
            if case not in self.information
        )

    def judge_cases(self, cases: Sequence[CaseResult], system: str) -> Verdict:
        """Verdict of a run from the verdicts of its cases.

        An accepted record does not replace a requested verification that a case lacks.
        """
        lacking = [case for case in cases if case.verdict == "unconfirmed" and self._lacks_verification(case)]
        bounds: list[Verdict] = ["unconfirmed" for case in lacking if case.id not in self.information]
        return judge_parts([self.judge_run([(case.id, case.verdict) for case in cases], system), *bounds])

    def judge_verdict(self, name: VerdictName, cases: Sequence[CaseResult], system: str) -> Verdict | None:
        """One of the two verdicts of a run; None if no case takes part in it."""
        verdicts = [(case.id, verdict) for case in cases if (verdict := self._case_verdict(name, case)) is not None]
        return self.judge_run(verdicts, system) if verdicts else None

    def decide_case(self, case: CaseResult) -> CaseResult:
        """Case with the worst of the requested verdicts in which it takes part.

        A drift from a baseline, and an error, count whichever verdicts are requested. A baseline without drift improves
        no verdict. A run of a train that lacks the requested verification is unconfirmed at best.
        """
        verdicts = [self._case_verdict(name, case) for name in self.requested]
        drift = [criterion.verdict for criterion in case.criteria if criterion.is_drift]
        drift += [] if case.baseline is None else [case.baseline.verdict]
        errors = [verdict for verdict in (case.criteria_verdict, case.verdict) if verdict == "error"]
        requested = worst_verdict(verdict for verdict in (*verdicts, *errors) if verdict is not None)
        requested = "unconfirmed" if requested == "pass" and self._lacks_verification(case) else requested
        verdict = worst_verdict([requested, *drift])
        return case.model_copy(update={"verdict": verdict})

    def decide_run(self, results: Results) -> Results:
        """Results with the verdicts of their cases and of the run.

        A requested verdict in which no case takes part leaves a pass unconfirmed. With a procedure, its required
        steps decide. Where some cases are compared with a baseline, one that is not, such as an interrupted one, is
        skipped.
        """
        cases, system = [self.decide_case(case) for case in results.cases], results.system.name
        by_name = {name: self.judge_verdict(name, cases, system) for name in get_args(VerdictName)}
        overall = self.judge_cases(cases, system)
        compared: list[tuple[str, Verdict]] = [
            (case.id, "skip" if case.baseline is None else case.baseline.verdict) for case in cases
        ]
        has_baseline = any(case.baseline is not None for case in cases)
        verdict = judge_parts([overall, *(by_name[name] or "unconfirmed" for name in self.requested)])
        shown = [case for case in cases if case.id not in self.information]
        doubted = any(row.doubt is not None for case in shown for row in case.criteria)
        verdict = worst_verdict([verdict, "info"]) if overall == "info" or doubted else verdict
        procedure = results.procedure
        if procedure is not None:
            lacking = [case.id for case in cases if self._lacks_verification(case)]
            procedure = decide_procedure(procedure, cases, system in self.accepted_unconfirmed, lacking)
            verdict = judge_procedure(procedure.steps)
        return results.model_copy(
            update={
                "cases": cases,
                "decision": format_decision(self.decision),
                "conformity": find_conformity(shown),
                "verdict": verdict,
                "procedure": procedure,
                "criteria_verdict": by_name["criteria"],
                "verification_verdict": by_name["verification"],
                "baseline_verdict": self.judge_run(compared, system) if has_baseline else None,
                "requested": list(self.requested),
                "information": list(self.information),
                "accepted_unconfirmed": list(self.accepted_unconfirmed),
                "verification_only": list(self.verification_only),
            }
        )

    def _lacks_verification(self, case: CaseResult) -> bool:
        """Whether the run of a train lacks the requested verification."""
        lacking = "verification" in self.requested and case.verification is None
        return lacking and case.record is not None and case.profile is None

    def _case_verdict(self, name: VerdictName, case: CaseResult) -> Verdict | None:
        """Verdict of a case; None if the case does not take part in it."""
        if name == "verification":
            return None if case.verification is None else case.verification.verdict
        return None if case.id in self.verification_only else case.criteria_verdict or case.verdict


def read_participation(results: Results) -> Participation:
    """Participation that results state."""
    return Participation(
        information=tuple(results.information),
        accepted_unconfirmed=tuple(results.accepted_unconfirmed),
        requested=tuple(results.requested),
        verification_only=tuple(results.verification_only),
        decision=parse_decision(results.decision, "results, key decision"),
    )


EVERY_CASE = Participation()
"""Every case takes part in the EN 50318 criteria, and unconfirmed records are not accepted."""

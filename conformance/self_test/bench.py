"""Running mutants: every one is graded as any system is, and once more by the limits of the case alone."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.case_grading import grade_case, grade_evaluation
from pantocheck.conformance.grading.extended_band import WARNING_PREFIX
from pantocheck.conformance.grading.verdicts import Verdict, worst_verdict
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.results.outcome import Delivered
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.self_test.mutants import MILD, MUTANTS, Mutant
from pantocheck.conformance.systems.reference_simulator import ReferenceSimulator

TRUST: Final = "secondary"


class NothingToMutate(RuntimeError):
    """The reference simulator delivered no record: without the right system, no mutant proves anything."""


@dataclass(frozen=True)
class Row:
    """A mutant on a case.

    Parameters
    ----------
    mutant : Mutant
        Which one.
    case : str
        Id of the case.
    verdict : Verdict
        Of the whole suite.
    by_limits : Verdict
        Verdict of the limits of the case alone.
    outside : tuple[str, ...]
        Quantities outside their limits.
    checks : tuple[str, ...]
        Checks of the record that object, with what they say.
    caught : bool
        Whether it ended in fail or error for the reason it must, or may pass.
    reason : str
        What a user is told.
    """

    mutant: Mutant
    case: str
    verdict: Verdict
    by_limits: Verdict
    outside: tuple[str, ...]
    checks: tuple[str, ...]
    caught: bool
    reason: str


@dataclass(frozen=True)
class SelfTest:
    """The right system and the mutants.

    Parameters
    ----------
    right : dict[str, tuple[Verdict, str]]
        Verdict of the right system on each case, with the reason if it did not pass.
    rows : tuple[Row, ...]
        Mutants that must be caught.
    mild : tuple[Row, ...]
        Mutants that may pass.
    """

    right: dict[str, tuple[Verdict, str]]
    rows: tuple[Row, ...]
    mild: tuple[Row, ...]

    @property
    def passed(self) -> bool:
        """Whether the right system passes and every mutant is caught for its reason."""
        return all(verdict == "pass" for verdict, _ in self.right.values()) and all(row.caught for row in self.rows)


def run_self_test(cases: Sequence[Case], progress: Callable[[str], None] | None = None) -> SelfTest:
    """Run the right system and all mutants on cases.

    Parameters
    ----------
    cases : Sequence[Case]
        That the right system passes.
    progress : Callable[[str], None] or None
        Called with the name of each mutant before it runs.

    Raises
    ------
    NothingToMutate
        The right system delivers no record of a case.
    """
    right: dict[str, tuple[Verdict, str]] = {}
    rows: dict[tuple[Mutant, ...], list[Row]] = {MUTANTS: [], MILD: []}
    for case in cases:
        if progress:
            progress("the right system")
        outcome = ReferenceSimulator().run_unrefined(case)
        if not isinstance(outcome, Delivered) or outcome.record is None:
            raise NothingToMutate(f"{case.id}: the reference simulator delivered no record")
        result = grade_case(case, outcome, TRUST)
        right[case.id] = result.verdict, _reason(result)
        for mutants, found in rows.items():
            for mutant in mutants:
                if progress:
                    progress(mutant.name)
                found.append(_row(mutant, case, outcome.record))
    in_order = {mutants: tuple(row for m in mutants for row in rows[mutants] if row.mutant == m) for mutants in rows}
    return SelfTest(right, in_order[MUTANTS], in_order[MILD])


def _row(mutant: Mutant, case: Case, right: Record) -> Row:
    try:
        outcome = mutant.make(case, right)
    except InputError as error:  # what the suite refuses to read: the same as a case that ends in error
        caught = mutant.caught_by == "record file"
        return Row(mutant, case.id, "error", "skip", (), ("record file",), caught, f"{error.where}: {error.found}")
    evaluation = CaseEvaluation(case, outcome if isinstance(outcome, Delivered) else Delivered())
    result = grade_evaluation(evaluation, TRUST) if isinstance(outcome, Delivered) else grade_case(case, outcome, TRUST)
    criteria = evaluation.grade_limits(TRUST)
    outside = tuple(criterion.quantity for criterion in criteria if criterion.verdict == "fail")
    checks = tuple(name for name, finding in evaluation.findings.items() if finding.kind != "unchecked")
    reasons: tuple[str, ...] = checks if result.verdict == "error" else (*checks, *(["limits"] if outside else []))
    return Row(
        mutant,
        case.id,
        result.verdict,
        worst_verdict(criterion.verdict for criterion in criteria),
        outside,
        checks,
        mutant.caught_by is None or (result.verdict in {"fail", "error"} and mutant.caught_by in reasons),
        _reason(result),
    )


def _reason(result: CaseResult) -> str:
    failed = [f"{item.quantity} {item.reason}" for item in result.criteria if item.verdict == "fail"]
    own = [
        warning for warning in result.warnings if not warning.startswith(WARNING_PREFIX)
    ]  # those are said of any system
    return result.reason or "; ".join([*failed, *own])

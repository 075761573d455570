"""Run of the mutants: each is graded like any system, and once more by the limits of the case alone."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from pantocheck.conformance.app.self_test.mutants import MILD, MUTANTS, Mutant
from pantocheck.conformance.app.self_test.numerical_faults import TRUST, NumericalResult
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.case_grading import grade_case, grade_evaluation
from pantocheck.conformance.grading.case_verdict import judge_case
from pantocheck.conformance.grading.validity_warnings import WARNING_PREFIX
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered


@dataclass(frozen=True)
class MutantResult:
    """Result of a mutant on a case."""

    mutant: Mutant
    case: str
    """Id of the case."""
    verdict: Verdict
    """Verdict of the whole suite."""
    by_limits: Verdict
    """Verdict of the limits of the case alone."""
    outside: tuple[str, ...]
    """Quantities outside their limits."""
    checks: tuple[str, ...]
    """Checks of the record that failed."""
    detected: bool
    """Whether the expected check detects the fault; true for a mild fault, which may remain undetected."""
    reason: str
    """Reason of the verdict in the report."""


@dataclass(frozen=True)
class SelfTest:
    """Results of the reference simulator and of the mutants."""

    reference: dict[str, tuple[Verdict, str]]
    """Verdict of the reference simulator on each case, with the reason if it did not pass."""
    severe: tuple[MutantResult, ...]
    """Mutants that must be detected."""
    mild: tuple[MutantResult, ...]
    """Mutants that may remain undetected."""
    numerical: tuple[NumericalResult, ...] = ()
    """Numerical faults with both verdicts."""

    @property
    def passed(self) -> bool:
        """Whether the reference simulator passes and every severe fault is detected as expected."""
        accepted = all(verdict == "pass" for verdict, _ in self.reference.values())
        detected = [*(result.detected for result in self.severe), *(result.detected for result in self.numerical)]
        return accepted and all(detected)


def run_self_test(cases: Sequence[Case], progress: Callable[[str], None]) -> SelfTest:
    """Run the reference simulator and all mutants on cases that it passes; `progress` receives the name of each first.

    Raises:
        RuntimeError: The reference simulator delivers no record of a case, so that there is nothing to mutate.
    """
    reference: dict[str, tuple[Verdict, str]] = {}
    records: dict[str, Record] = {}
    for case in cases:
        progress("reference simulator")
        outcome = ReferenceSimulator().run_unrefined(case)
        if not isinstance(outcome, Delivered) or outcome.record is None:
            raise RuntimeError(f"{case.id}: the reference simulator delivered no record")
        records[case.id] = outcome.record
        result = grade_case(case, outcome, TRUST)
        reference[case.id] = result.verdict, _reason(result)

    def run_mutants(mutants: Sequence[Mutant]) -> Iterator[MutantResult]:
        for mutant in mutants:
            progress(mutant.name)
            for case in cases:
                yield _run_mutant(mutant, case, records[case.id])

    return SelfTest(reference, tuple(run_mutants(MUTANTS)), tuple(run_mutants(MILD)))


def _run_mutant(mutant: Mutant, case: Case, record: Record) -> MutantResult:
    try:
        outcome = mutant.run(case, record)
    except InputError as error:  # a file that the suite refuses to read ends like a case with an error
        reason = f"{error.where}: {error.found}"
        detected = mutant.expected_check == "record file"
        return MutantResult(mutant, case.id, "error", "skip", (), ("record file",), detected, reason)
    evaluation = CaseEvaluation(case, outcome if isinstance(outcome, Delivered) else Delivered())
    result = grade_evaluation(evaluation, TRUST) if isinstance(outcome, Delivered) else grade_case(case, outcome, TRUST)
    criteria = evaluation.grade_limits(TRUST)
    outside = tuple(criterion.quantity for criterion in criteria if criterion.verdict == "fail")
    checks = tuple(name for name, finding in evaluation.findings.items() if finding.kind != "unchecked")
    # After an error the limits are not applied.
    detecting = {*checks, "limits"} if outside and result.verdict != "error" else {*checks}
    return MutantResult(
        mutant,
        case.id,
        result.verdict,
        judge_case((criterion.verdict for criterion in criteria), None),
        outside,
        checks,
        mutant.expected_check is None or (result.verdict in {"fail", "error"} and mutant.expected_check in detecting),
        _reason(result),
    )


def _reason(result: CaseResult) -> str:
    failed = [f"{item.quantity} {item.reason}" for item in result.criteria if item.verdict == "fail"]
    # Every system gets the warning of the extended band.
    warnings = [warning for warning in result.warnings if not warning.startswith(WARNING_PREFIX)]
    return result.reason or "; ".join([*failed, *warnings])

"""Reference models: the system under test runs the cases of the dossier."""

from collections.abc import Sequence

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.grading.procedure_verdict import is_reference
from pantocheck.conformance.procedure.dossier import Dossier
from pantocheck.conformance.procedure.run_conditions import describe_conditions
from pantocheck.conformance.procedure.step_result import StepInterrupted, StepResult
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runner import Progress, RunInterrupted, run_cases
from pantocheck.conformance.systems.system import System


def run_reference_models(
    dossier: Dossier, system: System, participation: Participation, jobs: int, progress: Progress | None
) -> StepResult:
    """Run the reference models of a dossier on the system under test.

    Args:
        dossier: Dossier with the reference models.
        system: System under test.
        participation: Verdicts that decide.
        jobs: Number of parallel processes.
        progress: Callback for each result.

    Raises:
        StepInterrupted: The user ended the run.
    """
    if not dossier.cases:
        return StepResult("reference_models", "not done", "the dossier names no reference model (key reference.cases)")
    try:
        results = run_cases(dossier.cases, system, dossier.file.trust, jobs, progress, participation)
    except RunInterrupted as interruption:
        result = _build_result(dossier, interruption.results.cases)
        raise StepInterrupted(result, interruption.exit_code) from None
    return _build_result(dossier, results.cases)


def _build_result(dossier: Dossier, results: Sequence[CaseResult]) -> StepResult:
    by_id: dict[str, Case] = {case.id: case for case in dossier.cases}
    evidence = [describe_conditions(case.id, by_id[case.id], dossier) for case in results]
    others = [case.id for case in results if not is_reference(case)]
    return StepResult(
        "reference_models",
        cases=tuple(results),
        evidence=tuple(item for item in evidence if item is not None),
        notes=(f"No reference model of the library, for information: {', '.join(others)}.",) if others else (),
    )

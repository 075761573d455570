"""Reference models: the system under test runs the cases of the dossier."""

from collections.abc import Iterator, Sequence

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.dossier.dossier_file import ValidityTable
from pantocheck.conformance.dossier.dossier_reading import Dossier
from pantocheck.conformance.dossier.step_result import StepInterrupted, StepResult, describe_conditions
from pantocheck.conformance.execution.runner import Progress, RunInterrupted, run_cases
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.grading.procedure_verdict import is_reference
from pantocheck.conformance.results.procedure_format import ValidityClaim
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.system import System


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


# Limits of validity: the claims of a dossier. The runs that passed verify them.
def list_claims(dossier: Dossier) -> StepResult:
    """Claims of a dossier; their verdicts follow from those of the runs."""
    table = dossier.file.validity
    if table.claims_nothing:
        return StepResult("limits_of_validity", "not done", "the dossier claims no range of validity (table validity)")
    return StepResult("limits_of_validity", claims=tuple(_list_claims(table)))


def _list_claims(table: ValidityTable) -> Iterator[ValidityClaim]:
    for name in table.lines:
        yield ValidityClaim(kind="line", name=name, unit="", claimed=None)
    for name in table.pantographs:
        yield ValidityClaim(kind="pantograph", name=name, unit="", claimed=None)
    if table.speed_km_h is not None:
        yield ValidityClaim(kind="speed", name="", unit="km/h", claimed=table.speed_km_h)
    if table.spacing_m is not None:
        yield ValidityClaim(kind="spacing", name="", unit="m", claimed=table.spacing_m)
    for change in table.change:
        yield ValidityClaim(kind="change", name=change.key, unit="", claimed=change.range)

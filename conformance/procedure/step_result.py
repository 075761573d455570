"""Result of one step of the procedure, before its verdict is decided."""

from dataclasses import dataclass

from pantocheck.conformance.results.comparison_format import ResponseComparison, StaticComparison
from pantocheck.conformance.results.criterion_format import Criterion
from pantocheck.conformance.results.procedure_format import (
    DeclaredParameter,
    Evidence,
    ProcedureStep,
    StepName,
    StepState,
    ValidityClaim,
)
from pantocheck.conformance.results.results_format import CaseResult


@dataclass(frozen=True)
class StepResult:
    """Result of a step: its criteria, cases and the data of its figures.

    Parameters
    ----------
    step : StepName
        Step of the procedure.
    state : StepState
        Whether the step was done.
    reason : str or None
        Reason why it was not done, or could not be completed.
    unverified : str or None
        Reason why a pass counts as unverified.
    cases : tuple of CaseResult
        Results of the cases and pairs of the step.
    criteria : tuple of Criterion
        Criteria that belong to no case.
    responses : tuple of ResponseComparison
        Frequency responses of the pantographs.
    statics : tuple of StaticComparison
        Lines at rest.
    parameters : tuple of DeclaredParameter
        Declared simulation parameters.
    evidence : tuple of Evidence
        Conditions of the runs of the step.
    claims : tuple of ValidityClaim
        Claims on the range of validity.
    notes : tuple of str
        Remarks for the reader of the report.
    """

    step: StepName
    state: StepState = "done"
    reason: str | None = None
    unverified: str | None = None
    cases: tuple[CaseResult, ...] = ()
    criteria: tuple[Criterion, ...] = ()
    responses: tuple[ResponseComparison, ...] = ()
    statics: tuple[StaticComparison, ...] = ()
    parameters: tuple[DeclaredParameter, ...] = ()
    evidence: tuple[Evidence, ...] = ()
    claims: tuple[ValidityClaim, ...] = ()
    notes: tuple[str, ...] = ()

    def describe(self, required: bool) -> ProcedureStep:
        """The step in the format of results.json, without its verdict."""
        return ProcedureStep(
            step=self.step,
            required=required,
            state=self.state,
            unverified=self.unverified,
            reason=self.reason,
            cases=[case.id for case in self.cases],
            criteria=list(self.criteria),
            notes=list(self.notes),
        )


class StepInterrupted(Exception):
    """The user stopped a step; its finished part is kept.

    Parameters
    ----------
    result : StepResult
        Result with the finished cases.
    exit_code : int
        128 and the number of the signal.
    """

    def __init__(self, result: StepResult, exit_code: int) -> None:
        super().__init__("interrupted")
        self.result, self.exit_code = result, exit_code

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
    """Result of a step: its criteria, cases and the data of its figures."""

    step: StepName
    """Step of the procedure."""
    state: StepState = "done"
    """Whether the step was done."""
    reason: str | None = None
    """Reason why it was not done, or could not be completed."""
    unverified: str | None = None
    """Reason why a pass counts as unverified."""
    cases: tuple[CaseResult, ...] = ()
    """Results of the cases and pairs of the step."""
    criteria: tuple[Criterion, ...] = ()
    """Criteria that belong to no case."""
    responses: tuple[ResponseComparison, ...] = ()
    """Frequency responses of the pantographs."""
    statics: tuple[StaticComparison, ...] = ()
    """Lines at rest."""
    parameters: tuple[DeclaredParameter, ...] = ()
    """Declared simulation parameters."""
    evidence: tuple[Evidence, ...] = ()
    """Conditions of the runs of the step."""
    claims: tuple[ValidityClaim, ...] = ()
    """Claims on the range of validity."""
    notes: tuple[str, ...] = ()
    """Remarks for the reader of the report."""

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

    Args:
        result: Result with the finished cases.
        exit_code: 128 and the number of the signal.
    """

    def __init__(self, result: StepResult, exit_code: int) -> None:
        super().__init__("interrupted")
        self.result, self.exit_code = result, exit_code

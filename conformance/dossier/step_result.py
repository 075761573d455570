"""Result of one step of the procedure, before its verdict is decided."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from pydantic import BaseModel

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.criterion import EVERYWHERE, Criterion
from pantocheck.conformance.core.near_limit import ValueErrors
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.dossier.dossier_reading import Dossier
from pantocheck.conformance.grading.criterion_grading import build_criterion
from pantocheck.conformance.grading.rule_grading import LARGEST_TOLERANCE
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.results.comparison_format import ResponseComparison, StaticComparison
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
    unconfirmed: str | None = None
    """Reason why a pass counts as unconfirmed."""
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
            unconfirmed=self.unconfirmed,
            reason=self.reason,
            cases=[case.id for case in self.cases],
            criteria=list(self.criteria),
            notes=list(self.notes),
        )


def grade_again(
    row: Criterion, changes: Mapping[str, object], lowest_trust: Trust, measured: float | None = None
) -> Criterion:
    """Grade the criterion of a comparison again, as a criterion of the procedure.

    Args:
        row: Criterion of the comparison. A value of an incomplete record is left out, because it must not be graded.
        changes: Name, owner, trust and source of the limits in the procedure.
        lowest_trust: Lowest trust of the limits that count.
        measured: Largest measured value, in the unit of the criterion; default: the criterion is in per cent.
    """
    requirement = row.model_copy(update={"where": EVERYWHERE, **changes})
    if row.verdict == "skip":
        return build_criterion(requirement, None, row.reason, lowest_trust)
    errors = ValueErrors(components=row.components, limit_uncertainty=row.limit_uncertainty or 0.0)
    return build_criterion(
        requirement,
        row.value,
        None,
        lowest_trust,
        errors,
        doubt=_doubt_width(row, 100.0 if row.unit == "%" else measured),
    )


def _doubt_width(row: Criterion, measured: float | None) -> str | None:
    """Reason why a pass by a tolerance does not count beside the measured value; None: it counts."""
    if measured is None or row.upper is None or row.upper <= LARGEST_TOLERANCE * measured:
        return None
    share = f"{100 * LARGEST_TOLERANCE:g} % of the measured value"
    return f"the own tolerance of {row.upper:.4g} {row.unit} is more than {share}"


class StepInterrupted(Exception):
    """The user stopped a step; its finished part is kept.

    Args:
        result: Result with the finished cases.
        exit_code: 128 and the number of the signal.
    """

    def __init__(self, result: StepResult, exit_code: int) -> None:
        super().__init__("interrupted")
        self.result, self.exit_code = result, exit_code


# Conditions of a run that a claim on the range of validity refers to: line, pantographs, speed, spacing, inputs.
def describe_conditions(name: str, case: Case, dossier: Dossier) -> Evidence | None:
    """Conditions of the run of a case, under the id of its result; None for a case without a train."""
    if case.is_static or case.file.mass_drop is not None or case.file.speed_km_h is None:
        return None
    return Evidence(
        id=name,
        line=dossier.name_line(case.line),
        pantographs=[dossier.name_pantograph(part) for part in case.pantographs],
        speed_km_h=case.file.speed_km_h,
        spacing_m=list(case.file.spacing_m or ()),
        inputs=list_inputs(dossier, case.line, case.pantographs),
    )


def list_inputs(dossier: Dossier, line: LineFile, pantographs: Sequence[PantographFile]) -> dict[str, float]:
    """Inputs whose change the dossier claims, by key as for `--set`; an input that is not a number is left out."""
    found = {claim.key: _find_input(claim.key, line, pantographs) for claim in dossier.file.validity.change}
    return {key: value for key, value in found.items() if value is not None}


def _find_input(key: str, line: LineFile, pantographs: Sequence[PantographFile]) -> float | None:
    part, *names = key.split(".")
    if part == "line":
        return _follow(line, names)
    values = {_follow(pantograph, names) for pantograph in pantographs} if part == "pantograph" else set()
    return values.pop() if len(values) == 1 else None


def _follow(table: BaseModel, names: Iterable[str]) -> float | None:
    """Number at a path of keys in a table; items of a list count from 1. None if there is no number."""
    content: object = table
    for name in names:
        if isinstance(content, BaseModel):
            content = getattr(content, name, None)
        elif isinstance(content, tuple) and name.isdigit() and 1 <= int(name) <= len(content):
            content = content[int(name) - 1]
        else:
            return None
    return float(content) if isinstance(content, int | float) and not isinstance(content, bool) else None

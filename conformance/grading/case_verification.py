"""Verification of a case: its quantities against the converged solution of the same equations, up to 50 Hz.

Inputs and conventions of a case determine its solution. A simulator that solves the same equations must meet the
converged solution, in the 20-50 Hz band and on cases without published limits as well. This is code verification: it
is separate from the EN 50318 criteria and never decides their verdict.
"""

from dataclasses import replace

from pantocheck.conformance.cases.case import Case, json_digest
from pantocheck.conformance.cases.converged_file import ConvergedFile, find_converged
from pantocheck.conformance.grading import verification_limits
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.case_verdict import judge_case
from pantocheck.conformance.grading.criterion_grading import grade_requirement
from pantocheck.conformance.grading.start_agreement import list_verification_components
from pantocheck.conformance.grading.verdicts import Verdict
from pantocheck.conformance.grading.verification_limits import build_requirements, include_start
from pantocheck.conformance.results.criterion_format import CaseVerification, Criterion


def verify_evaluation(evaluation: CaseEvaluation) -> CaseVerification | None:
    """Verify an evaluated delivery; None if its case has no converged values.

    The section is that of the converged solution, and so is the start unless the record states another one. Then the
    change of the values with the start widens the limits. The other components of the uncertainty do not matter.
    """
    case = evaluation.case
    if (converged := find_converged(case.id)) is None:
        return None
    if (reason := find_obstacle(case, converged)) is not None:
        return _build_verification(converged, "info", reason)
    if evaluation.contradiction is not None:
        return _build_verification(converged, "error", evaluation.contradiction)
    components = list_verification_components(evaluation.start_agreement.state)
    values = replace(evaluation.values, spread={}, uncertainty=evaluation.uncertainty.select(components))
    requirements = build_requirements(converged, case.is_static)
    criteria = [grade_requirement(requirement, values, "computed") for requirement in requirements]
    if evaluation.start_agreement.state == "differs":
        others = [grade_requirement(include_start(limit, converged), values, "computed") for limit in requirements]
        criteria = [_name_statement(*pair) for pair in zip(criteria, others, strict=True)]
    verdict = judge_case((criterion.verdict for criterion in criteria), evaluation.record_facts)
    return _build_verification(converged, verdict, None).model_copy(update={"criteria": criteria})


def _name_statement(criterion: Criterion, widened: Criterion) -> Criterion:
    """Criterion with widened limits; if it passes only inside them, its reason says so."""
    if (criterion.verdict, widened.verdict) != ("fail", "pass"):
        return widened
    return widened.model_copy(update={"reason": f"{criterion.reason} without the stated start, which is not checked"})


def verify_ungraded(case: Case, verdict: Verdict, reason: str) -> CaseVerification | None:
    """Verification of a case that was not graded; None if the case has no converged values."""
    converged = find_converged(case.id)
    return None if converged is None else _build_verification(converged, verdict, reason)


def find_obstacle(case: Case, converged: ConvergedFile) -> str | None:
    """Reason why converged values cannot limit a case; None if they can."""
    if converged.case_digest != case.digest:
        return "the converged values belong to another version of this case"
    if not build_requirements(converged, case.is_static):
        return "no quantity of this case has a converged value that a second formulation confirms"
    return None


def _build_verification(converged: ConvergedFile, verdict: Verdict, reason: str | None) -> CaseVerification:
    """Verification without criteria."""
    return CaseVerification(
        verdict=verdict,
        reason=reason,
        confirmed_by=converged.second.name,
        digest=verification_digest(converged),
        omitted=[_describe_omission(entry.quantity, entry.owner, entry.reason) for entry in converged.omitted],
        criteria=[],
    )


def verification_digest(converged: ConvergedFile) -> str:
    """SHA-256 of the converged values and of the tolerances."""
    tolerances = verification_limits.RELATIVE | {"extremes": verification_limits.EXTREMES_TOLERANCE}
    return json_digest([converged.model_dump(mode="json"), tolerances])


def _describe_omission(quantity: str, owner: int, reason: str) -> str:
    return f"{quantity}{f' of pantograph {owner}' if owner else ''}: {reason}"

"""Verification of a case: its quantities against the converged solution of the same equations, up to 50 Hz.

Inputs and conventions of a case determine its solution. A simulator that solves the same equations must meet the
converged solution, in the 20-50 Hz band and on cases without published limits as well. This is code verification: it
is separate from the EN 50318 criteria and never decides their verdict.
"""

from dataclasses import replace

from pantocheck.conformance.cases.case import Case, json_digest
from pantocheck.conformance.cases.converged_file import ConvergedFile, ConvergedValue, find_converged
from pantocheck.conformance.core.criterion import CaseVerification, Criterion, Requirement
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.case_verdict import judge_case
from pantocheck.conformance.grading.criterion_grading import grade_requirement
from pantocheck.conformance.grading.start_agreement import list_verification_components
from pantocheck.conformance.quantities.registry import QUANTITIES, unit_of


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


UNCHECKED_START = "without the stated start, which is not checked"
"""End of the reason of a criterion that passes only inside the limits that the stated start widens."""


def _name_statement(criterion: Criterion, widened: Criterion) -> Criterion:
    """Criterion with widened limits; if it passes only inside them, its reason says so."""
    if (criterion.verdict, widened.verdict) != ("fail", "pass"):
        return widened
    return widened.model_copy(update={"reason": f"{criterion.reason} {UNCHECKED_START}"})


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
    tolerances = RELATIVE | {"extremes": EXTREMES_TOLERANCE}
    return json_digest([converged.model_dump(mode="json"), tolerances])


def _describe_omission(quantity: str, owner: int, reason: str) -> str:
    return f"{quantity}{f' of pantograph {owner}' if owner else ''}: {reason}"


# Verification limits: the interval of a converged value, widened by a tolerance for open modelling choices.
#
# docs/verification.md gives the measurements behind the tolerances.
MEAN_TOLERANCE = 0.01
"""Relative tolerance of the mean contact force, which statics determine."""

STATIC_TOLERANCE = 0.03
"""Relative tolerance of the elasticity."""

BELOW_5_HZ_TOLERANCE = 0.03
"""Relative tolerance of the RMS below 5 Hz."""

TO_20_HZ_TOLERANCE = 0.05
"""Relative tolerance of the RMS from 5 to 20 Hz and of the standard deviation below 20 Hz."""

TO_50_HZ_TOLERANCE = 0.1
"""Relative tolerance of the RMS from 20 to 50 Hz."""

EXTREMES_TOLERANCE = 0.05
"""Tolerance of an extreme of the contact force, relative to its distance from the mean contact force."""

UPLIFT_TOLERANCE = 0.05
"""Relative tolerance of the uplift at the supports."""

RELATIVE: dict[str, float] = {
    "mean_force_N": MEAN_TOLERANCE,
    "std_force_N": TO_20_HZ_TOLERANCE,
    "rms_0_5_N": BELOW_5_HZ_TOLERANCE,
    "rms_5_20_N": TO_20_HZ_TOLERANCE,
    "rms_20_50_N": TO_50_HZ_TOLERANCE,
    "max_uplift_at_support_mm": UPLIFT_TOLERANCE,
    "elasticity_mm_N": STATIC_TOLERANCE,
    "elasticity_non_uniformity_pct": STATIC_TOLERANCE,
}
"""Tolerances relative to the value."""

EXTREMES = ("statistical_max_N", "statistical_min_N", "max_force_N", "min_force_N")
"""Quantities whose tolerance is relative to their distance from the mean contact force."""

VERIFIED_QUANTITIES = (*RELATIVE, *EXTREMES)
"""Quantities with a tolerance; no other quantity has a verification limit."""


def build_requirements(converged: ConvergedFile, is_static: bool) -> tuple[Requirement, ...]:
    """Verification limits of a case.

    Args:
        converged: Converged values of the case.
        is_static: Whether the case is a check of the line at rest. A record of a passage has no quantities of the line
            at rest, so that those are required of a static case only.
    """
    source = f"converged solution, confirmed by {converged.second.name}"
    means = {value.owner: value.value for value in converged.value if value.quantity == "mean_force_N"}
    return tuple(
        _build_requirement(value, means.get(value.owner), source)
        for value in converged.value
        if value.quantity in VERIFIED_QUANTITIES and (QUANTITIES[value.quantity].scope == "static") == is_static
    )


def _build_requirement(converged: ConvergedValue, mean: float | None, source: str) -> Requirement:
    width = converged.half_width + tolerance(converged.quantity, converged.value, mean)
    return Requirement(
        quantity=converged.quantity,
        pantograph=converged.owner,
        unit=unit_of(converged.quantity),
        lower=converged.value - width,
        upper=converged.value + width,
        trust="computed",
        source=source,
    )


def include_start(requirement: Requirement, converged: ConvergedFile) -> Requirement:
    """Verification limit that holds for other starts, too.

    A value whose change with the start is not known keeps its limits.
    """
    widths = {(value.owner, value.quantity): value.start_half_width for value in converged.value}
    width = widths[requirement.pantograph, requirement.quantity]
    if width is None or requirement.lower is None or requirement.upper is None:
        return requirement
    source = f"{requirement.source}; widened for the start that the record states, which is not checked"
    widened = {"lower": requirement.lower - width, "upper": requirement.upper + width, "source": source}
    return requirement.model_copy(update=widened)


def tolerance(quantity: str, value: float, mean: float | None) -> float:
    """Tolerance of a converged value, in its unit.

    Args:
        quantity: One of `VERIFIED_QUANTITIES`.
        value: Converged value.
        mean: Converged mean contact force of the pantograph [N]; None for a quantity of the line.

    Raises:
        ValueError: An extreme without a mean contact force.
    """
    if quantity in RELATIVE:
        return RELATIVE[quantity] * abs(value)
    if mean is None:
        raise ValueError(f"the tolerance of {quantity} needs a mean contact force")
    return EXTREMES_TOLERANCE * abs(value - mean)

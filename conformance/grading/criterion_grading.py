"""Grading of one criterion: a value against its limits."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.core.criterion import Criterion, LimitTarget, Requirement
from pantocheck.conformance.core.decision import SIMPLE, DecisionRule, judge_by_rule
from pantocheck.conformance.core.findings import IMPOSED_REASON, grade_finding, lower_imposed_verdict
from pantocheck.conformance.core.near_limit import NO_ERRORS, ValueErrors, near_limit_remarks
from pantocheck.conformance.core.results_part import select_item
from pantocheck.conformance.core.trust import Computed, LimitTrust, Trust, decides_verdict
from pantocheck.conformance.core.verdicts import Verdict, margin
from pantocheck.conformance.quantities.evaluation import LINE, Evaluation, Value
from pantocheck.conformance.quantities.limit_text import name_value
from pantocheck.conformance.quantities.registry import unit_of
from pantocheck.conformance.quantities.uncertainty import Uncertainty

ErrorsByQuantity = Mapping[int, Mapping[str, float]]
"""Errors of quantities, by pantograph (0: the line) and name."""


@dataclass(frozen=True)
class GradedValues:
    """Quantities of a run, with their uncertainty."""

    evaluation: Evaluation
    """Quantities, and the reasons why others are not available."""
    refined: Evaluation | None = None
    """Quantities of the same case with element length and time step halved."""
    spread: ErrorsByQuantity = field(default_factory=dict)
    """Largest change when the analysis section is shifted span by span."""
    uncertainty: Uncertainty = field(default_factory=Uncertainty)
    """Half-widths by component."""


def convert_limit(limit: Limit) -> Requirement:
    """Requirement of a limit of a case, a user or a profile."""
    return Requirement(
        quantity=limit.quantity,
        pantograph=limit.owner,
        item=limit.item,
        unit=unit_of(limit.quantity),
        lower=limit.lower,
        upper=limit.upper,
        trust=limit.trust,
        source=source_text(limit.source),
        finding=limit.finding,
    )


def grade_limit(
    limit: Limit,
    values: GradedValues,
    lowest_trust: Trust,
    limit_uncertainty: float | None = 0.0,
    rule: DecisionRule = SIMPLE,
    doubt: str | None = None,
) -> Criterion:
    """Grade a quantity by a limit; parameters as in `grade_requirement`."""
    return grade_requirement(convert_limit(limit), values, lowest_trust, limit_uncertainty, rule, doubt)


def grade_requirement(
    requirement: Requirement,
    values: GradedValues,
    lowest_trust: Trust | Computed,
    limit_uncertainty: float | None = 0.0,
    rule: DecisionRule = SIMPLE,
    doubt: str | None = None,
) -> Criterion:
    """Grade a quantity of a run.

    Args:
        requirement: Limits of one quantity.
        values: Quantities of the run.
        lowest_trust: Lowest trust of the limits that count.
        limit_uncertainty: Uncertainty of the limit itself, if it comes from a measured record; None: not known.
        rule: Decision rule.
        doubt: Reason why a pass does not count; None: it counts.
    """
    name, owner, item = requirement.target
    value = find_value(requirement.target, values.evaluation.values)
    if value is None:
        missing = values.evaluation.skipped.get(owner, {}).get(name, "the system does not deliver this quantity")
        return build_criterion(requirement, None, missing, lowest_trust)
    refined = None if values.refined is None else find_value(requirement.target, values.refined.values)
    errors = ValueErrors(
        discretisation=None if refined is None else abs(value - refined),
        spread=values.spread.get(owner, {}).get(name),
        components={
            part: half_width
            for part, width in values.uncertainty.list_components(owner, name).items()
            if (half_width := select_item(width, item)) is not None
        },
        limit_uncertainty=limit_uncertainty,
        draws=values.uncertainty.sample.get(owner, {}).get(name, ()),
        unknown=values.uncertainty.list_unknown(owner, name),
    )
    return build_criterion(requirement, value, None, lowest_trust, errors, rule=rule, doubt=doubt)


def build_criterion(
    requirement: Requirement,
    value: float | None,
    missing: str | None,
    lowest_trust: Trust | Computed,
    errors: ValueErrors = NO_ERRORS,
    place: str = "",
    rule: DecisionRule = SIMPLE,
    doubt: str | None = None,
) -> Criterion:
    """Grade a value by its limits: the one way to a verdict with its reason, margin and remarks near a limit.

    Args:
        requirement: Limits of the value; a value without limits is skipped.
        value: Value; None if it is not available.
        missing: Missing data, or reason why there is no value or no limit: the criterion is skipped. A distance beyond
            a limit is stated all the same.
        lowest_trust: Lowest trust of the limits that count.
        errors: Errors of the value.
        place: Place of the value in words, behind the distance beyond a limit.
        rule: Decision rule.
        doubt: Reason why a pass does not count; None: it counts.
    """
    limits, reasons = (requirement.lower, requirement.upper), [] if missing is None else [missing]
    verdict: Verdict = "skip"
    if value is not None and limits != (None, None):
        verdict, undecided = judge_by_rule(value, limits, errors, rule)
        reasons += [_describe_distance(value, requirement) + place] if verdict == "fail" else []
        reasons += [] if undecided is None else [undecided]
        verdict = verdict if missing is None else "skip"
    reason = "; ".join(reasons) or None
    finding = None if requirement.finding is None else grade_finding(requirement.finding, verdict)
    if not decides_verdict(requirement.trust, lowest_trust):
        hypothetical = {
            "pass": "would pass",
            "undecided": f"would be undecided: {reason}",
            "fail": f"would fail: {reason}",
            "skip": f"not graded: {reason}",
        }[verdict]
        verdict, reason = "info", f"{hypothetical}; the limit is {requirement.trust} and does not count"
    elif verdict == "pass" and doubt is not None:
        verdict, reason = "info", f"would pass; {doubt}"
    elif finding is not None and (counted := lower_imposed_verdict(finding.role, verdict)) != verdict:
        verdict, reason = counted, IMPOSED_REASON
    stated = {key: part for key, part in requirement if key in Requirement.model_fields and key != "finding"}
    return Criterion(
        **stated,
        value=value,
        verdict=verdict,
        margin=None if value is None or limits == (None, None) else margin(value, *limits),
        discretisation_error=errors.discretisation,
        spread=errors.spread,
        reason=reason,
        uncertainty=None if value is None else errors.find_half_width(value),
        conformity=None if value is None or limits == (None, None) else errors.find_conformity(limits),
        draws=list(errors.draws),
        components=dict(errors.components),
        limit_uncertainty=errors.limit_uncertainty,
        doubt=doubt,
        close=near_limit_remarks(value, limits, requirement.unit, errors),
        finding=finding,
    )


def _describe_distance(value: float, limits: Requirement) -> str:
    """Distance beyond a limit, with its unit and side."""
    if limits.lower is not None and value < limits.lower:
        return " ".join(filter(None, (f"{limits.lower - value:.3g}", limits.unit, "below the lower limit")))
    return " ".join(filter(None, (f"{value - (limits.upper or 0.0):.3g}", limits.unit, "above the upper limit")))


def skip_unlimited(
    quantity: str,
    reason: str,
    source: str,
    *,
    owner: int = LINE,
    item: int | None = None,
    unit: str | None = None,
    value: float | None = None,
    trust: LimitTrust | None = "primary",
    lowest_trust: Trust = "primary",
) -> Criterion:
    """Skipped criterion of a quantity that is demanded and has no limit or no record, so that its lack is noticed.

    Args:
        quantity: Name of the quantity.
        reason: Reason for the skip.
        source: Document that demands the quantity.
        owner: Number of the pantograph; 0: the line.
        item: Number among several values.
        unit: Unit of a value that is not a quantity of a run.
        value: Value without a limit.
        trust: Trust of the demand; None: a baseline.
        lowest_trust: Lowest trust of the demands that count.
    """
    requirement = Requirement(
        quantity=quantity,
        pantograph=owner,
        item=item,
        unit=unit_of(quantity) if unit is None else unit,
        lower=None,
        upper=None,
        trust=trust,
        source=source,
    )
    return build_criterion(requirement, value, reason, lowest_trust)


def criterion_name(criterion: Criterion) -> str:
    """Name of a criterion: quantity, item and owner."""
    name = name_value(criterion.quantity, criterion.item)
    return f"{name} of pantograph {criterion.pantograph}" if criterion.pantograph else f"{name} of the line"


def find_value(target: LimitTarget, values: Mapping[int, Mapping[str, Value]]) -> float | None:
    """Value that limits apply to; None if there is none, or no finite one.

    Args:
        target: Quantity, pantograph and item of the limits.
        values: Quantities by pantograph (0: the line) and name.
    """
    quantity, owner, item = target
    number = select_item(values.get(owner, {}).get(quantity), item)
    return number if number is not None and math.isfinite(number) else None

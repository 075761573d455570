"""Grading of one criterion: a value against its limits."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.findings import IMPOSED_REASON, PublishedFinding, count_verdict, grade_finding
from pantocheck.conformance.core.near_limit import NO_ERRORS, ValueErrors, grade_value
from pantocheck.conformance.core.results_part import select_item
from pantocheck.conformance.core.trust import Computed, Trust, limit_counts
from pantocheck.conformance.quantities.evaluation import LINE, Evaluation, Value
from pantocheck.conformance.quantities.limit_text import name_value
from pantocheck.conformance.quantities.registry import unit_of
from pantocheck.conformance.quantities.uncertainty import Uncertainty

ErrorsByQuantity = Mapping[int, Mapping[str, float]]
"""Errors of quantities, by pantograph (0: the line) and name."""


@dataclass(frozen=True)
class Requirement:
    """Limits of one number."""

    quantity: str
    """Name of the quantity."""
    owner: int
    """Number of the pantograph, 0 for the line."""
    item: int | None
    """Number among several values (dropper, mode), from 1."""
    lower: float | None
    upper: float | None
    """Limits in the unit of the quantity; both None if they are not known."""
    trust: Trust | Computed | None
    """Trust of the limits; None: bounds of a baseline."""
    source: str
    """Source of the limits."""
    finding: PublishedFinding | None = None
    """Finding of a publication that the limits grade."""
    unit: str | None = None
    """Unit of a value that is no quantity of a run; None: that of the quantity."""
    baseline: float | None = None
    """Earlier value, if the limits bound the drift from it."""


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
    """Half-widths of the 95 % intervals by component."""


def grade_limit(limit: Limit, values: GradedValues, lowest_trust: Trust, limit_uncertainty: float = 0.0) -> Criterion:
    """Grade a quantity by a limit.

    Args:
        limit: Limit of one quantity.
        values: Quantities of the run.
        lowest_trust: Lowest trust of the limits that count.
        limit_uncertainty: Uncertainty of the limit itself, if it comes from a measured record.
    """
    number, source = (limit.quantity, limit.owner, limit.item), source_text(limit.source)
    requirement = Requirement(*number, limit.lower, limit.upper, limit.trust, source, limit.finding)
    return grade_requirement(requirement, values, lowest_trust, limit_uncertainty)


def grade_requirement(
    requirement: Requirement, values: GradedValues, lowest_trust: Trust | Computed, limit_uncertainty: float = 0.0
) -> Criterion:
    """Grade a quantity by a requirement; parameters as in `grade_limit`."""
    owner, name = requirement.owner, requirement.quantity
    value = find_value(requirement, values.evaluation.values)
    components = values.uncertainty.list_components(owner, name)
    if value is None:
        missing = values.evaluation.skipped.get(owner, {}).get(name, "the system does not deliver this quantity")
        return build_criterion(requirement, None, missing, lowest_trust)
    refined = None if values.refined is None else find_value(requirement, values.refined.values)
    errors = ValueErrors(
        discretisation=None if refined is None else abs(value - refined),
        spread=values.spread.get(owner, {}).get(name),
        components={
            part: item
            for part, width in components.items()
            if (item := select_item(width, requirement.item)) is not None
        },
        limit_uncertainty=limit_uncertainty,
    )
    return build_criterion(requirement, value, None, lowest_trust, errors)


def build_criterion(
    requirement: Requirement,
    value: float | None,
    missing: str | None,
    lowest_trust: Trust | Computed,
    errors: ValueErrors = NO_ERRORS,
) -> Criterion:
    """Grade a value by its limits.

    Args:
        requirement: Limits of the value.
        value: Value; None if it is not available.
        missing: Reason why there is no value or no limit.
        lowest_trust: Lowest trust of the limits that count.
        errors: Errors of the value.
    """
    name, lower, upper = requirement.quantity, requirement.lower, requirement.upper
    unit = unit_of(name) if requirement.unit is None else requirement.unit
    grade = grade_value(value, (lower, upper), unit, errors, missing, names_side=True)
    verdict, reason = grade.verdict, grade.reason
    finding = None if requirement.finding is None else grade_finding(requirement.finding, verdict)
    if not limit_counts(requirement.trust, lowest_trust):
        hypothetical = {"pass": "would pass", "fail": f"would fail: {reason}", "skip": f"not graded: {reason}"}[verdict]
        verdict, reason = "info", f"{hypothetical}; the limit is {requirement.trust} and does not count"
    elif finding is not None and (counted := count_verdict(finding.role, verdict)) != verdict:
        verdict, reason = counted, IMPOSED_REASON
    return Criterion(
        quantity=name,
        pantograph=requirement.owner,
        item=requirement.item,
        value=value,
        unit=unit,
        lower=lower,
        upper=upper,
        verdict=verdict,
        trust=requirement.trust,
        source=requirement.source,
        margin=grade.margin,
        discretisation_error=errors.discretisation,
        spread=errors.spread,
        reason=reason,
        uncertainty=errors.uncertainty,
        components=dict(errors.components),
        limit_uncertainty=errors.limit_uncertainty,
        close=list(grade.close),
        baseline=requirement.baseline,
        finding=finding,
    )


def skip_unlimited(
    quantity: str,
    reason: str,
    source: str,
    *,
    owner: int = LINE,
    item: int | None = None,
    unit: str | None = None,
    value: float | None = None,
) -> Criterion:
    """Skipped criterion of a quantity that is demanded and has no limit or no record, so that its lack is noticed.

    Args:
        quantity: Name of the quantity.
        reason: Reason for the skip.
        source: Document that demands the quantity.
        owner: Number of the pantograph; 0: the line.
        item: Number among several values.
        unit: Unit of a value that is no quantity of a run.
        value: Value without a limit.
    """
    requirement = Requirement(quantity, owner, item, None, None, "primary", source, unit=unit)
    return build_criterion(requirement, value, reason, "primary")


def criterion_name(criterion: Criterion) -> str:
    """Name of a criterion: quantity, item and owner."""
    name = name_value(criterion.quantity, criterion.item)
    return f"{name} of pantograph {criterion.pantograph}" if criterion.pantograph else f"{name} of the line"


def find_value(requirement: Requirement | Limit, values: Mapping[int, Mapping[str, Value]]) -> float | None:
    """Value that limits apply to; None if there is none, or no finite one.

    Args:
        requirement: Limits of one quantity, or of one item of it.
        values: Quantities by pantograph (0: the line) and name.
    """
    number = select_item(values.get(requirement.owner, {}).get(requirement.quantity), requirement.item)
    return number if number is not None and math.isfinite(number) else None

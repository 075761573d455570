"""Verification limits: the interval of a converged value, widened by a tolerance for open modelling choices.

docs/verification.md gives the measurements behind the tolerances.
"""

from dataclasses import replace

from pantocheck.conformance.cases.converged_file import ConvergedFile, ConvergedValue
from pantocheck.conformance.grading.criterion_grading import Requirement
from pantocheck.conformance.quantities.registry import QUANTITIES

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
        owner=converged.owner,
        item=None,
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
    width = widths[requirement.owner, requirement.quantity]
    if width is None or requirement.lower is None or requirement.upper is None:
        return requirement
    source = f"{requirement.source}; widened for the start that the record states, which is not checked"
    return replace(requirement, lower=requirement.lower - width, upper=requirement.upper + width, source=source)


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

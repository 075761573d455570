"""Near-limit rule: a value closer to a limit than its uncertainty is marked, as its verdict could be reversed."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NamedTuple

from pantocheck.conformance.core.criterion import ComponentName
from pantocheck.conformance.core.verdicts import Verdict, judge, margin

REMEDIES: Mapping[str, str] = MappingProxyType(
    {
        "discretisation": "a finer mesh and time step",
        "start": "another start or run-in",
        "section": "another analysis section",
        "length": "a longer record",
        "limit": "another record behind the limit",
    }
)
"""Change that could reverse the verdict, by the largest component of the uncertainty."""


@dataclass(frozen=True)
class ValueErrors:
    """Errors of a value, in its unit."""

    discretisation: float | None = None
    """Change when element length and time step are halved; None: not known."""
    spread: float | None = None
    """Largest change when the analysis section is shifted span by span; None: not known."""
    components: Mapping[ComponentName, float] = field(default_factory=dict)
    """Half-widths of the 95 % interval by component; unknown components are left out."""
    limit_uncertainty: float = 0.0
    """Half-width of the 95 % interval of the limit itself, if it comes from a measured record."""

    @property
    def uncertainty(self) -> float | None:
        """Combined half-width of the 95 % interval of the value; None if no component is known."""
        return math.hypot(*self.components.values()) if self.components else None


NO_ERRORS = ValueErrors()


def near_limit_remarks(
    value: float | None, limits: tuple[float | None, float | None], unit: str, errors: ValueErrors
) -> list[str]:
    """Remark on a value whose uncertainty, combined with that of its limit, exceeds its distance from the nearer limit.

    Args:
        value: Graded value; None if there is none.
        limits: Lower and upper limit. Equal limits have no remark: any error would exceed the distance.
        unit: Unit of the value.
        errors: Errors of the value.

    Returns:
        One remark, or none.
    """
    lower, upper = limits
    if value is None or lower == upper:
        return []
    distance = min(abs(value - limit) for limit in limits if limit is not None)
    parts: dict[str, float] = {"limit": errors.limit_uncertainty} | {str(k): v for k, v in errors.components.items()}
    combined = math.hypot(*parts.values())
    if not distance < combined:
        return []
    largest = max(parts, key=lambda name: parts[name])
    return [
        f"lies {_format(distance, unit)} from a limit, less than its uncertainty of {_format(combined, unit)} "
        f"(mostly {largest}): {REMEDIES[largest]} could reverse the verdict"
    ]


def _format(number: float, unit: str) -> str:
    return f"{number:.2g} {unit}".rstrip()


class ValueGrade(NamedTuple):
    """Verdict on a value, with its reason, its normalised margin and its remarks near a limit."""

    verdict: Verdict
    reason: str | None
    margin: float | None
    close: tuple[str, ...]


def grade_value(
    value: float | None,
    limits: tuple[float | None, float | None],
    unit: str,
    errors: ValueErrors = NO_ERRORS,
    missing: str | None = None,
    place: str = "",
    names_side: bool = False,
) -> ValueGrade:
    """Grade a value; it is skipped if data are missing, and a distance beyond a limit is stated all the same.

    Args:
        value: Graded value; None if there is none.
        limits: Lower and upper limit; a value without limits is skipped.
        unit: Unit of the value; empty for a ratio.
        errors: Errors of the value.
        missing: Missing data of the record, or reason why there is no limit; None if both are complete.
        place: Place of the value in words, behind the distance beyond a limit.
        names_side: Whether the reason names the lower or the upper limit.

    Returns:
        The grade.
    """
    if value is None or limits == (None, None):
        return ValueGrade("skip", missing, None, ())
    verdict = judge(value, *limits)
    reasons = [] if missing is None else [missing]
    if verdict == "fail":
        reasons.append(_describe_distance(value, limits, unit, names_side) + place)
    close = tuple(near_limit_remarks(value, limits, unit, errors))
    return ValueGrade(verdict if missing is None else "skip", "; ".join(reasons) or None, margin(value, *limits), close)


def _describe_distance(value: float, limits: tuple[float | None, float | None], unit: str, names_side: bool) -> str:
    lower, upper = limits
    if lower is not None and value < lower:
        distance, side = lower - value, "below the lower limit"
    else:
        distance, side = value - (upper or 0.0), "above the upper limit"
    return " ".join(filter(None, (f"{distance:.3g}", unit, side if names_side else "beyond the limit")))

"""Near-limit rule: a value closer to a limit than its uncertainty is marked, as its verdict could be reversed."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from pantocheck.conformance.core.criterion import ComponentName

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
    limit_uncertainty: float | None = 0.0
    """Half-width of the 95 % interval of the limit itself, if it comes from a measured record; None: not stated."""

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
    widths = {str(component): width for component, width in errors.components.items()}
    parts = {"limit": errors.limit_uncertainty or 0.0} | widths
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

"""Near-limit rule: a value closer to a limit than its uncertainty is marked, as its verdict could be reversed."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from statistics import NormalDist
from types import MappingProxyType

import numpy as np

from pantocheck.conformance.core.criterion import ComponentName

INTERVAL_SHARE = 0.95
"""Share of the joint sample inside an interval."""

QUANTILE_95 = 1.959964
"""Half-width of a 95 % interval in standard deviations."""

BOUNDED_COMPONENTS: tuple[ComponentName, ...] = ("sampling", "resolution", "alignment")
"""Components that bound the error of a record with fewer samples or digits, or with several clocks."""

LimitPair = tuple[float | None, float | None]
"""Lower and upper limit; None: none on this side."""

REMEDIES: Mapping[str, str] = MappingProxyType(
    {
        "discretisation": "a finer mesh and time step",
        "start": "another start or run-in",
        "section": "another analysis section",
        "length": "a longer record",
        "sampling": "a higher sampling rate",
        "resolution": "a finer resolution",
        "line": "a line that is known better",
        "alignment": "a better join of the clocks",
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
    """Half-widths by component; unknown components are left out."""
    limit_uncertainty: float | None = 0.0
    """Half-width of the 95 % interval of the limit itself, if it comes from a measured record; None: not stated."""
    draws: tuple[float, ...] = ()
    """Values of the joint sample; empty: no sample was drawn."""
    unknown: tuple[ComponentName, ...] = ()
    """Components that are not known."""

    def find_half_width(self, value: float) -> float | None:
        """Half-width of the 95 % interval around the value; None if no component is known.

        It holds 95 % of the joint sample. Without a sample, the components are independent.
        """
        if self.draws:
            return interval_half_width(value, self.draws)
        return math.hypot(*self.components.values()) if self.components else None

    def find_expanded(self, value: float) -> float:
        """Half-width of the 95 % interval of the distance between value and limit."""
        return math.hypot(self.find_half_width(value) or 0.0, self.limit_uncertainty or 0.0)

    def find_conformity(self, limits: LimitPair) -> float | None:
        """Probability that the value lies inside its limits (JCGM 106:2012, 7.2); None without a joint sample.

        It is the share of the joint sample inside the limits. An uncertain limit has a normal distribution.
        """
        if not self.draws:
            return None
        lower, upper = (-math.inf if limits[0] is None else limits[0]), (math.inf if limits[1] is None else limits[1])
        if not self.limit_uncertainty:
            return sum(lower <= x <= upper for x in self.draws) / len(self.draws)
        normal = NormalDist(0.0, self.limit_uncertainty / QUANTILE_95)
        return math.fsum(normal.cdf(upper - x) - normal.cdf(lower - x) for x in self.draws) / len(self.draws)

    @property
    def record_bound(self) -> float:
        """Largest change of the value by sampling rate, resolution and clocks of its record."""
        return sum(self.components.get(name, 0.0) for name in BOUNDED_COMPONENTS)


NO_ERRORS = ValueErrors()


def interval_half_width(value: float, draws: Sequence[float]) -> float:
    """Half-width of the interval around a value that holds 95 % of a joint sample."""
    return float(np.quantile(np.abs(np.subtract(draws, value)), INTERVAL_SHARE))


def near_limit_remarks(
    value: float | None, limits: tuple[float | None, float | None], unit: str, errors: ValueErrors
) -> list[str]:
    """Remark on a value whose uncertainty, combined with that of its limit, exceeds its distance from the nearer limit.

    Args:
        value: Graded value; None if there is none.
        limits: Lower and upper limit.
        unit: Unit of the value.
        errors: Errors of the value.

    Returns:
        One remark, or none.
    """
    if value is None or limits == (None, None):
        return []
    distance, expanded = min(abs(value - limit) for limit in limits if limit is not None), errors.find_expanded(value)
    if not distance < expanded:
        return []
    largest = find_largest_component(errors.components, errors.limit_uncertainty)
    return [
        f"lies {_format(distance, unit)} from a limit, less than its uncertainty of {_format(expanded, unit)} "
        f"(mostly {largest}): {REMEDIES[largest]} could reverse the verdict"
    ]


def find_largest_component(components: Mapping[ComponentName, float], limit_uncertainty: float | None) -> str:
    """Largest component of the distance between value and limit; `limit` is the uncertainty of the limit itself."""
    parts = {"limit": limit_uncertainty or 0.0} | {str(name): width for name, width in components.items()}
    return max(parts, key=lambda name: parts[name])


def _format(number: float, unit: str) -> str:
    return f"{number:.2g} {unit}".rstrip()

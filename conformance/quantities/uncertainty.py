"""Uncertainty of values: half-widths by component, and the interval that holds 95 % of their joint sample.

A component that cannot be determined is named with the reason; it is not zero.
"""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.criterion import ComponentName
from pantocheck.conformance.core.near_limit import BOUNDED_COMPONENTS, QUANTILE_95, interval_half_width
from pantocheck.conformance.core.rounding import round_digits
from pantocheck.conformance.quantities.evaluation import Value, ValuesByOwner

ABSENT_BASIS = "does not apply"
"""Beginning of the basis of a component that a case cannot have."""

UNKNOWN_BASIS = "not known"
"""Beginning of the basis of a component that is not known."""

JointSample = Mapping[int, Mapping[str, tuple[float, ...]]]
"""Draws of the quantities by pantograph (0: the line) and name; draws of the same number belong together."""


@dataclass(frozen=True)
class Component:
    """One component of the uncertainty of all values of a case."""

    basis: str
    """How the half-widths were determined, or why there are none."""
    half_widths: ValuesByOwner = field(default_factory=dict)
    """Half-widths in the units of the quantities, by pantograph (0: the line) and name."""


@dataclass(frozen=True)
class Uncertainty:
    """Uncertainty of all values of a case."""

    components: Mapping[ComponentName, Component] = field(default_factory=dict)
    """Components; those without half-widths included."""
    values: ValuesByOwner = field(default_factory=dict)
    """Values of the record, which its sampling rate and resolution may change."""
    sample: JointSample = field(default_factory=dict)
    """Joint sample; empty: none was drawn."""

    def list_components(self, owner: int, quantity: str) -> dict[ComponentName, Value]:
        """Half-widths of a quantity by component; an unknown component is left out."""
        parts = ((name, part.half_widths.get(owner, {}).get(quantity)) for name, part in self.components.items())
        return {name: half_width for name, half_width in parts if half_width is not None and _is_finite(half_width)}

    def select(self, names: Collection[ComponentName]) -> "Uncertainty":
        """Uncertainty with some of the components only."""
        return Uncertainty({name: part for name, part in self.components.items() if name in names}, self.values)

    @property
    def unknown_components(self) -> tuple[ComponentName, ...]:
        """Components that are not known, without those that do not apply."""
        return tuple(name for name, part in self.components.items() if part.basis.startswith(UNKNOWN_BASIS))

    def list_unknown(self, owner: int, quantity: str) -> tuple[ComponentName, ...]:
        """Components that are not known for a quantity: of all, or one of the record that only others have."""
        if quantity not in self.values.get(owner, {}):
            return self.unknown_components
        known = self.list_components(owner, quantity)
        lacking = [name for name in BOUNDED_COMPONENTS if name in self.components and name not in known]
        return (*self.unknown_components, *lacking)

    @property
    def basis(self) -> dict[ComponentName, str]:
        """How each component was determined, or why it is not known."""
        return {name: part.basis for name, part in self.components.items()}

    @property
    def by_quantity(self) -> dict[int, dict[str, dict[ComponentName, Value]]]:
        """Half-widths by pantograph, quantity and component, for all quantities with a component."""
        found: dict[int, dict[str, None]] = {}
        for part in self.components.values():
            for owner, quantities in part.half_widths.items():
                found.setdefault(owner, {}).update(dict.fromkeys(quantities))
        listed = {
            owner: {name: self.list_components(owner, name) for name in quantities}
            for owner, quantities in sorted(found.items())
        }
        return {owner: {name: parts for name, parts in part.items() if parts} for owner, part in listed.items()}

    @property
    def combined(self) -> dict[int, dict[str, Value]]:
        """Half-widths of the 95 % intervals by pantograph and quantity."""
        return {
            owner: {name: self.combine(owner, name) for name in quantities}
            for owner, quantities in self.by_quantity.items()
        }

    def combine(self, owner: int, quantity: str) -> Value:
        """Half-width of the 95 % interval of a quantity; that of its components where no sample was drawn."""
        value, draws = self.values.get(owner, {}).get(quantity), self.sample.get(owner, {}).get(quantity, ())
        if draws and isinstance(value, float | int):
            return interval_half_width(value, draws)
        # Without a sample, mesh and time step are the only component.
        return map_items(math.hypot, *self.list_components(owner, quantity).values())


def _is_finite(value: Value) -> bool:
    return all(map(math.isfinite, value if isinstance(value, tuple) else (value,)))


def map_items(function: Callable[..., float], *values: Value) -> Value:
    """Apply a function to numbers, or item by item to tuples of equal length.

    Raises:
        ValueError: The values have different numbers of items.
    """
    if all(isinstance(value, float | int) for value in values):
        return function(*values)
    rows = [value if isinstance(value, tuple) else (value,) for value in values]
    return tuple(function(*items) for items in zip(*rows, strict=True))


# Joint sample of the quantities of a case: their possible values, with the correlation between them.
#
# A draw takes one of the runs and sections that were evaluated. It adds a deviation by the length of the record, one by
# mesh and time step, one by sampling rate and resolution, and one by each direction of the tolerances of the line. All
# quantities share the draw. The sample gives the interval of a value, and the probability that one value, or all values
# of a case, lie inside their limits (JCGM 101).
DRAWS = 1000
"""Number of draws: a probability of 0.5 is known within 3 %, one of 0.95 within 1.4 %."""

DRAW_DIGITS = 6
"""Significant digits of a draw in results.json."""


@dataclass(frozen=True)
class SampleParts:
    """Parts of a joint sample; quantities by pantograph (0: the line) and name."""

    values: ValuesByOwner
    """Values of the run."""
    members: Sequence[ValuesByOwner] = ()
    """Values of the other starts and sections, each as likely as the run itself."""
    deviations: Mapping[int, Mapping[str, RealArray]] = field(default_factory=dict)
    """Deviations by the length of the record, (DRAWS,)."""
    mesh_changes: Mapping[int, Mapping[str, float]] = field(default_factory=dict)
    """Half-widths by mesh and time step, with the sign of the change to the finer mesh."""
    bounds: Mapping[int, Mapping[str, float]] = field(default_factory=dict)
    """Largest changes by sampling rate and resolution."""
    line_changes: Sequence[Mapping[int, Mapping[str, float]]] = ()
    """Changes by one standard deviation of the line along each principal direction of its tolerances."""


def draw_sample(parts: SampleParts, digest: str) -> JointSample:
    """Draw the joint sample of all quantities with one value.

    The members are a few of all possible ones: their distance from their mean is widened as that of a further
    member of a normal population, by sqrt((n + 1) / (n - 1)). Where a member lacks a quantity, the value of the run
    stands for it.

    Args:
        parts: Parts of the sample; a quantity with mesh and time step alone has no draws.
        digest: SHA-256 in hexadecimal, the seed of the random numbers.
    """
    random = np.random.default_rng(int(digest[:16], 16))
    member = random.integers(0, len(parts.members) + 1, DRAWS)
    mesh = random.standard_normal(DRAWS) / QUANTILE_95
    bound = random.uniform(-1.0, 1.0, DRAWS)
    line = random.standard_normal((len(parts.line_changes), DRAWS))
    scatter = (parts.deviations, parts.bounds, *parts.members, *parts.line_changes)
    sample: dict[int, dict[str, tuple[float, ...]]] = {}
    for owner, quantities in parts.values.items():
        for name, value in quantities.items():
            if isinstance(value, tuple) or not np.isfinite(value):
                continue
            draws = _widen_members(value, [part.get(owner, {}).get(name) for part in parts.members])[member]
            scaled = [(1.0, parts.deviations), (mesh, parts.mesh_changes), (bound, parts.bounds)]
            for factor, changes in (*scaled, *zip(line, parts.line_changes, strict=True)):
                draws = draws + factor * changes.get(owner, {}).get(name, 0.0)
            if np.ptp(draws) > 0 and any(name in part.get(owner, {}) for part in scatter):
                sample.setdefault(owner, {})[name] = tuple(round_digits(draws, DRAW_DIGITS))
    return sample


def _widen_members(value: float, others: Sequence[object]) -> RealArray:
    """Values of the run and of the members, widened about their mean."""
    numbers = np.array([value, *(other if isinstance(other, float | int) else value for other in others)])
    if numbers.size == 1:
        return numbers
    return np.asarray(numbers.mean() + np.sqrt((numbers.size + 1) / (numbers.size - 1)) * (numbers - numbers.mean()))

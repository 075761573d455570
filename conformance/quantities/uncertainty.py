"""Uncertainty of values: half-widths by component, and the interval that holds 95 % of their joint sample.

A component that cannot be determined is named with the reason; it is not zero.
"""

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

from pantocheck.conformance.core.criterion import ComponentName
from pantocheck.conformance.core.near_limit import BOUNDED_COMPONENTS, interval_half_width
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

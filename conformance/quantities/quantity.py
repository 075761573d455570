"""Quantity: definition of a number that can be graded."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import ForceSignals
from pantocheck.conformance.quantities.statistics import Sampling

QuantityTable = Literal["damping models"]
"""Tables with a fixed set of quantities: the study of damping sensitivity."""

Scope = Literal["pantograph", "line", "static", "mass_drop", "study"]
"""Object of a value: a pantograph, the line in a run, the line at rest, identified modes, or a set of runs."""


Signals = TypeVar("Signals")


def _accept(_: object) -> None:
    """Accept a quantity that is delivered as a number."""


@dataclass(frozen=True)
class Need(Generic[Signals]):
    """Part of a record that a quantity needs."""

    text: str
    """Name of the part."""
    check: Callable[[Signals], object] = _accept
    """Function of the signals that raises `QuantityUnavailable` if they lack the part. The default never raises, for
    a quantity that is delivered as a number.
    """


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """A number that can be graded."""

    name: str
    """Name in case files and results, with the unit at its end."""
    label: str
    """Name on pages."""
    unit: str
    """Unit as printed; empty for a ratio."""
    definition: str
    """Definition in one sentence."""
    needs: Need[Any]
    """Part of a record, or result of a static check, without which the quantity is not computed."""
    scope: Scope
    """Object or computation that the value belongs to."""
    source: str = "pantocheck"
    """Document that defines the quantity."""
    never_negative: bool = False
    """Whether a negative value is impossible."""
    tables: tuple[QuantityTable, ...] = ()
    """Fixed tables that show the quantity."""
    highest_Hz: float | None = None
    """Highest frequency of the force in the value [Hz]; None: the value has no band."""
    other_definition: str = ""
    """Other definition in use, and the largest change of the value by it on the EN 50318:2002 cases; empty: none."""


@dataclass(frozen=True, kw_only=True)
class PantographQuantity(Quantity):
    """A statistic of the signals of one pantograph."""

    needs: Need[ForceSignals]
    compute: Callable[[ForceSignals, Sampling], RealArray]
    """Function of the signals and of a `Sampling`. The same function gives the value of the record and the values of
    selections of its spans, from which the uncertainty follows.
    """
    extreme: Literal["", "largest", "smallest"] = ""
    """Side of the extreme value that the quantity is; empty: no extreme value."""
    scope: Literal["pantograph"] = "pantograph"


@dataclass(frozen=True, kw_only=True)
class LineQuantity(Quantity):
    """A quantity computed from the uplift at the supports."""

    needs: Need[LineSignals]
    compute: Callable[[LineSignals], float]
    """Function of the signals of the line."""
    support_values: Callable[[LineSignals], RealArray]
    """Values at the supports, (k,); the quantity is the largest."""
    scope: Literal["line"] = "line"

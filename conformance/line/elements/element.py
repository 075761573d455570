"""Element of a line: base class of the declarations in this folder.

An element is a class. Its fields are keys of the line file. Its methods do the work of the element wherever the suite
uses a line: each of them has a default for elements that do nothing there. `element_registry.ELEMENTS` lists all
elements, and a new one needs no change outside this folder.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from types import GenericAlias
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeVar, cast

from pydantic import BaseModel, Discriminator, Field
from pydantic_core import PydanticCustomError

from pantocheck.conformance.core.figure_data import DrawnSymbol
from pantocheck.conformance.core.sourced_table import InputTable, Problems, is_absent, validation_problem
from pantocheck.conformance.line.elements.line_layout import LineLayout, SpanPositions
from pantocheck.model import Catenary, Kind, Wire

if TYPE_CHECKING:
    from pantocheck.model import DiscretisedLine

MOST_LINE_PARTS = 1000
"""Largest number of changes of a wire, and of parts at single positions."""

DerivedKeys = dict[str, tuple[Any, Any]]
"""Type and default of every key of the derived values, by name; the default ... marks a required key."""

KINDS: dict[str, Kind] = {"contact_wire": Kind.CONTACT_WIRE, "messenger_wire": Kind.MESSENGER_WIRE}
"""Kind of wire of each table."""


class Line(Protocol):
    """Line of an element, without its elements."""

    @property
    def geometry(self) -> SpanPositions:
        """Positions of spans and supports."""

    @property
    def layout(self) -> LineLayout:
        """Spans and supports with all their values."""


@dataclass(frozen=True)
class BuiltSection:
    """Tension section of a line with its part of the finite elements."""

    limits: tuple[float, ...]
    """Positions of its anchors, and of the supports between them [m]."""
    line: "DiscretisedLine"
    """Finite elements of the line, with the parts of this section only in catenary and state."""

    def wires(self, kind: Kind) -> list[Wire]:
        """Wires of a kind."""
        return [wire for wire in self.line.catenary.wires if wire.kind is kind]

    def number(self, name: str) -> int:
        """Number of a wire among the parallel ones, from 1."""
        kind = self.line.catenary.wire(name).kind
        return 1 + [wire.name for wire in self.wires(kind)].index(name)


@dataclass(frozen=True)
class DrawnMark:
    """Point on a wire in a drawing."""

    symbol: DrawnSymbol
    """Symbol of the element."""
    wire: str
    """Name of the wire."""
    position: float
    """Position along the line [m]."""
    text: str = ""
    """Text beside the point; empty for the fixed points of every support and anchor."""


@dataclass(frozen=True)
class DrawnConnection:
    """Straight line between two wires in a drawing."""

    position: float
    """Position along the line [m]."""
    lower: str
    """Name of the lower wire."""
    upper: str
    """Name of the upper wire."""


def list_key(table: type[InputTable], description: str) -> tuple[Any, Any]:
    """Type and default of a key of the derived values that lists tables, and that is left out without any."""
    return GenericAlias(tuple, (table, ...)), Field((), strict=False, exclude_if=is_absent, description=description)


AnyElement = TypeVar("AnyElement", bound="Element")


class Element(InputTable):
    """Keys of a line file that describe one element, and all that the element does."""

    derived: ClassVar[DerivedKeys] = {}
    """Keys of the derived values that programs receive, see `derive`."""

    support_tables: ClassVar[tuple[str, ...]] = ()
    """Keys of tables that single supports may change: tables of `geometry.support`, and columns of the line tables."""

    symbol: ClassVar[DrawnSymbol | None] = None
    """Symbol of the points of `mark`."""

    @property
    def line(self) -> Line:
        """Line of the element: every line file is an instance of all elements."""
        return cast(Line, self)

    def part(self, element: type[AnyElement]) -> AnyElement:
        """Another element of the same line."""
        return cast(AnyElement, self)

    def add_to_section(self, catenary: Catenary, layout: LineLayout) -> Catenary:
        """Add the parts of one tension section, before its wires rise over the overlaps.

        Args:
            catenary: Section with the elements that precede this one.
            layout: Spans and supports of the section.
        """
        return catenary

    def add_to_line(self, catenary: Catenary) -> Catenary:
        """Add parts by their positions to the line of all sections."""
        return catenary

    def complete_line(self, catenary: Catenary) -> Catenary:
        """Change the line with all of its parts, where the change follows from its state at rest."""
        return catenary

    def derive(self, section: BuiltSection) -> dict[str, object]:
        """Values of the keys of `derived` for one tension section."""
        return {}

    def measure(self, built: "DiscretisedLine") -> dict[str, float]:
        """Quantities of the line at rest that exist because of the element, by name."""
        return {}

    @classmethod
    def mark(cls, catenary: Catenary) -> Iterator[DrawnMark]:
        """Points of the element in a drawing."""
        return iter(())

    @staticmethod
    def connect(catenary: Catenary) -> Iterator[DrawnConnection]:
        """Lines between two wires in a drawing."""
        return iter(())


def choose_by_key(key: str, with_key: type[BaseModel], without: type[BaseModel]) -> Discriminator:
    """Choice between two forms of a table by a key that only one of them has; pydantic reports the chosen form alone.

    Args:
        key: Key of the one form.
        with_key, without: Models of both forms; each has its name as tag.
    """

    def name_form(table: object) -> str:
        if isinstance(table, dict):
            return (with_key if key in table else without).__name__
        return type(table).__name__

    return Discriminator(name_form)


def find_position_problems(
    line: Line, overlaps: Sequence[tuple[float, float]], key: str, positions: Sequence[float]
) -> Problems:
    """Problems of the key `x_m` of parts on wires: outside of the line, or in an overlap.

    Args:
        line: Line of the parts.
        overlaps: Start and end of every overlap of tension sections [m, m].
        key: Key of the list of parts.
        positions: Their positions along the track [m].

    Yields:
        One problem.
    """
    for number, x in enumerate(positions, 1):
        if not 0.0 < x < line.geometry.length:
            yield build_position_problem(f"{key}[{number}].x_m", x, line)
        for start, end in overlaps:
            if start < x < end:
                yield validation_problem(
                    f"{key}[{number}].x_m",
                    f"{x:g} m lies in the overlap from {start:g} m to {end:g} m, where two sections have wires",
                    "Give a position outside of the overlaps.",
                )


def build_position_problem(key: str, position: float, line: Line) -> PydanticCustomError:
    """Problem of a position [m] that is not on the line."""
    length = line.geometry.length
    found = f"{position:g} m is not on the line, which ends at {length:g} m"
    return validation_problem(key, found, f"Give a position between 0 and {length:g} m.")

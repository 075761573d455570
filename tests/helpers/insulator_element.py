"""Trial element: insulators at the messenger supports, with a table at single supports and a symbol of its own.

Each is a mass beside a spring between the wires: model parts that elements of the suite have, too.
"""

import sys
from collections.abc import Iterator
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Annotated, ClassVar

from pydantic import Field

from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.figure_data import DrawnSymbol
from pantocheck.conformance.core.sourced_table import SourcedTable, is_absent
from pantocheck.conformance.line.elements.element import DrawnMark, Element
from pantocheck.conformance.line.elements.wire import Wires
from pantocheck.model import Catenary, Kind, PointMass, Spring

REGISTRY = "pantocheck.conformance.line.elements.element_registry"


class InsulatorTable(SourcedTable):
    """Insulator between a messenger wire and its support."""

    mass_kg: Annotated[float, Field(gt=0, le=50, description="mass of one insulator [kg]")]


class Insulators(Element):
    """Insulators at all supports."""

    support_tables: ClassVar[tuple[str, ...]] = ("insulator",)
    symbol: ClassVar[DrawnSymbol] = DrawnSymbol(name="insulator", marker="X")

    insulator: Annotated[InsulatorTable | None, Field(exclude_if=is_absent), Feature("insulators")] = None

    def add_to_line(self, catenary: Catenary) -> Catenary:
        """Add a mass to the messenger wire at every support, and a spring of 1 kN/m below it."""
        places = [(support.limit.position, support) for support in self.line.layout.supports if self.insulator]
        (upper,), (lower,) = map(self.part(Wires).wire_names, (Kind.MESSENGER_WIRE, Kind.CONTACT_WIRE))
        masses = (
            PointMass(x, upper, support.overlay("insulator", self.insulator).mass_kg, Insulators.__name__)
            for x, support in places
        )
        springs = (Spring(x, upper, lower, 1e3, owner=Insulators.__name__) for x, _ in places)
        return replace(
            catenary,
            point_masses=(*catenary.point_masses, *masses),
            springs=(*catenary.springs, *springs),
        )

    @classmethod
    def mark(cls, catenary: Catenary) -> Iterator[DrawnMark]:
        """Insulators without a text."""
        own = (part for part in catenary.point_masses if part.owner == Insulators.__name__)
        return (DrawnMark(cls.symbol, part.wire, part.position) for part in own)


def register() -> None:
    """Register the element by one base in the source of the registry; before anything else loads the registry."""
    spec = find_spec(REGISTRY)
    assert spec is not None
    assert spec.origin is not None
    source = Path(spec.origin).read_text("utf-8").replace("class LineElements(", "class LineElements(\n    Insulators,")
    module = sys.modules[REGISTRY] = ModuleType(REGISTRY)
    exec(f"from {__name__} import Insulators\n{source}", module.__dict__)

"""Springs between messenger and contact wire, such as stiff electrical connections."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, ClassVar

from pydantic import Field

from pantocheck.conformance.core.features import NO_FEATURE, Feature
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    Problems,
    SourcedTable,
    cross_check,
    is_absent,
)
from pantocheck.conformance.line.elements.derived_numbers import round_position
from pantocheck.conformance.line.elements.element import (
    MOST_LINE_PARTS,
    BuiltSection,
    DerivedKeys,
    DrawnConnection,
    Element,
    find_position_problems,
    list_key,
)
from pantocheck.conformance.line.elements.tension_section import TensionSections
from pantocheck.model import Catenary, Kind, Spring

WIRE_SPRINGS = Feature("wire_springs")


class WireSpringTable(SourcedTable):
    """Vertical spring and damper between messenger and contact wire; of parallel wires, between each pair."""

    x_m: NonNegative
    """Position along the track [m]."""
    stiffness_N_m: Annotated[float, Field(gt=0, le=1e6)]
    """Stiffness of one spring [N/m]."""
    damping_N_s_m: Annotated[float, Field(ge=0, le=1e5), WIRE_SPRINGS] = 0.0
    """Damping of one spring [N s/m]."""
    name: Annotated[str | None, Field(max_length=100), NO_FEATURE] = None
    """Name in reports."""


class DerivedWireSpring(InputTable):
    """Vertical spring and damper between a messenger and a contact wire; its force is zero at rest."""

    position_m: float
    """Position [m]."""
    contact_wire: int
    """Number of the contact wire among the parallel ones, from 1."""
    messenger_wire: int
    """Number of the messenger wire among the parallel ones, from 1."""
    stiffness_N_m: float
    """Stiffness [N/m]."""
    damping_N_s_m: float
    """Damping [N s/m]."""


class WireSprings(Element):
    """Springs between messenger and contact wire."""

    derived: ClassVar[DerivedKeys] = {
        "wire_springs": list_key(DerivedWireSpring, "springs between the wires; absent: none")
    }

    wire_spring: Annotated[
        tuple[WireSpringTable, ...], Field(strict=False, max_length=MOST_LINE_PARTS, exclude_if=is_absent), WIRE_SPRINGS
    ] = ()
    """Springs between the wires."""

    @cross_check
    def _check_wire_springs(self) -> Problems:
        overlaps, positions = self.part(TensionSections).overlaps, [spring.x_m for spring in self.wire_spring]
        yield from find_position_problems(self.line, overlaps, "wire_spring", positions)

    def add_to_line(self, catenary: Catenary) -> Catenary:
        """Add the springs between the parallel wires at each position."""
        springs = (
            Spring(table.x_m, upper, lower, table.stiffness_N_m, table.damping_N_s_m, WireSprings.__name__)
            for table in self.wire_spring
            for upper, lower in _find_pairs(catenary, table.x_m)
        )
        return replace(catenary, springs=(*catenary.springs, *springs))

    def derive(self, section: BuiltSection) -> dict[str, object]:
        """Springs with the numbers of their wires."""
        springs = (
            DerivedWireSpring(
                position_m=round_position(spring.position),
                contact_wire=section.number(spring.lower),
                messenger_wire=section.number(spring.upper),
                stiffness_N_m=spring.stiffness,
                damping_N_s_m=spring.damping,
            )
            for spring in section.line.catenary.springs
            if spring.owner == WireSprings.__name__
        )
        return {"wire_springs": tuple(springs)}

    @staticmethod
    def connect(catenary: Catenary) -> Iterator[DrawnConnection]:
        """Lines of the springs, drawn as those of droppers."""
        own = (part for part in catenary.springs if part.owner == WireSprings.__name__)
        return (DrawnConnection(part.position, part.lower, part.upper) for part in own)


def _find_pairs(catenary: Catenary, position: float) -> Iterator[tuple[str, str]]:
    """Names of the messenger and the contact wire of each parallel pair at a position [m]."""
    contact, messenger = (
        [wire.name for wire in catenary.wires if wire.kind is kind and wire.start < position < wire.end]
        for kind in (Kind.CONTACT_WIRE, Kind.MESSENGER_WIRE)
    )
    for i, lower in enumerate(contact):
        yield messenger[min(i, len(messenger) - 1)], lower

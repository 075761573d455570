"""Point masses on the wires, such as section insulators and clamps."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from pantocheck.conformance.core.features import NO_FEATURE, Feature
from pantocheck.conformance.core.figure_data import DrawnSymbol
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    Problems,
    SourcedTable,
    cross_check,
    is_absent,
)
from pantocheck.conformance.line.elements.derived_numbers import MassCoefficient, round_number, round_position
from pantocheck.conformance.line.elements.element import (
    KINDS,
    MOST_LINE_PARTS,
    BuiltSection,
    DerivedKeys,
    DrawnMark,
    Element,
    find_position_problems,
    list_key,
)
from pantocheck.conformance.line.elements.tension_section import TensionSections
from pantocheck.model import Catenary, Kind, PointMass


class PointMassTable(SourcedTable):
    """Mass on a wire, such as a section insulator or a clamp; on parallel wires, on each of them."""

    x_m: NonNegative
    """Position along the track [m]."""
    wire: Literal["contact_wire", "messenger_wire"]
    """Wire that carries the mass."""
    mass_kg: Annotated[float, Field(gt=0, le=200)]
    """Mass on one wire [kg]."""
    name: Annotated[str | None, Field(max_length=100), NO_FEATURE] = None
    """Name in reports."""


class DerivedPointMass(InputTable):
    """Mass on a wire; it hangs on the wire at rest, and moves with it in both directions."""

    position_m: float
    """Position [m]."""
    wire: Literal["contact_wire", "messenger_wire"]
    """Kind of wire."""
    number: int
    """Number of the wire among the parallel ones, from 1."""
    mass_kg: float
    """Mass [kg]."""
    mass_coefficient_1_s: MassCoefficient


class PointMasses(Element):
    """Masses on the wires."""

    derived: ClassVar[DerivedKeys] = {"point_masses": list_key(DerivedPointMass, "masses on the wires; absent: none")}
    symbol: ClassVar[DrawnSymbol] = DrawnSymbol(name="mass", marker="v")

    point_mass: Annotated[
        tuple[PointMassTable, ...],
        Field(strict=False, max_length=MOST_LINE_PARTS, exclude_if=is_absent),
        Feature("point_masses"),
    ] = ()
    """Masses on the wires."""

    @cross_check
    def _check_point_masses(self) -> Problems:
        overlaps, positions = self.part(TensionSections).overlaps, [mass.x_m for mass in self.point_mass]
        yield from find_position_problems(self.line, overlaps, "point_mass", positions)

    def add_to_line(self, catenary: Catenary) -> Catenary:
        """Add the masses, each to every parallel wire."""
        masses = (
            PointMass(mass.x_m, wire.name, mass.mass_kg, PointMasses.__name__)
            for mass in self.point_mass
            for wire in catenary.wires
            if wire.kind is KINDS[mass.wire] and wire.start < mass.x_m < wire.end
        )
        return replace(catenary, point_masses=(*catenary.point_masses, *masses))

    def derive(self, section: BuiltSection) -> dict[str, object]:
        """Masses with the numbers of their wires."""
        catenary = section.line.catenary
        masses = (
            DerivedPointMass(
                position_m=round_position(mass.position),
                wire="contact_wire" if kind is Kind.CONTACT_WIRE else "messenger_wire",
                number=section.number(mass.wire),
                mass_kg=round_number(mass.mass),
                mass_coefficient_1_s=catenary.rayleigh(kind).mass_coefficient,
            )
            for mass in catenary.point_masses
            if mass.owner == PointMasses.__name__
            for kind in [catenary.wire(mass.wire).kind]
        )
        return {"point_masses": tuple(masses)}

    @classmethod
    def mark(cls, catenary: Catenary) -> Iterator[DrawnMark]:
        """Masses with their sizes."""
        own = (part for part in catenary.point_masses if part.owner == PointMasses.__name__)
        return (DrawnMark(cls.symbol, part.wire, part.position, f"{part.mass:g} kg") for part in own)

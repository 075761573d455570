"""Stitch wires, which carry the droppers nearest to a support."""

from dataclasses import replace
from typing import Annotated, ClassVar, Literal

from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    Positive,
    Problems,
    SourcedTable,
    cross_check,
    validation_problem,
)
from pantocheck.conformance.line.elements.derived_numbers import MassCoefficient, Numbers, round_number, round_positions
from pantocheck.conformance.line.elements.element import BuiltSection, DerivedKeys, Element
from pantocheck.conformance.line.elements.line_layout import LineLayout
from pantocheck.conformance.line.elements.steady_arm import ClampMass
from pantocheck.conformance.line.elements.wire import BendingStiffness, MassPerLength, Tension
from pantocheck.model import Catenary, Clamp, Kind, TensionChange, Wire, wave_speed

STITCH_WIRE = Feature("stitch_wire")


class StitchWireTable(SourcedTable):
    """Stitch wire, clamped to the messenger wire on both sides of a support; it carries the nearest droppers."""

    length_m: Positive
    """Distance between its clamps, symmetric to the support [m]."""
    tension_N: Tension
    mass_kg_m: MassPerLength
    bending_stiffness_N_m2: BendingStiffness = 0.0
    clamp_kg: Annotated[ClampMass, STITCH_WIRE] = 0.0


class DerivedStitchWires(InputTable):
    """Stitch wires, clamped to the messenger wires on both sides of every support."""

    start_m: Numbers
    """Position of the first clamp of every stitch wire [m]."""
    end_m: Numbers
    """Position of the second clamp of every stitch wire [m]."""
    end_condition: Literal["joined_to_messenger_without_moment"] = "joined_to_messenger_without_moment"
    """End of the wire: the displacements of the messenger wire, no bending moment."""
    wave_speed_m_s: float
    """As for the contact wire [m/s]."""
    messenger_tension_N: float
    """Tension of a messenger wire between the clamps of a stitch wire [N]."""
    clamp_mass_kg: float
    """Mass of a clamp, on the messenger wire [kg]."""
    mass_coefficient_1_s: MassCoefficient


class StitchWires(Element):
    """Stitch wires at all supports, clamped to the messenger wires."""

    derived: ClassVar[DerivedKeys] = {"stitch_wires": (DerivedStitchWires | None, ...)}

    stitch_wire: Annotated[StitchWireTable | None, STITCH_WIRE] = None

    @cross_check
    def _check_stitch_wire(self) -> Problems:
        span = self.line.geometry.shortest_span
        if self.stitch_wire is not None and self.stitch_wire.length_m >= span:
            yield validation_problem(
                "stitch_wire.length_m",
                f"{self.stitch_wire.length_m:g} m is not shorter than the span of {span:g} m",
                "Give a length below that of a span; neighbouring stitch wires must not overlap.",
            )

    def add_to_section(self, catenary: Catenary, layout: LineLayout) -> Catenary:
        """Add the wires and their clamps; messenger and stitch wire share the tension between the clamps."""
        table = self.stitch_wire
        if table is None:
            return catenary
        half, section = table.length_m / 2, (table.tension_N, table.mass_kg_m, table.bending_stiffness_N_m2)
        masts = [(support.limit.number, support.limit.position) for support in layout.supports]
        stitched = [
            (
                wire.name,
                Wire(f"stitch wire of {wire.name} at support {i}", Kind.STITCH_WIRE, x - half, x + half, *section),
            )
            for wire in catenary.wires
            if wire.kind is Kind.MESSENGER_WIRE
            for i, x in masts
        ]
        changes = tuple(TensionChange(x - half, x + half, -table.tension_N) for _, x in masts)
        wires = (
            replace(wire, tension_changes=changes) if wire.kind is Kind.MESSENGER_WIRE else wire
            for wire in catenary.wires
        )
        clamps = (
            Clamp(end, messenger, wire.name, table.clamp_kg)
            for messenger, wire in stitched
            for end in (wire.start, wire.end)
        )
        return replace(catenary, wires=(*wires, *(wire for _, wire in stitched)), clamps=(*catenary.clamps, *clamps))

    def derive(self, section: BuiltSection) -> dict[str, object]:
        """Clamps of every stitch wire."""
        wires, catenary = section.wires(Kind.STITCH_WIRE), section.line.catenary
        if not wires:
            return {"stitch_wires": None}
        messenger = section.wires(Kind.MESSENGER_WIRE)[0]
        derived = DerivedStitchWires(
            start_m=round_positions(wire.start for wire in wires),
            end_m=round_positions(wire.end for wire in wires),
            wave_speed_m_s=round_number(wave_speed(wires[0].tension, wires[0].mass_per_length)),
            messenger_tension_N=messenger.tension + messenger.tension_changes[0].change,
            clamp_mass_kg=catenary.clamps[0].mass,
            mass_coefficient_1_s=catenary.rayleigh(Kind.DROPPER).mass_coefficient,
        )
        return {"stitch_wires": derived}

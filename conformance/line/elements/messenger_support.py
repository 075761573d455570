"""Supports of the messenger wire."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.figure_data import DrawnSymbol
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    Positive,
    Problems,
    SourcedTable,
    cross_check,
    validation_problem,
)
from pantocheck.conformance.line.elements.curve import TrackCurves
from pantocheck.conformance.line.elements.derived_numbers import BySupport, Numbers, join_equal, round_positions
from pantocheck.conformance.line.elements.element import BuiltSection, DerivedKeys, DrawnMark, Element
from pantocheck.conformance.line.elements.line_layout import LineLayout, SupportLayout
from pantocheck.conformance.line.elements.wire import Wires
from pantocheck.model import Catenary, Kind, MessengerSupport


class MessengerSupportTable(SourcedTable):
    """Support of the messenger wire: a vertical spring and damper."""

    stiffness_N_m: Annotated[Positive, Field(le=1e10)]
    """Vertical stiffness [N/m]."""
    damping_N_s_m: Annotated[NonNegative, Feature("support_dampers")] = 0.0
    """Vertical damper [N s/m]."""
    along_track: Annotated[Literal["free", "fixed"], Feature("messenger_wire_held_along_track")] = "free"
    """Motion of the messenger wire along the track at the supports; free: its tension is constant; fixed: its
    tension changes with its elongation between two supports.
    """


class DerivedMessengerSupports(InputTable):
    """Supports of the messenger wires: springs and dampers to the ground, whose force is zero at rest."""

    position_m: Numbers
    """Position [m]."""
    height_m: BySupport
    """Height of the messenger wire at rest [m]."""
    vertical_stiffness_N_m: BySupport
    """Vertical spring [N/m]."""
    lateral_stiffness_N_m: BySupport | None
    """Lateral spring [N/m]; null: vertical plane only."""
    vertical_damper_N_s_m: BySupport
    """Vertical damper [N s/m]."""
    lateral_damper_N_s_m: BySupport | None
    """Lateral damper [N s/m]; null: vertical plane only."""
    held_along_track: bool | tuple[bool, ...]
    """Whether a support holds the wire along the track, so that its tension is not constant."""
    mass_kg: float = 0.0
    """Moving mass of a support [kg]."""


class MessengerSupports(Element):
    """Supports of the messenger wires at all supports of the line."""

    derived: ClassVar[DerivedKeys] = {"messenger_supports": (DerivedMessengerSupports, ...)}
    support_tables: ClassVar[tuple[str, ...]] = ("messenger_support",)
    symbol: ClassVar[DrawnSymbol] = DrawnSymbol(name="messenger support", marker="^")

    messenger_support: MessengerSupportTable

    def messenger_support_at(self, support: SupportLayout) -> MessengerSupportTable:
        """Messenger support with the values of one support."""
        return support.overlay("messenger_support", self.messenger_support)

    @property
    def supports_fixed_along_track(self) -> tuple[int, ...]:
        """Numbers of the supports that hold the messenger wire along the track."""
        supports = self.line.layout.supports
        return tuple(s.limit.number for s in supports if self.messenger_support_at(s).along_track == "fixed")

    @cross_check
    def _check_curved_track(self) -> Problems:
        if self.part(TrackCurves).curves and self.supports_fixed_along_track:
            yield validation_problem(
                "messenger_support.along_track",
                "'fixed' is not possible on a track with curves",
                "Set along_track = 'free', or leave out the curves.",
            )

    @cross_check
    def _check_axial_stiffness(self) -> Problems:
        holding = self.supports_fixed_along_track
        if holding and self.part(Wires).messenger_wire.axial_stiffness_EA_N is None:
            yield validation_problem(
                "messenger_wire.axial_stiffness_EA_N",
                f"support {holding[0]} holds the messenger wire along the track, but its axial stiffness is not given",
                "Give messenger_wire.axial_stiffness_EA_N, or set messenger_support.along_track = 'free'.",
            )

    def add_to_section(self, catenary: Catenary, layout: LineLayout) -> Catenary:
        """Add a support to every messenger wire at every support of the line."""
        supports = (
            MessengerSupport(
                support.limit.position,
                messenger,
                support.limit.messenger_wire_height,
                table.stiffness_N_m,
                table.damping_N_s_m,
                table.along_track,
            )
            for support in layout.supports
            for table in [self.messenger_support_at(support)]
            for messenger in self.part(Wires).wire_names(Kind.MESSENGER_WIRE)
        )
        return replace(catenary, messenger_supports=tuple(supports))

    def derive(self, section: BuiltSection) -> dict[str, object]:
        """Supports of the first messenger wire; those of the others are equal."""
        first, lateral = section.wires(Kind.MESSENGER_WIRE)[0].name, section.line.catenary.has_lateral_field
        supports = [support for support in section.line.catenary.messenger_supports if support.wire == first]
        stiffness = join_equal(support.stiffness for support in supports)
        damper = join_equal(support.damping for support in supports)
        derived = DerivedMessengerSupports(
            position_m=round_positions(support.position for support in supports),
            height_m=join_equal(support.height for support in supports),
            vertical_stiffness_N_m=stiffness,
            lateral_stiffness_N_m=stiffness if lateral else None,
            vertical_damper_N_s_m=damper,
            lateral_damper_N_s_m=damper if lateral else None,
            held_along_track=join_equal(support.along_track == "fixed" for support in supports),
        )
        return {"messenger_supports": derived}

    @classmethod
    def mark(cls, catenary: Catenary) -> Iterator[DrawnMark]:
        """Points of the supports on the messenger wires."""
        return (DrawnMark(cls.symbol, part.wire, part.position) for part in catenary.messenger_supports)

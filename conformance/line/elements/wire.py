"""Contact and messenger wires, and their changes along the line."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby, pairwise
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from pantocheck.conformance.core.features import NO_FEATURE, Feature
from pantocheck.conformance.core.figure_data import DrawnSymbol
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    Positive,
    Problems,
    SourcedTable,
    cross_check,
    is_absent,
    validation_problem,
)
from pantocheck.conformance.line.elements.curve import TrackCurves
from pantocheck.conformance.line.elements.derived_numbers import (
    Numbers,
    round_number,
    round_numbers,
    round_position,
    round_positions,
)
from pantocheck.conformance.line.elements.element import (
    MOST_LINE_PARTS,
    BuiltSection,
    DerivedKeys,
    DrawnMark,
    Element,
    build_position_problem,
)
from pantocheck.conformance.line.elements.line_layout import LineLayout, SpanLimit
from pantocheck.conformance.line.elements.wire_irregularity import (
    DerivedIrregularWire,
    IrregularWire,
    derive_irregularity,
)
from pantocheck.model import Catenary, Kind, SectionChange, TensionChange, Wire, wave_speed

Tension = Annotated[float, Field(ge=500, le=200e3, description="axial tension of one wire [N]")]
MassPerLength = Annotated[float, Field(ge=0.02, le=10, description="mass per length of one wire [kg/m]")]
BendingStiffness = Annotated[
    float, Field(ge=0, le=1e4, description="bending stiffness EI of one wire [N m2]"), Feature("bending_stiffness")
]

WIRE_CHANGES = Feature("wire_changes")

Area = Annotated[float | None, Field(gt=0, le=1000, description="cross-section [mm2]"), NO_FEATURE]


class WireChange(InputTable):
    """Stretch of a wire with other properties; those that are not given stay as they are."""

    from_m: NonNegative
    """Start of the stretch [m]."""
    to_m: Positive
    """End of the stretch [m]."""
    tension_N: Annotated[Tension | None, WIRE_CHANGES] = None
    mass_kg_m: Annotated[MassPerLength | None, WIRE_CHANGES] = None
    bending_stiffness_N_m2: Annotated[BendingStiffness | None, WIRE_CHANGES] = None

    @cross_check
    def _check_order(self) -> Problems:
        if self.to_m <= self.from_m:
            yield validation_problem(
                "to_m", f"{self.to_m:g} m is not after from_m = {self.from_m:g} m", "Give the end of the stretch."
            )


class ContactWireChange(WireChange):
    """Stretch of a contact wire with other properties; wear reduces mass and bending stiffness."""

    wear_share: Annotated[float | None, Field(ge=0, le=0.5), WIRE_CHANGES] = None
    """Worn share of the cross-section [-]; mass and bending stiffness follow from it, unless given: the stiffness as
    that of a round bar worn flat from below.
    """

    @cross_check
    def _check_wear(self) -> Problems:
        if self.wear_share is not None and self.mass_kg_m is not None:
            yield validation_problem(
                "mass_kg_m", "the mass of the worn wire is given twice", "Give either wear_share or mass_kg_m."
            )


class WireTable(SourcedTable):
    """Contact wire or messenger wire; the values are those of one wire, also of two parallel wires."""

    number: Annotated[Literal[1, 2], Feature("twin_wires")] = 1
    """Number of parallel wires."""
    spacing_m: Annotated[float | None, Field(gt=0, le=1), Feature("twin_wires")] = None
    """Lateral distance between parallel wires [m]."""
    tension_N: Tension
    mass_kg_m: MassPerLength
    bending_stiffness_N_m2: BendingStiffness = 0.0
    area_mm2: Area = None


class ContactWireTable(IrregularWire, WireTable):
    """Contact wire; the values are those of one wire, also of two parallel wires."""

    change: Annotated[
        tuple[ContactWireChange, ...],
        Field(strict=False, max_length=MOST_LINE_PARTS, exclude_if=is_absent),
        WIRE_CHANGES,
    ] = ()
    """Worn or other stretches."""


class MessengerWireTable(WireTable):
    """Messenger wire; the values are those of one wire, also of two parallel wires."""

    axial_stiffness_EA_N: Annotated[
        float | None,
        Field(gt=0, le=1e9),
        NO_FEATURE,  # it acts with messenger_wire_held_along_track only
    ] = None
    """Axial stiffness EA; needed with messenger_support.along_track = 'fixed' [N]."""
    change: Annotated[
        tuple[WireChange, ...], Field(strict=False, max_length=MOST_LINE_PARTS, exclude_if=is_absent), WIRE_CHANGES
    ] = ()
    """Other stretches."""


class DerivedStretch(InputTable):
    """Stretch of a wire with constant properties."""

    from_m: float
    """Start [m]."""
    to_m: float
    """End [m]."""
    tension_N: float
    """Tension [N]."""
    mass_kg_m: float
    """Mass per length [kg/m]."""
    bending_stiffness_N_m2: float
    """Bending stiffness EI [N m2]."""


class DerivedWire(InputTable):
    """Contact wire or messenger wire; parallel wires differ in their lateral positions only."""

    start_m: float
    """Position of the first anchor [m]."""
    end_m: float
    """Position of the last anchor [m]."""
    end_condition: Literal["fixed_without_moment"] = "fixed_without_moment"
    """End of the wire at an anchor: no displacement from the state of rest, no bending moment."""
    wave_speed_m_s: float
    """Speed of transverse waves of low frequency, sqrt(tension / mass per length) [m/s]."""
    height_m: Numbers
    """Height at rest at every position of span_limits_m, first wire [m]."""
    lateral_position_m: Annotated[tuple[Numbers, ...] | None, Field(strict=False)]
    """Prescribed lateral position of every parallel wire at every position of span_limits_m [m]; null: motion in the
    vertical plane only.
    """
    stretches: Annotated[tuple[DerivedStretch, ...], Field(strict=False, exclude_if=is_absent)] = ()
    """Properties from end to end, in place of those of the line; absent: those of the line."""


class DerivedContactWire(DerivedIrregularWire, DerivedWire):
    """Contact wire; parallel wires differ in their lateral positions only."""


class Wires(Element):
    """Contact and messenger wires, and their changes along the line."""

    derived: ClassVar[DerivedKeys] = {
        "contact_wire": (DerivedContactWire, ...),
        "messenger_wire": (DerivedWire, ...),
    }
    symbol: ClassVar[DrawnSymbol] = DrawnSymbol(name="anchor", marker="D")

    contact_wire: ContactWireTable
    messenger_wire: MessengerWireTable

    @cross_check
    def _check_numbers_of_wires(self) -> Problems:
        if self.messenger_wire.number > self.contact_wire.number:
            yield validation_problem(
                "messenger_wire.number",
                "two messenger wires carry one contact wire",
                "Set messenger_wire.number = 1 or contact_wire.number = 2.",
            )

    @cross_check
    def _check_changes(self) -> Problems:
        for key, table in (("contact_wire", self.contact_wire), ("messenger_wire", self.messenger_wire)):
            changes = table.change
            for number, change in enumerate(changes, 1):
                if change.to_m > self.line.geometry.length:
                    yield build_position_problem(f"{key}.change[{number}].to_m", change.to_m, self.line)
            order = sorted(range(len(changes)), key=lambda n: changes[n].from_m)
            for before, after in pairwise(order):
                if changes[after].from_m < changes[before].to_m:
                    yield validation_problem(
                        f"{key}.change[{after + 1}].from_m",
                        f"{changes[after].from_m:g} m lies in the stretch that ends at {changes[before].to_m:g} m",
                        "Give stretches that do not overlap.",
                    )

    def wire_table(self, kind: Kind) -> ContactWireTable | MessengerWireTable:
        """Table of the contact or the messenger wires."""
        return self.contact_wire if kind is Kind.CONTACT_WIRE else self.messenger_wire

    def wire_names(self, kind: Kind) -> list[str]:
        """Names of the parallel contact or messenger wires of a section."""
        name, number = kind.value.replace("_", " "), self.wire_table(kind).number
        return [name] if number == 1 else [f"{name} {i + 1}" for i in range(number)]

    def add_to_section(self, catenary: Catenary, layout: LineLayout) -> Catenary:
        """Add uniform wires from anchor to anchor."""
        wires = (*self._build_wires(layout, Kind.CONTACT_WIRE), *self._build_wires(layout, Kind.MESSENGER_WIRE))
        return replace(catenary, wires=(*catenary.wires, *wires))

    def _build_wires(self, layout: LineLayout, kind: Kind) -> Iterator[Wire]:
        table = self.wire_table(kind)
        places = [_wire_place(limit, kind) for limit in layout.limits]
        for i, name in enumerate(self.wire_names(kind)):
            offset = (table.spacing_m or 0.0) * (i - (table.number - 1) / 2)
            plan = tuple((limit.position, y + offset) for limit, (y, _) in zip(layout.limits, places, strict=True))
            yield Wire(
                name,
                kind,
                layout.limits[0].position,
                layout.limits[-1].position,
                table.tension_N,
                table.mass_kg_m,
                table.bending_stiffness_N_m2,
                stagger=plan if layout.has_stagger or self.part(TrackCurves).curves else None,
                axial_stiffness=table.axial_stiffness_EA_N if isinstance(table, MessengerWireTable) else None,
                end_heights=(places[0][1], places[-1][1]),
            )

    def add_to_line(self, catenary: Catenary) -> Catenary:
        """Change the wires; in an overlap of tension sections, the wires of both."""
        changes: dict[Kind, Sequence[WireChange]] = {
            Kind.CONTACT_WIRE: self.contact_wire.change,
            Kind.MESSENGER_WIRE: self.messenger_wire.change,
        }
        return replace(catenary, wires=tuple(_change_wire(wire, changes.get(wire.kind, ())) for wire in catenary.wires))

    def derive(self, section: BuiltSection) -> dict[str, object]:
        """Heights, staggers and stretches of the first wire of each kind."""
        contact, messenger = (self._derive_wire(section, kind) for kind in (Kind.CONTACT_WIRE, Kind.MESSENGER_WIRE))
        irregularity = derive_irregularity(section.wires(Kind.CONTACT_WIRE)[0])
        return {
            "contact_wire": DerivedContactWire(**dict(contact), irregularity=irregularity),
            "messenger_wire": messenger,
        }

    def _derive_wire(self, section: BuiltSection, kind: Kind) -> DerivedWire:
        """Derived values of a contact or messenger wire."""
        line, wires = section.line, section.wires(kind)
        first, row = wires[0], line.mesh.row_of[wires[0].name, "z"]
        stations = [line.mesh.station(x) for x in section.limits]
        staggers = [wire.stagger for wire in wires if wire.stagger is not None]
        return DerivedWire(
            start_m=round_position(first.start),
            end_m=round_position(first.end),
            wave_speed_m_s=round_number(wave_speed(first.tension, first.mass_per_length)),
            height_m=round_numbers(line.state.deflection[row, stations, 0]),
            lateral_position_m=tuple(round_numbers(y for _, y in stagger) for stagger in staggers) or None,
            stretches=_derive_stretches(section, first, self.wire_table(kind)),
        )

    @classmethod
    def mark(cls, catenary: Catenary) -> Iterator[DrawnMark]:
        """Anchors at both ends of the wires."""
        for wire in catenary.wires:
            if wire.kind is not Kind.STITCH_WIRE:
                yield from (DrawnMark(cls.symbol, wire.name, end) for end in (wire.start, wire.end))


def _wire_place(limit: SpanLimit, kind: Kind) -> tuple[float, float]:
    """Lateral position and height of a contact or messenger wire at a support or end of the line [m, m]."""
    if kind is Kind.CONTACT_WIRE:
        return limit.contact_wire_stagger, limit.contact_wire_height
    return limit.messenger_wire_stagger, limit.messenger_wire_height


def _change_wire(wire: Wire, changes: Sequence[WireChange]) -> Wire:
    """Wire with its stretches of other properties."""
    sections, tensions = list(wire.section_changes), list(wire.tension_changes)
    for change in changes:
        start, end = max(change.from_m, wire.start), min(change.to_m, wire.end)
        if start >= end:
            continue  # on another tension section, or beyond the end of a shortened line
        mass, stiffness = _mass_and_stiffness(wire, change)
        if (mass, stiffness) != (wire.mass_per_length, wire.bending_stiffness):
            added = (mass - wire.mass_per_length, stiffness - wire.bending_stiffness)
            sections.append(SectionChange(start, end, *added))
        if change.tension_N is not None:
            tensions.append(TensionChange(start, end, change.tension_N - wire.tension))
    return replace(wire, section_changes=tuple(sections), tension_changes=tuple(tensions))


def _mass_and_stiffness(wire: Wire, change: WireChange) -> tuple[float, float]:
    """Mass per length and bending stiffness of a stretch [kg/m, N m2]."""
    from pantocheck.model.description.worn_wire import worn_stiffness_share  # loads scipy.optimize

    mass, stiffness = wire.mass_per_length, wire.bending_stiffness
    if isinstance(change, ContactWireChange) and change.wear_share is not None:
        mass *= 1 - change.wear_share
        stiffness *= worn_stiffness_share(change.wear_share)
    return (
        mass if change.mass_kg_m is None else change.mass_kg_m,
        stiffness if change.bending_stiffness_N_m2 is None else change.bending_stiffness_N_m2,
    )


def _derive_stretches(
    section: BuiltSection, wire: Wire, table: ContactWireTable | MessengerWireTable
) -> tuple[DerivedStretch, ...]:
    """Properties of a contact or messenger wire from end to end, if they are not those of its table."""
    line = section.line
    if not table.change and wire.tension == table.tension_N:
        return ()
    row, limits, beams = line.mesh.row_of[wire.name, "z"], line.mesh.position, line.beams
    inside = [e for e in range(limits.size - 1) if wire.start <= limits[e] < wire.end and beams.mass_per_length[row, e]]
    arrays = (beams.tension, beams.mass_per_length, beams.bending_stiffness)
    stretches = []
    for properties, group in groupby(inside, lambda e: tuple(float(array[row, e]) for array in arrays)):
        elements = list(group)
        start, end = round_positions(limits[[elements[0], elements[-1] + 1]])
        tension, mass, stiffness = round_numbers(properties)
        stretches.append(
            DerivedStretch(from_m=start, to_m=end, tension_N=tension, mass_kg_m=mass, bending_stiffness_N_m2=stiffness)
        )
    return tuple(stretches)

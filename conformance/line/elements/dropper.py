"""Droppers: their schedule in every span, and their properties."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import accumulate
from typing import Annotated, ClassVar, TypeVar

import numpy as np
from pydantic import Field

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    Problems,
    SourcedTable,
    cross_check,
    validation_problem,
)
from pantocheck.conformance.line.elements.derived_numbers import (
    BySpan,
    MassCoefficient,
    StiffnessCoefficient,
    round_numbers,
    round_positions,
)
from pantocheck.conformance.line.elements.dropper_schedule import DropperSchedule
from pantocheck.conformance.line.elements.element import BuiltSection, DerivedKeys, DrawnConnection, Element
from pantocheck.conformance.line.elements.line_layout import LineLayout
from pantocheck.conformance.line.elements.steady_arm import ClampMass
from pantocheck.conformance.line.elements.wire import Wires
from pantocheck.model import Catenary, Dropper, Kind

Entry = TypeVar("Entry")

COARSE = 5.0
"""Element length for the dropper lengths from which the dropper masses follow [m]."""

DROPPERS = Feature("droppers")
DROPPER_MASS = Feature("dropper_mass", bool)


class DropperTable(DropperSchedule, SourcedTable):
    """Droppers: bars that carry tension, but no compression; their schedule holds for spans without another one."""

    stiffness_N_m: Annotated[float | None, Field(gt=0), DROPPERS] = None
    """Stiffness of a taut dropper [N/m]."""
    axial_stiffness_EA_N: Annotated[float | None, Field(gt=0), DROPPERS] = None
    """Axial stiffness EA of a dropper, for a stiffness of EA / length [N]."""
    mass_kg: Annotated[float | None, Field(ge=0, le=20), DROPPER_MASS] = None
    """Mass of a dropper [kg]."""
    mass_kg_m: Annotated[float | None, Field(ge=0, le=20), DROPPER_MASS] = None
    """Mass per length of a dropper [kg/m]."""
    clamp_on_messenger_kg: Annotated[ClampMass, DROPPER_MASS] = 0.0
    clamp_on_contact_kg: Annotated[ClampMass, DROPPER_MASS] = 0.0

    @cross_check
    def _check_stiffness(self) -> Problems:
        if (self.stiffness_N_m is None) == (self.axial_stiffness_EA_N is None):
            yield validation_problem(
                "stiffness_N_m",
                f"the stiffness of the droppers is {'missing' if self.stiffness_N_m is None else 'given twice'}",
                "Give either stiffness_N_m or axial_stiffness_EA_N.",
            )

    @cross_check
    def _check_mass(self) -> Problems:
        if self.mass_kg is not None and self.mass_kg_m is not None:
            yield validation_problem(
                "mass_kg", "the mass of the droppers is given twice", "Give either mass_kg or mass_kg_m."
            )

    @property
    def schedule(self) -> DropperSchedule:
        """Schedule of the spans that name no other."""
        return DropperSchedule.model_construct(**{key: getattr(self, key) for key in DropperSchedule.model_fields})


class DerivedDroppers(InputTable):
    """Droppers at rest. A taut dropper is a spring and a damper along its direction at rest.

    Its tension is max(0, tension + stiffness elongation + damping elongation rate). Across its direction it is a spring
    without damping, taut or slack.
    """

    position_m: BySpan
    """Position [m]."""
    contact_wire: Annotated[tuple[Annotated[tuple[int, ...], Field(strict=False)], ...], Field(strict=False)]
    """Number of the contact wire, from 1."""
    on_stitch_wire: Annotated[tuple[tuple[bool, ...], ...], Field(strict=False)]
    """true: the upper end is on a stitch wire; false: on the messenger wire."""
    contact_wire_height_m: BySpan
    """Prescribed height of the contact wire at rest [m]: the straight line between supports, less the pre-sag."""
    length_m: BySpan
    """Length at rest, between the axes of the wires [m]."""
    height_m: BySpan
    """Vertical part of the length [m]."""
    width_m: BySpan
    """Lateral part of the length, upper minus lower end [m]."""
    vertical_force_N: BySpan
    """Vertical force at rest, at mid-length of the dropper; tension = force length / height [N]."""
    stiffness_N_m: BySpan
    """Stiffness of a taut dropper [N/m]."""
    transverse_stiffness_N_m: BySpan | None
    """Stiffness across the dropper: tension / length [N/m]; null: vertical plane only."""
    mass_kg: BySpan
    """Mass of a dropper without clamps, half of it at each end [kg]."""
    upper_clamp_kg: float
    """Mass of the clamp at the upper end [kg]."""
    lower_clamp_kg: float
    """Mass of the clamp at the lower end [kg]."""
    mass_coefficient_1_s: MassCoefficient
    stiffness_coefficient_s: StiffnessCoefficient


class Droppers(Element):
    """Droppers of all spans."""

    derived: ClassVar[DerivedKeys] = {"droppers": (DerivedDroppers, ...)}

    droppers: DropperTable

    @property
    def dropper_schedules(self) -> tuple[DropperSchedule, ...]:
        """Dropper schedule of every span."""
        return self.line.geometry.choose_schedules(self.droppers.schedule)

    @cross_check
    def _droppers_lie_in_their_spans(self) -> Problems:
        geometry = self.line.geometry
        spans = enumerate(zip(geometry.span_lengths, self.dropper_schedules, strict=True), 1)
        # Spans of one length with one schedule have the same problems.
        schedules = {(geometry.schedule_key(number), span): schedule for number, (span, schedule) in spans}
        for (key, span), schedule in schedules.items():
            for i, x in enumerate(schedule.x_m, 1):
                if x >= span:
                    yield validation_problem(
                        f"{key}.x_m[{i}]",
                        f"{x:g} m is not inside the span of {span:g} m",
                        f"Give positions between 0 and {span:g} m, from the start of the span.",
                    )

    def add_to_section(self, catenary: Catenary, layout: LineLayout) -> Catenary:
        """Add the droppers of every span; those within a stitch wire hang on it."""
        droppers = [
            dropper
            for span in layout.spans
            for place in zip(span.dropper_position.tolist(), span.contact_wire_height.tolist(), strict=True)
            for dropper in self._build_droppers(catenary, *place)
        ]
        return replace(catenary, droppers=(*catenary.droppers, *droppers))

    def _build_droppers(self, catenary: Catenary, position: float, height: float) -> Iterator[Dropper]:
        """Droppers of all parallel wires at a position with a height of the contact wire [m]."""
        table, wires = self.droppers, self.part(Wires)
        messengers = wires.wire_names(Kind.MESSENGER_WIRE)
        stitched = {
            clamp.upper: clamp.lower
            for clamp in catenary.clamps
            if (wire := catenary.wire(clamp.lower)).start < position < wire.end
        }
        for i, contact in enumerate(wires.wire_names(Kind.CONTACT_WIRE)):
            messenger = messengers[min(i, len(messengers) - 1)]
            yield Dropper(
                position,
                stitched.get(messenger, messenger),
                contact,
                stiffness=table.stiffness_N_m,
                axial_stiffness=table.axial_stiffness_EA_N,
                mass=table.mass_kg or 0.0,
                upper_clamp_mass=table.clamp_on_messenger_kg,
                lower_clamp_mass=table.clamp_on_contact_kg,
                contact_wire_height=height,
            )

    def complete_line(self, catenary: Catenary) -> Catenary:
        """Masses of the droppers from their lengths, if a mass per length is given."""
        from pantocheck.model import discretise  # loads the solvers, which reading a line does not need

        if not self.droppers.mass_kg_m:
            return catenary
        # The lengths depend slightly on the weights: after two passes they are accurate to 0.1 mm.
        for _ in range(2):
            masses = self.droppers.mass_kg_m * discretise(catenary, COARSE).state.dropper_length
            droppers = zip(catenary.droppers, masses, strict=True)
            catenary = replace(catenary, droppers=tuple(replace(part, mass=float(mass)) for part, mass in droppers))
        return catenary

    def derive(self, section: BuiltSection) -> dict[str, object]:
        """Droppers at rest, span by span."""
        return {"droppers": _derive_droppers(section)}

    @staticmethod
    def connect(catenary: Catenary) -> Iterator[DrawnConnection]:
        """Lines of the droppers between their wires."""
        return (DrawnConnection(part.position, part.lower, part.upper) for part in catenary.droppers)


def _derive_droppers(section: BuiltSection) -> DerivedDroppers:
    line = section.line
    catenary, state, droppers = line.catenary, line.state, line.catenary.droppers
    length, direction = state.dropper_length, state.dropper_direction
    spans, rayleigh = _count_by_span(section), catenary.rayleigh(Kind.DROPPER)
    contact = {wire.name: n for n, wire in enumerate(catenary.contact_wires, 1)}

    def by_span(values: Sequence[float] | RealArray) -> tuple[tuple[float, ...], ...]:
        return _split(round_numbers(values), spans)

    stiffness = [d.taut_stiffness(float(rest)) for d, rest in zip(droppers, length, strict=True)]
    stitched = [catenary.wire(dropper.upper).kind is Kind.STITCH_WIRE for dropper in droppers]
    return DerivedDroppers(
        position_m=_split(round_positions(dropper.position for dropper in droppers), spans),
        contact_wire=_split([contact[dropper.lower] for dropper in droppers], spans),
        on_stitch_wire=_split(stitched, spans),
        contact_wire_height_m=by_span([dropper.contact_wire_height or 0.0 for dropper in droppers]),
        length_m=by_span(length),
        height_m=by_span(length * direction[:, 1]),
        width_m=by_span(length * direction[:, 0]),
        vertical_force_N=by_span(state.dropper_tension * direction[:, 1]),
        stiffness_N_m=by_span(stiffness),
        transverse_stiffness_N_m=by_span(state.dropper_tension / length) if catenary.has_lateral_field else None,
        mass_kg=by_span([dropper.mass for dropper in droppers]),
        upper_clamp_kg=droppers[0].upper_clamp_mass,
        lower_clamp_kg=droppers[0].lower_clamp_mass,
        mass_coefficient_1_s=rayleigh.mass_coefficient,
        stiffness_coefficient_s=rayleigh.stiffness_coefficient,
    )


def _count_by_span(section: BuiltSection) -> list[int]:
    """Number of droppers of every span."""
    positions = [dropper.position for dropper in section.line.catenary.droppers]
    return [int(count) for count in np.histogram(positions, section.limits)[0]]


def _split(values: Sequence[Entry], counts: Sequence[int]) -> tuple[tuple[Entry, ...], ...]:
    """Values in consecutive parts with given numbers of entries."""
    return tuple(tuple(values[end - count : end]) for count, end in zip(counts, accumulate(counts), strict=True))

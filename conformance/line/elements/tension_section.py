"""Tension sections of a line, and the overlaps between neighbouring sections.

span limit        0          ...      19     20     21     22    ...
first section     |-------------------o------o------o------|             spans = 22
second section                        |------o------o------o-----...
                                      |<---- overlap ----->|             spans = 3

Every section has its own wires from anchor to anchor. Over the spans of an overlap two sections lie side by side: the
outgoing wires rise to their anchor, and the incoming ones descend from theirs.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field

from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.sourced_table import InputTable, Problems, cross_check, is_absent, validation_problem
from pantocheck.conformance.line.elements.element import BuiltSection, Element
from pantocheck.conformance.line.elements.line_layout import MOST_SPANS, overlay_changes
from pantocheck.conformance.line.elements.wire import BendingStiffness, MassPerLength, Tension, Wires
from pantocheck.model import Catenary, Kind
from pantocheck.model.description.catenary import Termination
from pantocheck.model.description.sections import join_sections, place_section, select_parts

if TYPE_CHECKING:
    from pantocheck.model import DiscretisedLine

SECTIONS = Feature("sections")

SectionRise = Callable[[float], float]
"""Rise of the wires of a section by position along the line [m]."""

MOST_OVERLAP_SPANS = 5
"""Largest number of spans of an overlap."""

WireEnd = Annotated[
    Literal["weight", "anchor"],
    Field(
        description="termination of the wires; weight: a tensioning weight keeps their tension; anchor: rigid, so that "
        "the tension of the messenger wire changes with its elongation up to the next holding point"
    ),
    Feature("messenger_wire_held_along_track"),
]
WireRise = Annotated[float, Field(gt=0, le=3)]


class SectionWire(InputTable):
    """Values of a wire of one section that differ from those of the line."""

    tension_N: Annotated[Tension | None, SECTIONS] = None
    mass_kg_m: Annotated[MassPerLength | None, SECTIONS] = None
    bending_stiffness_N_m2: Annotated[BendingStiffness | None, SECTIONS] = None


class SectionTable(InputTable):
    """Tension section of a line."""

    spans: Annotated[int, Field(ge=2, le=MOST_SPANS)]
    """Number of spans from anchor to anchor."""
    start: WireEnd = "weight"
    end: WireEnd = "weight"
    midpoint_anchor: Annotated[int | None, Field(ge=1, le=MOST_SPANS), Feature("messenger_wire_held_along_track")] = (
        None
    )
    """Number of the support, counted along the line, at which the messenger wire is held along the track; default:
    none.
    """

    contact_wire: Annotated[SectionWire | None, SECTIONS] = None
    """Own values of the contact wires."""
    messenger_wire: Annotated[SectionWire | None, SECTIONS] = None
    """Own values of the messenger wires."""

    @property
    def holding_points(self) -> int:
        """Number of points that hold the messenger wire along the track."""
        return [self.start, self.end].count("anchor") + (self.midpoint_anchor is not None)


class OverlapTable(InputTable):
    """Overlap of neighbouring sections; its rises hold for the wires of both."""

    spans: Annotated[int, Field(ge=1, le=MOST_OVERLAP_SPANS)]
    """Number of spans of every overlap."""
    anchor_rise_m: Annotated[WireRise | None, SECTIONS] = None
    """Rise of the wires at their anchor, for a parabola that ends at the first support behind the middle of the
    overlap [m].
    """
    support_rises_m: Annotated[
        tuple[WireRise, ...] | None, Field(strict=False, min_length=1, max_length=MOST_OVERLAP_SPANS), SECTIONS
    ] = None
    """Rises at the anchor and at the next supports, in place of a parabola; straight in between [m]."""

    @cross_check
    def _has_one_profile(self) -> Problems:
        if (self.anchor_rise_m is None) == (self.support_rises_m is None):
            yield validation_problem(
                "anchor_rise_m",
                f"the rise of the wires is {'missing' if self.anchor_rise_m is None else 'given twice'}",
                "Give either anchor_rise_m or support_rises_m.",
            )

    @cross_check
    def _rises_decrease(self) -> Problems:
        rises = self.support_rises_m or ()
        if len(rises) > self.spans:
            yield validation_problem(
                "support_rises_m",
                f"{len(rises)} rises for an overlap of {self.spans} spans",
                f"Give at most {self.spans}: at the anchor and at the next supports; at the others the rise is zero.",
            )
        if list(rises) != sorted(set(rises), reverse=True):
            yield validation_problem(
                "support_rises_m",
                "the rises do not decrease, so that the wires do not cross exactly once",
                "List the rise at the anchor first; each of the others must be smaller than the one before.",
            )

    def rise(self, distance: float, supports: Sequence[float]) -> float:
        """Rise of the wires of a section.

        Args:
            distance: Distance from the anchor [m].
            supports: Distances of the span limits of the overlap from the anchor, in increasing order from 0 [m].

        Returns:
            Rise above the height without overlap [m].
        """
        if self.support_rises_m is None:
            end = supports[(self.spans + 1) // 2]
            return (self.anchor_rise_m or 0.0) * max(0.0, 1 - distance / end) ** 2
        rises = np.zeros(len(supports))
        rises[: len(self.support_rises_m)] = self.support_rises_m
        return float(np.interp(distance, supports, rises))


@dataclass(frozen=True)
class SectionPlace:
    """Place of a section along the line."""

    number: int
    """Number of the section, from 1."""
    first: int
    last: int
    """Numbers of the span limits at its anchors; 0 is the start of the line."""


class TensionSections(Element):
    """Tension sections of the line, and the overlaps between them."""

    section: Annotated[
        tuple[SectionTable, ...] | None,
        Field(strict=False, min_length=2, max_length=MOST_SPANS, exclude_if=is_absent),
        SECTIONS,
    ] = None
    """Tension sections in running order; default: one section from end to end."""
    overlap: Annotated[OverlapTable | None, Field(exclude_if=is_absent), SECTIONS] = None

    @property
    def section_places(self) -> tuple[SectionPlace, ...]:
        """Places of the tension sections; one from end to end if the file has none."""
        if self.section is None or self.overlap is None:
            return (SectionPlace(1, 0, len(self.line.geometry.span_lengths)),)
        return place_sections(self.section, self.overlap.spans)

    @property
    def overlaps(self) -> tuple[tuple[float, float], ...]:
        """Start and end of every overlap [m, m]."""
        limits = self.line.geometry.span_limits
        return tuple((limits[after.first], limits[before.last]) for before, after in pairwise(self.section_places))

    @property
    def middle_span(self) -> int:
        """Number of the span in the middle of the first tension section without its overlap, from 1."""
        overlap = 0 if self.overlap is None else self.overlap.spans
        return self.line.geometry.shorten(self.section_places[0].last - overlap).middle_span

    def shorten(self, spans: int) -> Self:
        """Same line with the first spans only, as one tension section."""
        return self.model_copy(update={"geometry": self.line.geometry.shorten(spans), "section": None, "overlap": None})

    def section_file(self, place: SectionPlace) -> Self:
        """Same line with the wires of one section."""
        if self.section is None:
            return self
        own, wires = self.section[place.number - 1], self.part(Wires)
        changed = {
            "contact_wire": overlay_changes(wires.contact_wire, own.contact_wire),
            "messenger_wire": overlay_changes(wires.messenger_wire, own.messenger_wire),
        }
        return self.model_copy(update=changed)

    def section_rise(self, place: SectionPlace) -> SectionRise:
        """Rise of the wires of a section; zero on a line without overlaps, and at the ends of the line."""
        overlap, geometry = self.overlap, self.line.geometry
        if overlap is None:
            return lambda x: 0.0
        limits, n = geometry.span_limits, overlap.spans
        start, end = limits[place.first], limits[place.last]
        behind = [x - start for x in limits[place.first : place.first + n + 1]]
        ahead = [end - x for x in reversed(limits[place.last - n : place.last + 1])]

        def rise(x: float) -> float:
            """Rise towards the anchor at the start plus that towards the anchor at the end; one of them is zero."""
            from_start = overlap.rise(x - start, behind) if place.first > 0 else 0.0
            return from_start + (overlap.rise(end - x, ahead) if place.last < len(geometry.span_lengths) else 0.0)

        return rise

    def lowest_rise(self, x: float) -> float:
        """Rise of the lowest contact wire at a position along the line [m]; zero outside of overlaps."""
        limits = self.line.geometry.span_limits
        places = [place for place in self.section_places if limits[place.first] <= x <= limits[place.last]]
        return min(self.section_rise(place)(x) for place in places)

    @cross_check
    def _check_overlap(self) -> Problems:
        if (self.section is None) != (self.overlap is None):
            key, other = ("overlap", "section") if self.overlap is None else ("section", "overlap")
            yield validation_problem(key, f"missing, although {other} is given", "Give both, or none of them.")

    @cross_check
    def _check_terminations(self) -> Problems:
        for number, section in enumerate(self.section or (), 1):
            if section.holding_points > 1 and self.part(Wires).messenger_wire.axial_stiffness_EA_N is None:
                yield validation_problem(
                    "messenger_wire.axial_stiffness_EA_N",
                    f"section {number} holds the messenger wire along the track at {section.holding_points} points, "
                    "but its axial stiffness is not given",
                    "Give messenger_wire.axial_stiffness_EA_N, or end the section with weights.",
                )

    @cross_check
    def _check_sections(self) -> Problems:
        if self.section is not None and self.overlap is not None:
            yield from find_span_problems(self.section, self.overlap.spans, len(self.line.geometry.span_lengths))

    def join_line(self, sections: Sequence[Catenary]) -> Catenary:
        """Join the sections of the line, each built in its place without a rise."""
        if self.section is None or self.overlap is None:
            return sections[0]
        limits = self.line.geometry.span_limits
        ended = [_terminate(section, table, limits) for section, table in zip(sections, self.section, strict=True)]
        return join_sections(
            [
                place_section(section, _name_section(place), 0.0, self.section_rise(place))
                for place, section in zip(self.section_places, ended, strict=True)
            ]
        )

    def divide_line(self, built: "DiscretisedLine") -> list[tuple[Self, BuiltSection]]:
        """Divide the finite elements of the line into its tension sections, each with the line that has its wires."""
        limits = self.line.geometry.span_limits
        if self.overlap is None:
            return [(self, BuiltSection(limits, built))]
        return [
            (
                self.section_file(place),
                BuiltSection(limits[place.first : place.last + 1], _select_parts(built, _name_section(place))),
            )
            for place in self.section_places
        ]


def place_sections(sections: Sequence[SectionTable], overlap: int) -> tuple[SectionPlace, ...]:
    """Places of sections in running order; each begins with the overlap [spans] at the end of the one before."""
    places, first = [], 0
    for number, section in enumerate(sections, 1):
        places.append(SectionPlace(number, first, first + section.spans))
        first += section.spans - overlap
    return tuple(places)


def find_span_problems(sections: Sequence[SectionTable], overlap: int, spans: int) -> Problems:
    """Find the problems of sections with an overlap [spans] on a line with a number of spans."""
    for number, section in enumerate(sections, 1):
        neighbours = 2 if 1 < number < len(sections) else 1
        if section.spans <= neighbours * overlap:
            yield validation_problem(
                f"section[{number}].spans",
                f"{section.spans} spans, of which {neighbours * overlap} belong to overlaps",
                f"Give at least {neighbours * overlap + 1} spans, or a shorter overlap.",
            )
    places = place_sections(sections, overlap)
    for section, place in zip(sections, places, strict=True):
        support = section.midpoint_anchor
        if support is not None and not place.first < support < place.last:
            yield validation_problem(
                f"section[{place.number}].midpoint_anchor",
                f"support {support} is not inside the section",
                f"Give a support from {place.first + 1} to {place.last - 1}, counted along the line.",
            )
    end = places[-1].last
    if end != spans:
        yield validation_problem(
            "section",
            f"the sections end at span {end}, but the line has {spans} spans",
            "The spans of all sections, less those of the overlaps between them, must be those of the geometry.",
        )


def _name_section(place: SectionPlace) -> str:
    """Name of a section, the first part of the names of its wires."""
    return f"section {place.number}"


def _select_parts(line: "DiscretisedLine", name: str) -> "DiscretisedLine":
    """Line with the wires and parts of one section in catenary and state."""
    catenary, state, kept = line.catenary, line.state, select_parts(line.catenary, name)
    parts: dict[str, Any] = {key: tuple(getattr(catenary, key)[n] for n in indices) for key, indices in kept.items()}
    droppers, arms = kept["droppers"], kept["steady_arms"]
    return replace(
        line,
        catenary=replace(
            catenary, wires=tuple(wire for wire in catenary.wires if wire.name.startswith(f"{name} ")), **parts
        ),
        state=replace(
            state,
            dropper_tension=state.dropper_tension[droppers],
            dropper_length=state.dropper_length[droppers],
            dropper_direction=state.dropper_direction[droppers],
            clamp_force=state.clamp_force[kept["clamps"]],
            arm_force=state.arm_force[arms],
        ),
    )


def _terminate(section: Catenary, table: SectionTable, limits: Sequence[float]) -> Catenary:
    """Section whose messenger wires have their terminations and their mid-point anchor."""
    terminations = Termination(table.start), Termination(table.end)
    midpoint = None if table.midpoint_anchor is None else limits[table.midpoint_anchor]
    return replace(
        section,
        wires=tuple(
            replace(wire, terminations=terminations) if wire.kind is Kind.MESSENGER_WIRE else wire
            for wire in section.wires
        ),
        messenger_supports=tuple(
            replace(support, along_track="fixed") if support.position == midpoint else support
            for support in section.messenger_supports
        ),
    )

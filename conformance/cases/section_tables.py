"""Tension sections of a line, and the overlaps between neighbouring sections.

span limit        0          ...      19     20     21     22    ...
first section     |-------------------o------o------o------|             spans = 22
second section                        |------o------o------o-----...
                                      |<---- overlap ----->|             spans = 3

Every section has its own wires from anchor to anchor. Over the spans of an overlap two sections lie side by side: the
outgoing wires rise to their anchor, and the incoming ones descend from theirs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from pantocheck.conformance.cases.support_tables import MOST_SPANS
from pantocheck.conformance.cases.wire_changes import BendingStiffness, MassPerLength, Tension
from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.features import Feature
from pantocheck.conformance.input_files.sourced_table import InputTable, validation_problem

SECTIONS = Feature("sections")

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

    spans: Annotated[int, Field(ge=2, le=MOST_SPANS, description="number of spans from anchor to anchor")]
    start: WireEnd = "weight"
    end: WireEnd = "weight"
    midpoint_anchor: Annotated[
        int | None,
        Field(
            ge=1,
            le=MOST_SPANS,
            description="number of the support, counted along the line, at which the messenger wire is held along the "
            "track; default: none",
        ),
        Feature("messenger_wire_held_along_track"),
    ] = None

    contact_wire: Annotated[SectionWire | None, Field(description="own values of the contact wires"), SECTIONS] = None
    messenger_wire: Annotated[SectionWire | None, Field(description="own values of the messenger wires"), SECTIONS] = (
        None
    )

    @property
    def holding_points(self) -> int:
        """Number of points that hold the messenger wire along the track."""
        return [self.start, self.end].count("anchor") + (self.midpoint_anchor is not None)


class OverlapTable(InputTable):
    """Overlap of neighbouring sections; its rises hold for the wires of both."""

    spans: Annotated[int, Field(ge=1, le=MOST_OVERLAP_SPANS, description="number of spans of every overlap")]
    anchor_rise_m: Annotated[
        WireRise | None,
        Field(
            description="rise of the wires at their anchor, for a parabola that ends at the first support behind the "
            "middle of the overlap [m]"
        ),
        SECTIONS,
    ] = None
    support_rises_m: Annotated[
        tuple[WireRise, ...] | None,
        Field(
            strict=False,
            min_length=1,
            max_length=MOST_OVERLAP_SPANS,
            description="rises at the anchor and at the next supports, in place of a parabola; straight in between [m]",
        ),
        SECTIONS,
    ] = None

    @cross_check
    def _has_one_profile(self) -> Problems:
        if (self.anchor_rise_m is None) == (self.support_rises_m is None):
            yield validation_problem(
                "anchor_rise_m",
                "the rise of the wires is missing or given twice",
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

        Parameters
        ----------
        distance : float
            Distance from the anchor [m].
        supports : sequence of float
            Distances of the span limits of the overlap from the anchor, in increasing order from 0 [m].

        Returns
        -------
        float
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
    """Place of a section along the line.

    Parameters
    ----------
    number : int
        Number of the section, from 1.
    first, last : int
        Numbers of the span limits at its anchors; 0 is the start of the line.
    """

    number: int
    first: int
    last: int


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

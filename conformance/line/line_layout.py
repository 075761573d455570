"""Line layout: every span and every support of a line with all its values, in either form of the geometry.

number      0          1          2          3  = number of spans
            |----------o----------o----------|
           end      support    support      end
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.line.elements.dropper import DropperSchedule
from pantocheck.conformance.line.elements.messenger_support import MessengerSupportTable
from pantocheck.conformance.line.elements.single_support import overlay_changes
from pantocheck.conformance.line.elements.steady_arm import SteadyArmTable
from pantocheck.conformance.line.elements.support_table import SupportTable
from pantocheck.conformance.line.geometry import Geometry


@dataclass(frozen=True)
class SpanLimit:
    """Point where the wires are held: a support, or an end of the line."""

    number: int
    """Number from 0, the start of the line."""
    position: float
    """Position along the track [m]."""
    contact_wire_height: float
    """Height of the contact wire above the datum [m]."""
    encumbrance: float
    """Vertical distance between messenger wire and contact wire [m]."""
    contact_wire_stagger: float
    messenger_wire_stagger: float
    """Lateral positions of the wires, signed [m]."""

    @property
    def messenger_wire_height(self) -> float:
        """Height of the messenger wire above the datum [m]."""
        return self.contact_wire_height + self.encumbrance


@dataclass(frozen=True)
class SupportLayout:
    """Support with its arm and its messenger support."""

    limit: SpanLimit
    """Position, heights and staggers."""
    steady_arm: SteadyArmTable
    messenger_support: MessengerSupportTable


@dataclass(frozen=True)
class SpanLayout:
    """Span with its droppers."""

    start: SpanLimit
    end: SpanLimit
    """Support or end of the line at either side."""
    dropper_position: RealArray
    """Positions of the droppers along the track, (n,) [m]."""
    contact_wire_height: RealArray
    """Prescribed heights of the contact wire at the droppers, (n,) [m]."""


@dataclass(frozen=True)
class LineLayout:
    """Spans and supports in running order."""

    limits: tuple[SpanLimit, ...]
    """Start of the line, supports, and end of the line."""
    spans: tuple[SpanLayout, ...]
    supports: tuple[SupportLayout, ...]
    """Supports between the ends of the line."""
    has_stagger: bool
    """Whether a wire of the whole line lies beside the centre line at a support."""

    @property
    def supports_fixed_along_track(self) -> tuple[int, ...]:
        """Numbers of the supports that hold the messenger wire along the track."""
        return tuple(s.limit.number for s in self.supports if s.messenger_support.along_track == "fixed")

    def part(self, first: int, last: int) -> "LineLayout":
        """Part of the line between two span limits, with the supports between them."""
        supports = tuple(support for support in self.supports if first < support.limit.number < last)
        return replace(self, limits=self.limits[first : last + 1], spans=self.spans[first:last], supports=supports)

    @cached_property
    def _chords(self) -> tuple[list[float], list[float]]:
        return [limit.position for limit in self.limits], [limit.contact_wire_height for limit in self.limits]

    def chord_height(self, position: RealArray) -> RealArray:
        """Height of the straight lines between the contact wire at neighbouring supports, at positions (n,) [m]."""
        return np.interp(position, *self._chords)


def build_layout(
    geometry: Geometry,
    schedules: Sequence[DropperSchedule],
    steady_arm: SteadyArmTable,
    messenger_support: MessengerSupportTable,
) -> LineLayout:
    """Build the layout of a line.

    Args:
        geometry: Spans, heights and staggers.
        schedules: Dropper schedule of every span.
        steady_arm, messenger_support: Arm and messenger support of supports without their own values.
    """
    own = geometry.own_supports
    limits = tuple(_build_limit(geometry, number, x, own) for number, x in enumerate(geometry.span_limits))
    supports = []
    for limit in limits[1:-1]:
        changes = own.get(limit.number, SupportTable(number=limit.number))
        arm = overlay_changes(steady_arm, changes.steady_arm)
        supports.append(SupportLayout(limit, arm, overlay_changes(messenger_support, changes.messenger_support)))
    spans = zip(limits[:-1], limits[1:], schedules, strict=True)
    has_stagger = any(limit.contact_wire_stagger or limit.messenger_wire_stagger for limit in limits)
    return LineLayout(limits, tuple(_build_span(*span) for span in spans), tuple(supports), has_stagger)


def _build_limit(geometry: Geometry, number: int, position: float, own: Mapping[int, SupportTable]) -> SpanLimit:
    """Support or end of the line.

    Staggers without an own value alternate in sign. An end of the line without own heights has those of its next
    support; gradients add to both.
    """
    next_support = min(max(number, 1), max(geometry.spans - 1, 1))
    here, level = own.get(number, SupportTable(number=number)), own.get(next_support, SupportTable(number=number))
    side = 1.0 if number % 2 == 0 else -1.0
    height = _first(here.contact_wire_height_m, level.contact_wire_height_m, geometry.level_height)
    height += geometry.rise(position)
    return SpanLimit(
        number=number,
        position=position,
        contact_wire_height=height,
        encumbrance=_first(here.encumbrance_m, level.encumbrance_m, geometry.encumbrance_m),
        contact_wire_stagger=_first(here.stagger_contact_wire_m, side * geometry.stagger_contact_wire_m),
        messenger_wire_stagger=_first(here.stagger_messenger_m, side * geometry.stagger_messenger_m),
    )


def _first(*values: float | None) -> float:
    """First given value."""
    return next(value for value in values if value is not None)


def _build_span(start: SpanLimit, end: SpanLimit, schedule: DropperSchedule) -> SpanLayout:
    share = np.array(schedule.x_m) / (end.position - start.position)
    chord = start.contact_wire_height + share * (end.contact_wire_height - start.contact_wire_height)
    return SpanLayout(start, end, start.position + np.array(schedule.x_m), schedule.prescribed_heights(chord))

"""Spans and supports of a line: their positions, and their layout with all values.

number      0          1          2          3  = number of spans
            |----------o----------o----------|
           end      support    support      end
"""

from abc import abstractmethod
from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import accumulate
from typing import Self, TypeVar

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.sourced_table import InputTable
from pantocheck.conformance.line.elements.dropper_schedule import DropperSchedule

Table = TypeVar("Table", bound=InputTable)

SINGLE_SUPPORTS = Feature("single_supports")
"""Feature of values of single supports, in place of those of the line."""

MOST_SPANS = 1000
"""Largest number of spans of a line."""


def overlay_changes(table: Table, changes: InputTable | None) -> Table:
    """Table of the line with the values that differ at one support, or in one tension section."""
    if changes is None:
        return table
    return type(table).model_validate(table.model_dump() | changes.model_dump(exclude_none=True))


class SpanPositions:
    """Positions of spans, supports and sections along a line, from the lengths of its spans."""

    @property
    @abstractmethod
    def span_lengths(self) -> tuple[float, ...]:
        """Length of every span [m]."""

    @abstractmethod
    def shorten(self, spans: int) -> Self:
        """Same geometry with the first spans only."""

    @abstractmethod
    def choose_schedules(self, common: DropperSchedule) -> tuple[DropperSchedule, ...]:
        """Dropper schedule of every span; the common one of the line where a span has no other."""

    @abstractmethod
    def schedule_key(self, number: int) -> str:
        """Key of the dropper schedule of a span in the line file."""

    @property
    def level_height(self) -> float:
        """Height of the contact wire at supports without their own height [m]."""
        return 0.0

    def rise(self, x: float) -> float:
        """Rise of the contact wire by gradients between the start of the line and a position [m]."""
        return 0.0

    @property
    def span_limits(self) -> tuple[float, ...]:
        """Positions of both ends of the line and of the supports between them, in increasing order [m], from 0."""
        return _sum_lengths(self.span_lengths)

    @property
    def supports(self) -> tuple[float, ...]:
        """Positions of the supports between the ends of the line [m]."""
        return self.span_limits[1:-1]

    @property
    def length(self) -> float:
        """Length of the line from end to end [m]."""
        return self.span_limits[-1]

    @property
    def longest_span(self) -> float:
        """Length of the longest span [m]."""
        return max(self.span_lengths)

    @property
    def shortest_span(self) -> float:
        """Length of the shortest span [m]."""
        return min(self.span_lengths)

    @property
    def middle_span(self) -> int:
        """Number of the span in the middle of the line, from 1."""
        return len(self.span_lengths) // 2 + 1

    def span(self, number: int) -> tuple[float, float]:
        """Start and end of a span, numbered from 1 [m]."""
        return self.section(number, number)

    def mid_span(self, number: int) -> float:
        """Middle of a span, numbered from 1 [m]."""
        return sum(self.span(number)) / 2

    def section(self, first: int, last: int) -> tuple[float, float]:
        """Start of the first span and end of the last span of a section, numbered from 1 [m]."""
        return self.span_limits[first - 1], self.span_limits[last]

    def spans_of_section(self, start: float, end: float) -> tuple[int, int]:
        """Numbers of the first and the last span that a section touches, from 1; its ends are positions [m]."""
        inner = self.span_limits[1:-1]
        return bisect_right(inner, start) + 1, bisect_left(inner, end) + 1


@lru_cache(maxsize=64)
def _sum_lengths(lengths: Sequence[float]) -> tuple[float, ...]:
    """Exact sums of lengths, rounded once: n equal lengths give the product, as of equal spans."""
    return tuple(map(float, accumulate(map(Fraction, lengths), initial=Fraction())))


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
    """Support between the ends of the line."""

    limit: SpanLimit
    """Position, heights and staggers."""
    changes: Mapping[str, InputTable]
    """Own values of the support, by the key of the table that they change."""

    def overlay(self, key: str, table: Table) -> Table:
        """Table of the line under a key, with the values of this support."""
        return overlay_changes(table, self.changes.get(key))


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

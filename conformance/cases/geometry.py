"""Geometry of a line: spans, heights and stagger."""

from typing import Annotated

from pydantic import Field

from pantocheck.conformance.input_files.sourced_table import SourcedTable

Stagger = Annotated[float, Field(ge=-1, le=1, description="lateral offset at the supports, with alternating sign [m]")]


class Geometry(SourcedTable):
    """Spans, heights and stagger."""

    span_m: Annotated[float, Field(ge=10, le=120, description="length of every span [m]")]
    spans: Annotated[int, Field(ge=1, le=1000, description="number of spans")]
    encumbrance_m: Annotated[
        float,
        Field(gt=0, le=5, description="vertical distance between messenger wire and contact wire at a support [m]"),
    ]
    stagger_contact_wire_m: Stagger = 0.0
    stagger_messenger_m: Stagger = 0.0

    @property
    def span_lengths(self) -> tuple[float, ...]:
        """Length of every span [m]."""
        return (self.span_m,) * self.spans

    @property
    def span_limits(self) -> tuple[float, ...]:
        """Positions of both ends of the line and of the supports between them, in increasing order [m], from 0."""
        return tuple(self.span_m * i for i in range(self.spans + 1))

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
        return self.spans // 2 + 1

    def span(self, number: int) -> tuple[float, float]:
        """Start and end of a span, numbered from 1 [m]."""
        return self.section(number, number)

    def mid_span(self, number: int) -> float:
        """Middle of a span, numbered from 1 [m]."""
        return sum(self.span(number)) / 2

    def section(self, first: int, last: int) -> tuple[float, float]:
        """Start of the first span and end of the last span of a section, numbered from 1 [m]."""
        return self.span_limits[first - 1], self.span_limits[last]

    def shorten(self, spans: int) -> "Geometry":
        """Same geometry with the first spans only."""
        return self.model_copy(update={"spans": min(self.spans, spans)})

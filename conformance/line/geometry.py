"""Geometry of a line: spans, heights and stagger; the spans are equal, or listed one by one."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Self

import numpy as np
from pydantic import Discriminator, Field, Tag

from pantocheck.conformance.core.features import Feature, always
from pantocheck.conformance.core.input_error import suggest_names
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    Problems,
    SourcedTable,
    cross_check,
    is_absent,
    validation_problem,
)
from pantocheck.conformance.line.elements.dropper_schedule import DropperSchedule
from pantocheck.conformance.line.elements.element import choose_by_key
from pantocheck.conformance.line.elements.line_layout import (
    MOST_SPANS,
    SINGLE_SUPPORTS,
    LineLayout,
    SpanLayout,
    SpanLimit,
    SpanPositions,
    SupportLayout,
)
from pantocheck.conformance.line.support_table import Encumbrance, Height, SupportTable

SpanLength = Annotated[float, Field(ge=10, le=120)]
Stagger = Annotated[
    float,
    Field(ge=-1, le=1, description="lateral offset at the supports, with alternating sign [m]"),
    Feature("stagger"),
]
ScheduleName = Annotated[str, Field(min_length=1, max_length=100)]


class EqualSpans(SpanPositions, SourcedTable):
    """Equal spans, heights and stagger."""

    span_m: SpanLength
    """Length of every span [m]."""
    spans: Annotated[int, Field(ge=1, le=MOST_SPANS)]
    """Number of spans."""
    encumbrance_m: Encumbrance
    stagger_contact_wire_m: Stagger = 0.0
    stagger_messenger_m: Stagger = 0.0

    @property
    def span_lengths(self) -> tuple[float, ...]:
        """Length of every span [m]."""
        return (self.span_m,) * self.spans

    @property
    def own_supports(self) -> Mapping[int, SupportTable]:
        """Supports and ends of the line with their own values, by number."""
        return {}

    def shorten(self, spans: int) -> Self:
        """Same geometry with the first spans only."""
        return self.model_copy(update={"spans": min(self.spans, spans)})

    def choose_schedules(self, common: DropperSchedule) -> tuple[DropperSchedule, ...]:
        """Dropper schedule of every span: the common one of the line."""
        return (common,) * self.spans

    def schedule_key(self, number: int) -> str:
        """Key of the dropper schedule of a span in the line file."""
        return "droppers"


SpanDroppers = Annotated[
    Annotated[ScheduleName, Tag("name")] | Annotated[DropperSchedule, Tag("DropperSchedule")],
    Discriminator(lambda droppers: "name" if isinstance(droppers, str) else "DropperSchedule"),
]


class Span(InputTable):
    """Span of a line with its droppers."""

    length_m: SpanLength
    """Length of the span [m]."""
    droppers: Annotated[SpanDroppers | None, Feature("listed_spans")] = None
    """Name of a table in geometry.schedule, or the schedule itself; default: that of [droppers]."""


class GradientTable(InputTable):
    """Stretch on which the contact wire rises or falls; behind it, the wire keeps the height that it reached."""

    from_m: NonNegative
    """Start of the gradient [m]."""
    to_m: NonNegative
    """End of the gradient [m]."""
    slope: Annotated[float, Field(ge=-0.05, le=0.05)]
    """Rise per length; negative: the wire falls [-]."""

    @cross_check
    def _has_a_length(self) -> Problems:
        if self.to_m <= self.from_m:
            yield validation_problem(
                "to_m",
                f"{self.to_m:g} m is not greater than from_m = {self.from_m:g} m",
                "Give start and end in running order; slope is positive where the wire rises.",
            )

    def rise(self, x: float) -> float:
        """Rise between the start of the gradient and a position [m]."""
        return self.slope * (min(max(x, self.from_m), self.to_m) - self.from_m)


class ListedSpans(SpanPositions, SourcedTable):
    """Spans listed one by one; heights and stagger of the supports, and supports with their own values."""

    span_list: Annotated[
        tuple[Span, ...], Field(strict=False, min_length=1, max_length=MOST_SPANS), Feature("listed_spans", always)
    ]
    """Spans in running order."""
    schedule: Annotated[
        dict[ScheduleName, DropperSchedule], Field(default_factory=dict, max_length=MOST_SPANS), Feature("listed_spans")
    ]
    """Dropper schedules by name."""
    encumbrance_m: Encumbrance
    stagger_contact_wire_m: Stagger = 0.0
    stagger_messenger_m: Stagger = 0.0
    contact_wire_height_m: Annotated[Height, Field(exclude_if=lambda height: height == 0.0), Feature("wire_height")] = (
        0.0
    )
    support: Annotated[
        tuple[SupportTable, ...], Field(strict=False, max_length=MOST_SPANS + 1, exclude_if=is_absent), SINGLE_SUPPORTS
    ] = ()
    """Supports and ends of the line with their own values."""
    gradient: Annotated[
        tuple[GradientTable, ...],
        Field(strict=False, max_length=MOST_SPANS, exclude_if=is_absent),
        Feature("gradients"),
    ] = ()
    """Gradients of the contact wire; they add to the heights of the supports."""

    @property
    def spans(self) -> int:
        """Number of spans."""
        return len(self.span_list)

    @property
    def span_lengths(self) -> tuple[float, ...]:
        """Length of every span [m]."""
        return tuple(span.length_m for span in self.span_list)

    def shorten(self, spans: int) -> Self:
        """Same geometry with the first spans only."""
        listed = self.span_list[:spans]
        return self.model_copy(
            update={"span_list": listed, "support": tuple(s for s in self.support if s.number <= len(listed))}
        )

    @property
    def own_supports(self) -> Mapping[int, SupportTable]:
        """Supports and ends of the line with their own values, by number."""
        return {support.number: support for support in self.support}

    @property
    def level_height(self) -> float:
        """Height of the contact wire at supports without their own height [m]."""
        return self.contact_wire_height_m

    def rise(self, x: float) -> float:
        """Rise of the contact wire by gradients between the start of the line and a position [m]."""
        return sum((gradient.rise(x) for gradient in self.gradient), start=0.0)

    def choose_schedules(self, common: DropperSchedule) -> tuple[DropperSchedule, ...]:
        """Dropper schedule of every span: its own, a named one, or the common one of the line."""
        return tuple(
            common if span.droppers is None
            else self.schedule[span.droppers] if isinstance(span.droppers, str)
            else span.droppers
            for span in self.span_list
        )  # fmt: skip

    def schedule_key(self, number: int) -> str:
        """Key of the dropper schedule of a span in the line file."""
        droppers = self.span_list[number - 1].droppers
        if droppers is None:
            return "droppers"
        return (
            f"geometry.schedule.{droppers}" if isinstance(droppers, str) else f"geometry.span_list[{number}].droppers"
        )

    @cross_check
    def _schedules_exist(self) -> Problems:
        for i, span in enumerate(self.span_list, 1):
            if isinstance(span.droppers, str) and span.droppers not in self.schedule:
                yield validation_problem(
                    f"span_list[{i}].droppers",
                    f"there is no dropper schedule {span.droppers!r}",
                    suggest_names(span.droppers, list(self.schedule)),
                )

    @cross_check
    def _supports_exist(self) -> Problems:
        numbers = [support.number for support in self.support]
        for i, support in enumerate(self.support, 1):
            key, number = f"support[{i}]", support.number
            if number > self.spans:
                yield validation_problem(
                    f"{key}.number",
                    f"there is no support {number}",
                    f"The line has the supports 1 to {self.spans - 1}, and the ends 0 and {self.spans}.",
                )
            if number in numbers[: i - 1]:
                yield validation_problem(
                    f"{key}.number", f"support {number} is listed twice", "Join both tables of this support."
                )
            if number in (0, self.spans) and support.changes:
                yield validation_problem(
                    f"{key}.{next(iter(support.changes))}",
                    f"support {number} is an end of the line, with anchored wires",
                    "Leave it out: an end has a stagger, an encumbrance and a contact wire height only.",
                )

    @cross_check
    def _gradients_lie_on_the_line(self) -> Problems:
        for i, gradient in enumerate(self.gradient, 1):
            if gradient.from_m >= self.length:
                yield validation_problem(
                    f"gradient[{i}].from_m",
                    f"{gradient.from_m:g} m is not on the line",
                    f"Give a position before the end of the line at {self.length:g} m.",
                )


Geometry = EqualSpans | ListedSpans
GeometryTable = Annotated[
    Annotated[EqualSpans, Tag("EqualSpans")] | Annotated[ListedSpans, Tag("ListedSpans")],
    choose_by_key("span_list", ListedSpans, EqualSpans),
]


def build_layout(geometry: Geometry, schedules: Sequence[DropperSchedule]) -> LineLayout:
    """Build the layout of a line.

    Args:
        geometry: Spans, heights and staggers.
        schedules: Dropper schedule of every span.
    """
    own = geometry.own_supports
    limits = tuple(_build_limit(geometry, number, x, own) for number, x in enumerate(geometry.span_limits))
    supports = (
        SupportLayout(limit, own[limit.number].changes if limit.number in own else {}) for limit in limits[1:-1]
    )
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

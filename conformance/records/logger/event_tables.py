"""Tables `event` and `event_channel` of a sidecar: places of the line that a measurement passes."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.sourced_table import InputTable, validation_problem
from pantocheck.conformance.records.logger.column_tables import FileColumnName

EventKind = Literal[
    "support", "overlap", "section_insulator", "neutral_section", "switch", "tunnel", "bridge", "level_crossing",
    "fault_of_measurement", "other",
]  # fmt: skip
"""Kinds of places."""

Reason = Annotated[
    str | None,
    Field(
        min_length=3,
        max_length=500,
        description="reason to leave this stretch out of the evaluation, where the profile permits it",
    ),
]
EventPlace = Annotated[float | None, Field(ge=-1e7, le=1e7)]


class EventTable(InputTable):
    """Place or stretch of the line by position x [m], or by kilometres with the table `track`."""

    kind: EventKind
    """Kind of the place."""
    name: Annotated[str, Field(max_length=200)] = ""
    """Name of the place."""
    from_m: EventPlace = None
    """Start of the stretch, or place of the event [m]."""
    to_m: EventPlace = None
    """End of the stretch [m]; default: its start."""
    from_km: EventPlace = None
    """One end of the stretch, or place of the event [km]."""
    to_km: EventPlace = None
    """Other end of the stretch [km]; default: the first one."""
    exclude: Reason = None

    @cross_check
    def _check_place(self) -> Problems:
        if (self.from_m is None) == (self.from_km is None):
            yield validation_problem("from_m", "the place is missing, or stated twice", "Give from_m or from_km.")
        elif (self.to_m is not None and self.from_m is None) or (self.to_km is not None and self.from_km is None):
            yield validation_problem("to_m", "the ends have other units", "Give both ends in metres or in kilometres.")
        if self.from_m is not None and self.to_m is not None and self.to_m < self.from_m:
            yield validation_problem("to_m", "the end is before the start", "Give the start, then the end.")
        if self.exclude is not None and self.to_m is None and self.to_km is None:
            yield validation_problem(
                "exclude", "the event is a place without length", "Give both ends of the stretch to be left out."
            )


class EventChannel(InputTable):
    """Column of the file that marks events: an event lasts while its number exceeds a level."""

    column: FileColumnName
    kind: EventKind
    """Kind of the places."""
    above: float = 0.5
    """Level that the number exceeds during an event."""
    ahead_m: Annotated[float, Field(ge=-1000, le=1000)] = 0.0
    """Distance of the marked place ahead of the first pantograph [m]."""
    exclude: Reason = None

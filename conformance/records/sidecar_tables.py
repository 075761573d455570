"""Common tables and keys of sidecars and summaries of contact-force records: system, run, line, position, events."""

import datetime
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Discriminator, Field

from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    NumberList,
    Positive,
    Problems,
    cross_check,
    validation_problem,
)
from pantocheck.conformance.records.column_values import ColumnTable, FileColumnName


class SystemTable(InputTable):
    """Simulator or measuring system of a record."""

    name: Annotated[str, Field(max_length=200)]
    """Name of the simulator or measuring system."""
    version: Annotated[str, Field(max_length=200)] = ""
    """Version of the simulator or measuring system."""


class RunTable(InputTable):
    """Data of a simulation; all keys are optional."""

    simulated_s: Annotated[float | None, Field(gt=0)] = None
    """Simulated time [s]."""
    wall_s: Annotated[float | None, Field(ge=0)] = None
    """Computing time [s]."""
    dt_s: Annotated[float | None, Field(gt=0)] = None
    """Time step [s]."""
    element_m: Annotated[float | None, Field(gt=0)] = None
    """Element length [m]."""


PartitionName = Annotated[str, Field(pattern=r"^\w[\w.-]{0,39}$")]


class MeasurementTable(InputTable):
    """Place and date of a measurement, for a collection of runs."""

    line: PartitionName
    """Name or number of the railway line: letters, digits, points and hyphens."""
    track: PartitionName
    """Name or number of the track."""
    date: datetime.date
    """Date of the run."""
    pantograph_names: Annotated[tuple[PartitionName, ...], Field(strict=False, max_length=20)] = ()
    """Names of the measuring pantographs in running order; default: their numbers."""


StartCondition = Literal["equilibrium_under_uplift_forces", "line_at_rest", "other"]
"""State of line and pantographs at the start of a run.

`equilibrium_under_uplift_forces`: static equilibrium with every pantograph pressing with its uplift force;
`line_at_rest`: the line carries its weight only, the contact forces begin at zero.
"""


class StartTable(InputTable):
    """Start of a simulation."""

    place_m: float
    """Position of the last pantograph at the start of the run [m]."""
    ramp_m: NonNegative = 0.0
    """Distance over which speed or force reaches its full value [m]; 0: full from the start."""
    state: StartCondition
    """State of line and pantographs; equilibrium_under_uplift_forces: static equilibrium with every pantograph
    pressing with its uplift force; line_at_rest: contact forces begin at zero.
    """


class LineTable(InputTable):
    """Data of the line for the rules of a profile; all keys are optional."""

    span_m: Annotated[float | None, Field(ge=5, le=200)] = None
    """Length of the longest span [m]."""
    wave_speed_m_s: Annotated[float | None, Field(gt=0, le=1000)] = None
    """Speed of transverse waves on the contact wire [m/s]."""
    uplift_space_mm: Annotated[NonNegative | None, Field(le=2000)] = None
    """Space for the uplift of the contact wire at the supports [mm]."""


class PassageTable(InputTable):
    """Passage that a record or a summary belongs to."""

    case: Annotated[str | None, Field(max_length=200)] = None
    """Id of the case that was run."""
    case_digest: Annotated[str | None, Field(pattern="^sha256:[0-9a-f]{64}$")] = None
    """Digest of the inputs of this case, equal to input_digest in the results of the case."""
    speed_km_h: Annotated[float, Field(ge=1, le=600)]
    """Speed of the train [km/h]."""
    evaluated_m: Annotated[NumberList | None, Field(min_length=2, max_length=2)] = None
    """Start and end of the analysis section [m]; default: that of the case; `assess` requires it of a record."""
    line: LineTable = LineTable()
    system: SystemTable | None = None
    run: RunTable = RunTable()
    start: StartTable | None = None
    """Start of the simulation, for cases with a short run-in."""

    @cross_check
    def _check_section(self) -> Problems:
        if self.evaluated_m is not None and self.evaluated_m[0] >= self.evaluated_m[1]:
            yield validation_problem(
                "evaluated_m", "the end is not greater than the start", "Give the start, then the end of the section."
            )


# Tables `track` and `position` of a sidecar: the kilometres of the line, and the position of the train.
class KilometreTable(InputTable):
    """Kilometres of the line: x = 1000 (km - zero_km), or 1000 (zero_km - km) if they decrease in running direction."""

    zero_km: Annotated[float, Field(ge=-10000, le=10000)]
    """Kilometre of the line at x = 0."""
    kilometres: Literal["increasing", "decreasing"]
    """Kilometres of the line in running direction."""

    @property
    def direction(self) -> float:
        """1 if the kilometres increase in running direction, else -1."""
        return 1.0 if self.kilometres == "increasing" else -1.0

    def place(self, kilometre: float) -> float:
        """Position x in running direction [m]."""
        return self.direction * 1000 * (kilometre - self.zero_km)


class PulsePosition(InputTable):
    """Position from distance pulses: a counter, which may count up or down, or a pulse train of a wheel sensor."""

    kind: Literal["counter", "pulses"]
    """counter: the column counts the pulses; pulses: its rising edges are counted."""
    column: FileColumnName
    metres_per_pulse: Annotated[Positive, Field(le=1000)]
    """Distance per pulse [m]."""
    start_m: float
    """Position of the first pantograph at the first sample [m]."""


class KilometreMark(InputTable):
    """Passing of a kilometre mark by the first pantograph."""

    time_s: float
    """Time of the passing, as in the channel time_s [s]."""
    km: Annotated[float, Field(ge=-10000, le=10000)]
    """Kilometre of the line."""


class MarkPosition(InputTable):
    """Position from the times at which the first pantograph passes kilometre marks, interpolated between them."""

    kind: Literal["marks"]
    mark: Annotated[tuple[KilometreMark, ...], Field(strict=False, min_length=2, max_length=10000)]
    """Passings of kilometre marks in order of time."""

    @cross_check
    def _check_order(self) -> Problems:
        if any(later.time_s <= earlier.time_s for earlier, later in pairwise(self.mark)):
            yield validation_problem("mark", "the times do not increase", "List the marks in the order of time.")


PositionTable = Annotated[PulsePosition | MarkPosition, Discriminator("kind")]


# Tables `event` and `event_channel` of a sidecar: places of the line that a measurement passes.
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
            found = "missing" if self.from_m is None else "given twice"
            yield validation_problem("from_m", f"the place is {found}", "Give from_m or from_km.")
        elif (self.to_m is not None and self.from_m is None) or (self.to_km is not None and self.from_km is None):
            yield validation_problem("to_m", "the ends differ in unit", "Give both ends in metres or in kilometres.")
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


# Table `arc` of a sidecar: arc detector and current of a pantograph.
LOADED_SHARE = 0.3
"""Share of the nominal current above which time counts for the arc share: EN 50317, by secondary sources."""


class ArcTable(InputTable):
    """Arc detector of one pantograph; an arc lasts while its number exceeds a level."""

    pantograph: Annotated[int, Field(ge=1, le=20)]
    """Number of the pantograph in running order."""
    detector: FileColumnName
    """Column of the arc detector."""
    above: float
    """Level that the number of the detector exceeds during an arc."""
    current: ColumnTable | None = None
    """Current of the pantograph."""
    nominal_current_A: Annotated[Positive | None, Field(le=1e5)] = None
    """Nominal current [A]."""

    @cross_check
    def _check_current(self) -> Problems:
        if (self.current is None) != (self.nominal_current_A is None):
            yield validation_problem(
                "current",
                f"{'nominal_current_A' if self.current else 'current'} is missing",
                "Give both; without them there is no arc share.",
            )

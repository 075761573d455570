"""Sidecar of a contact-force record: the TOML file beside its table of samples."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from pantocheck.conformance.core.input_error import suggest_names
from pantocheck.conformance.core.sourced_table import (
    NumberList,
    PositiveList,
    Problems,
    cross_check,
    validation_problem,
)
from pantocheck.conformance.core.table_sidecar import TableName, find_table_name_problems
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.units import suggest_key
from pantocheck.conformance.records.column_values import ColumnSource, SensorSum
from pantocheck.conformance.records.record import CHANNELS, FORCE_CHANNELS, find_column
from pantocheck.conformance.records.sidecar_tables import (
    ArcTable,
    EventChannel,
    EventTable,
    KilometreTable,
    MarkPosition,
    MeasurementTable,
    PassageTable,
    PositionTable,
)
from pantocheck.conformance.records.source_tables import ColumnFile, SourceTable

RECORD_SCHEMA = "pantocheck.record/1"

CLOSEST_SUPPORTS_M = 0.5
"""Smallest distance of two supports [m]."""


class RecordSidecar(PassageTable, ColumnFile):
    """Sidecar of a table of samples."""

    schema_: Annotated[Literal["pantocheck.record/1"], Field(alias="schema")]
    """Version of the format: "pantocheck.record/1"."""
    changes: Annotated[tuple[str, ...], Field(strict=False, max_length=100)] = ()
    """Inputs of the case that were changed with --set."""
    source: Annotated[tuple[SourceTable, ...], Field(strict=False, max_length=200)] = ()
    """Further files of the record, or columns of a file with another rate, each with its own clock."""
    measurement: MeasurementTable | None = None
    """Line, track and date, for `pantocheck runs import`."""
    track: KilometreTable | None = None
    """Kilometres of the line, if the positions are kilometres."""
    position: PositionTable | None = None
    """Position from distance pulses or kilometre marks, if not in a column."""
    event: Annotated[tuple[EventTable, ...], Field(strict=False, max_length=10000)] = ()
    """Places of the line, such as overlaps and tunnels."""
    event_channel: Annotated[tuple[EventChannel, ...], Field(strict=False, max_length=20)] = ()
    """Columns of the file that mark such places."""
    arc: Annotated[tuple[ArcTable, ...], Field(strict=False, max_length=20)] = ()
    """Arc detectors of the pantographs."""
    pantographs: Annotated[int, Field(ge=1, le=20)]
    """Number of pantographs."""
    filter_applied_Hz: float | Literal["none"]
    """Cut-off of the low-pass filter applied to the force before delivery [Hz], or "none"."""
    start_m: float | None = None
    """Position of the first pantograph at the first sample, if not in the table [m]."""
    spacing_m: Annotated[PositiveList | None, Field(max_length=19)] = None
    """Distances between successive pantographs in running order, if not in the table [m]."""
    support_position_m: NumberList | None = None
    """Positions of the supports with an uplift, in the order of the table [m]."""
    evaluated_km: Annotated[NumberList | None, Field(min_length=2, max_length=2)] = None
    """Ends of the analysis section as kilometres of the line, instead of evaluated_m."""
    support_km: NumberList | None = None
    """Kilometres of these supports, instead of support_position_m."""
    shapes: TableName | None = None
    """HDF5 file beside the sidecar with shapes of the wires, for the moving picture; it is not graded."""

    @cross_check
    def _check_shapes(self) -> Problems:
        if self.shapes is not None:
            yield from find_table_name_problems(self.shapes, "shapes")

    @cross_check
    def _check_kilometres(self) -> Problems:
        pairs = {
            "evaluated_km": ("evaluated_m", self.evaluated_m),
            "support_km": ("support_position_m", self.support_position_m),
        }
        for key, (other, metres) in pairs.items():
            if getattr(self, key) is None:
                continue
            if self.track is None:
                hint = "State zero_km and kilometres in [track]."
                yield validation_problem(key, "the table track is missing", hint)
            if metres is not None:
                yield validation_problem(key, f"{other} gives the same", f"Leave out {key} or {other}.")
        places = sorted(self.support_position_m or ())
        if any(later - earlier < CLOSEST_SUPPORTS_M for earlier, later in pairwise(places)):
            found = f"two supports are less than {CLOSEST_SUPPORTS_M:g} m apart"
            yield validation_problem("support_position_m", found, "Give metres, or the kilometres as support_km.")

    @model_validator(mode="after")
    def _place_kilometres(self) -> Self:
        """Positions x of the section and the supports from their kilometres."""
        if self.track is None or (self.evaluated_km is None and self.support_km is None):
            return self
        changes: dict[str, object] = {"evaluated_km": None, "support_km": None}
        if self.evaluated_km is not None:
            changes["evaluated_m"] = tuple(sorted(map(self._place, self.evaluated_km)))
        if self.support_km is not None:
            changes["support_position_m"] = tuple(map(self._place, self.support_km))
        return self.model_copy(update=changes)

    def _place(self, kilometre: float) -> float:
        """Position x of a kilometre, to a tenth of a millimetre [m]."""
        assert self.track is not None  # required by the cross check
        return round(self.track.place(kilometre), 4)

    @cross_check
    def _check_consistency(self) -> Problems:
        if self.low_passed_Hz is not None and self.low_passed_Hz <= 0:
            yield validation_problem(
                "filter_applied_Hz",
                f"found {self.low_passed_Hz:g} Hz, expected a positive cut-off",
                'Write filter_applied_Hz = "none" for an unfiltered force.',
            )
        if self.spacing_m is not None and len(self.spacing_m) != self.pantographs - 1:
            yield validation_problem(
                "spacing_m",
                f"{count_noun(len(self.spacing_m), 'distance')} for {count_noun(self.pantographs, 'pantograph')}",
                "Give the distances between successive pantographs, in running order.",
            )

        names = () if self.measurement is None else self.measurement.pantograph_names
        if names and len(set(names)) != self.pantographs:
            found = f"{count_noun(len(set(names)), 'different name')} for {count_noun(self.pantographs, 'pantograph')}"
            yield validation_problem("measurement.pantograph_names", found, "Name each pantograph, or none.")

    @cross_check
    def _check_columns(self) -> Problems:
        yield from self._find_column_problems("", self.columns)
        for number, source in enumerate(self.source, 1):
            yield from self._find_column_problems(f"source[{number}].", source.columns)

    def _find_column_problems(self, table: str, columns: Mapping[str, ColumnSource] | None) -> Problems:
        for name in columns or ():
            meaning = find_column(name, 1)
            known = [channel.column(1) for channel in CHANNELS.values()]
            if meaning is None or meaning.factor != 1 or meaning.channel.column(meaning.number) != name:
                hint = suggest_key(name, None, known) or suggest_names(name, known)
                yield validation_problem(f"{table}columns.{name[:80]}", "not a channel of a record in SI units", hint)
            elif meaning.number > self.rows(meaning.channel.per):
                yield validation_problem(
                    f"{table}columns.{name}",
                    f"the sidecar has no {meaning.channel.per} {meaning.number}",
                    "Correct pantographs or support_position_m, or remove the channel.",
                )

    @cross_check
    def _check_sensors(self) -> Problems:
        for name, source in (self.columns or {}).items():
            meaning = find_column(name, 1)
            if isinstance(source, SensorSum) and (meaning is None or meaning.channel.name not in FORCE_CHANNELS):
                yield validation_problem(
                    f"columns.{name[:80]}.sum", "sensors are summed to a force only", "Give column and unit."
                )

    @cross_check
    def _check_events(self) -> Problems:
        for i, event in enumerate(self.event, 1):
            if event.from_km is not None and self.track is None:
                yield validation_problem(
                    f"event[{i}].from_km", "the table track is missing", "State zero_km and kilometres in [track]."
                )

    @cross_check
    def _check_arcs(self) -> Problems:
        numbers = [arc.pantograph for arc in self.arc]
        if len(set(numbers)) < len(numbers) or any(number > self.pantographs for number in numbers):
            yield validation_problem(
                "arc", f"found the pantographs {numbers}", f"Give one table for each of the {self.pantographs} at most."
            )

    @cross_check
    def _check_position(self) -> Problems:
        if self.position is None:
            return
        if any(name.startswith("position_") for name in self.columns or ()):
            yield validation_problem(
                "position", "the table columns gives the position as well", "Remove the table position, or the column."
            )
        if self.position.kind == "marks":
            yield from self._find_mark_problems(self.position)

    def _find_mark_problems(self, position: MarkPosition) -> Problems:
        if self.track is None:
            yield validation_problem(
                "track", "missing, but needed for kilometre marks", "State zero_km and kilometres in [track]."
            )
            return
        places = [self.track.place(mark.km) for mark in position.mark]
        if any(later <= earlier for earlier, later in pairwise(places)):
            yield validation_problem(
                "position.mark",
                f"the kilometres are not {self.track.kilometres}",
                "Correct the marks, or kilometres in [track].",
            )

    @property
    def behind(self) -> tuple[float, ...]:
        """Distance of each pantograph behind the first one [m]; 0 if the sidecar states no spacing."""
        spacing = self.spacing_m or (0.0,) * (self.pantographs - 1)
        return tuple(float(sum(spacing[:i])) for i in range(self.pantographs))

    @property
    def low_passed_Hz(self) -> float | None:
        """Cut-off of the low-pass filter applied before delivery [Hz]; None: unfiltered."""
        return None if isinstance(self.filter_applied_Hz, str) else self.filter_applied_Hz

    def rows(self, per: str) -> int:
        """Number of rows of a channel with one row per `pantograph`, `support` or `record`."""
        return {
            "record": 1,
            "pantograph": self.pantographs,
            "support": len(self.support_position_m or self.support_km or ()),
        }[per]

"""Positions of a record from kilometres, distance pulses or kilometre marks, in running direction."""

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import MeasuredTable
from pantocheck.conformance.records.logger.arc_tables import LOADED_SHARE, ArcTable
from pantocheck.conformance.records.logger.column_values import TIME_COLUMN, FileColumns
from pantocheck.conformance.records.logger.mapped_rows import list_used_columns
from pantocheck.conformance.records.logger.track_position import (
    PulsesUnusable,
    count_distance,
    interpolate_marks,
    pulse_distance,
)
from pantocheck.conformance.records.logger.track_tables import (
    CounterPosition,
    KilometreTable,
    MarkPosition,
    PulsePosition,
)
from pantocheck.conformance.records.record_channels import ChannelRows
from pantocheck.conformance.records.record_sidecar import RecordSidecar

EVENTS, ARCING, LOADED = "event_level", "arcing", "loaded"
"""Names of the channels of events, arcs and time under load among the rows."""

MARKS = frozenset({EVENTS, ARCING, LOADED})


def list_further_columns(sidecar: RecordSidecar) -> tuple[str, ...]:
    """Columns of distance pulses, events, arcs and currents, if the sidecar names them."""
    pulses = () if sidecar.position is None or sidecar.position.kind == "marks" else (sidecar.position.column,)
    currents = (arc.current.column for arc in sidecar.arc if arc.current is not None)
    events = (channel.column for channel in sidecar.event_channel)
    return (*pulses, *events, *(arc.detector for arc in sidecar.arc), *currents)


def list_used_channels(sidecar: RecordSidecar) -> tuple[str, ...]:
    """Names of all columns of the file that the sidecar uses."""
    names = dict.fromkeys((*list_used_columns(sidecar.columns or {}), *list_further_columns(sidecar)))
    return tuple(name for name in names if name != TIME_COLUMN)


def place_rows(rows: ChannelRows, table: MeasuredTable, sidecar: RecordSidecar, where: str) -> None:
    """Add or convert the rows of the position.

    Args:
        rows: Rows of each channel by number from 1; changed in place.
        table: Table in the units of the file.
        sidecar: Sidecar of the record.
        where: Name of the sidecar in messages.

    Raises:
        InputError: The pulses are not usable, or marks need a time that the record lacks.
    """
    if sidecar.position is not None:
        if "position" in rows:
            raise InputError(
                f"{where}, key position", "the file has a position, too", "Remove the table position, or the column."
            )
        rows["position"] = {1: _find_position(sidecar.position, rows, table, sidecar.track, where)}
    if sidecar.event_channel:
        file = FileColumns(table, where)
        indices = [file.find(channel.column, "event_channel.column") for channel in sidecar.event_channel]
        rows[EVENTS] = {number: table.values[:, index] for number, index in enumerate(indices, 1)}
    for arc in sidecar.arc:
        rows.setdefault(ARCING, {})[arc.pantograph], rows.setdefault(LOADED, {})[arc.pantograph] = _read_arc(
            arc, FileColumns(table, where)
        )
    if sidecar.position is None and sidecar.track is not None and "position" in rows:
        zero = 1000 * sidecar.track.zero_km
        for number, values in rows["position"].items():
            rows["position"][number] = sidecar.track.direction * (values - zero)


def _read_arc(arc: ArcTable, file: FileColumns) -> tuple[RealArray, RealArray]:
    """Arcs, and time under load, as 1, 0 or NaN for a missing value."""
    level = file.table.values[:, file.find(arc.detector, "arc.detector")]
    arcing = np.where(np.isfinite(level), level > arc.above, np.nan)
    if arc.current is None or arc.nominal_current_A is None:
        return arcing, np.full(level.size, np.nan)
    current = np.abs(file.read(arc.current, "A", "arc.current"))
    return arcing, np.where(np.isfinite(current), current > LOADED_SHARE * arc.nominal_current_A, np.nan)


def _find_position(
    source: CounterPosition | PulsePosition | MarkPosition,
    rows: ChannelRows,
    table: MeasuredTable,
    track: KilometreTable | None,
    where: str,
) -> RealArray:
    """Position of the first pantograph [m]."""
    if isinstance(source, MarkPosition):
        if "time" not in rows or track is None:
            raise InputError(f"{where}, key position.mark", "needs the channel time_s", "Name its column in [columns].")
        places = np.array([track.place(mark.km) for mark in source.mark])
        return interpolate_marks(rows["time"][1], np.array([mark.time_s for mark in source.mark]), places)
    file = FileColumns(table, where)
    values = table.values[:, file.find(source.column, "position.column")]
    try:
        find = count_distance if isinstance(source, CounterPosition) else pulse_distance
        return source.start_m + find(values, source.metres_per_pulse)
    except PulsesUnusable as error:
        raise InputError(
            f"{where}, key position.column", str(error), "Cut the record, or place it by marks or by the speed."
        ) from None

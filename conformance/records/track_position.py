"""Position of a train from distance pulses and kilometre marks."""

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import MeasuredTable
from pantocheck.conformance.records.column_values import TIME_COLUMN, FileColumns, list_used_columns
from pantocheck.conformance.records.record import ChannelRows
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.sidecar_tables import (
    LOADED_SHARE,
    ArcTable,
    KilometreTable,
    MarkPosition,
    PulsePosition,
)
from pantocheck.conformance.records.source_tables import PulseJoin

FEWEST_PULSES = 2
"""Smallest number of pulses that gives a speed."""

LONGEST_EXTRAPOLATION = 1.0
"""Longest extrapolation beyond the first and last pulse, in intervals of two pulses; the next pulse would be known."""

RISING, FALLING = 0.6, 0.4
"""Levels of a rising and a falling edge as shares of the range of a pulse train; noise between them is not a pulse."""


class PulsesUnusable(ValueError):
    """Pulses that give no position; a guessed distance would shift every place of the record."""


def count_distance(count: RealArray, metres_per_pulse: float) -> RealArray:
    """Distance from the first sample, from a counter of pulses.

    A counter stands still between two pulses. The distance is interpolated between the samples at which it changes.

    Args:
        count: Reading of the counter, increasing or decreasing, (n,) [pulses].
        metres_per_pulse: Distance per pulse [m].

    Returns:
        Distance, (n,) [m], 0 at the first sample; NaN where the train stands before the first or after the last pulse.

    Raises:
        PulsesUnusable: The counter runs forwards and backwards, has gaps, or counts fewer than two pulses.
    """
    if not np.isfinite(count).all():
        raise PulsesUnusable(f"sample {int(np.argmin(np.isfinite(count))) + 1} of the counter is missing")
    steps = np.diff(count)
    backwards = np.flatnonzero(steps * (count[-1] - count[0]) < 0)
    if backwards.size:
        raise PulsesUnusable(f"the counter runs backwards at sample {backwards[0] + 2}")
    changes = np.flatnonzero(steps) + 1
    if changes.size < FEWEST_PULSES:
        raise PulsesUnusable(f"the counter counts {changes.size} pulses; at least {FEWEST_PULSES} are needed")
    travelled = np.abs(count[changes] - count[0]) * metres_per_pulse
    return _interpolate_from_start(changes.astype(np.float64), travelled, count.size)


def pulse_distance(signal: RealArray, metres_per_pulse: float) -> RealArray:
    """Distance from the first sample, from the rising edges of a pulse train; parameters as in `count_distance`.

    Raises:
        PulsesUnusable: As `find_rising_edges`; or there is more than one edge in two samples.
    """
    crossing = find_rising_edges(signal)
    if np.median(np.diff(crossing)) <= 2:
        raise PulsesUnusable("the pulse train has about one edge in two samples: pulses may be lost")
    return _interpolate_from_start(crossing, np.arange(crossing.size, dtype=np.float64) * metres_per_pulse, signal.size)


def find_rising_edges(signal: RealArray) -> RealArray:
    """Samples at which a pulse train rises, (k,), interpolated between two samples.

    Raises:
        PulsesUnusable: The signal is missing or constant, or has fewer than two edges.
    """
    if not np.isfinite(signal).all():
        raise PulsesUnusable("values of the pulse train are missing")
    if np.ptp(signal) == 0:
        raise PulsesUnusable("the pulse train is constant")
    level = (signal - signal.min()) / np.ptp(signal)
    state = np.where(level >= RISING, 1.0, np.where(level <= FALLING, 0.0, np.nan))
    known = np.flatnonzero(np.isfinite(state))
    edges = known[1:][(state[known[1:]] == 1) & (state[known[:-1]] == 0)]
    if edges.size < FEWEST_PULSES:
        raise PulsesUnusable(f"the pulse train has {edges.size} rising edges; at least {FEWEST_PULSES} are needed")
    before, after = level[edges - 1], level[edges]
    return np.asarray(edges - (after - RISING) / np.maximum(after - before, 1e-12))


def _interpolate_from_start(index: RealArray, travelled: RealArray, size: int) -> RealArray:
    """Distance at every sample, 0 at the first one, from distances at (fractional) samples."""
    samples = np.arange(size, dtype=np.float64)
    distance = np.interp(samples, index, travelled, left=np.nan, right=np.nan)
    for first, second, outside in ((0, 1, samples < index[0]), (-1, -2, samples > index[-1])):
        interval = abs(index[first] - index[second])
        slope = (travelled[first] - travelled[second]) / (index[first] - index[second])
        near = outside & (np.abs(samples - index[first]) <= LONGEST_EXTRAPOLATION * interval)
        distance[near] = travelled[first] + slope * (samples[near] - index[first])
    begin = int(np.argmax(np.isfinite(distance)))
    return np.asarray(distance - distance[begin])


def interpolate_marks(time: RealArray, mark_time: RealArray, mark_position: RealArray) -> RealArray:
    """Position between marks by monotone cubics; NaN before the first and after the last mark.

    Args:
        time: Time of the samples, (n,) [s].
        mark_time, mark_position: Times [s] and positions [m] of the marks, both increasing, (k,).

    Returns:
        Position, (n,) [m].
    """
    from scipy.interpolate import PchipInterpolator  # a list of cases does not wait for it

    return np.asarray(PchipInterpolator(mark_time, mark_position, extrapolate=False)(time))


# Positions of a record from kilometres, distance pulses or kilometre marks, in running direction.
EVENTS, ARCING, LOADED = "event_level", "arcing", "loaded"
"""Names of the channels of events, arcs and time under load among the rows."""

MARKS = frozenset({EVENTS, ARCING, LOADED})


def list_further_columns(sidecar: RecordSidecar) -> tuple[str, ...]:
    """Columns of distance pulses, events, arcs and currents, if the sidecar names them."""
    pulses = () if sidecar.position is None or sidecar.position.kind == "marks" else (sidecar.position.column,)
    currents = (arc.current.column for arc in sidecar.arc if arc.current is not None)
    events = (channel.column for channel in sidecar.event_channel)
    seconds = (join.record_column for source in sidecar.source if isinstance(join := source.join, PulseJoin))
    return (*pulses, *events, *(arc.detector for arc in sidecar.arc), *currents, *seconds)


def list_used_channels(sidecar: RecordSidecar) -> tuple[str, ...]:
    """Names of all columns of the file that the sidecar uses."""
    names = dict.fromkeys((*list_used_columns(sidecar.columns or {}), *list_further_columns(sidecar)))
    return tuple(name for name in names if name != TIME_COLUMN)


def complete_position_rows(rows: ChannelRows, table: MeasuredTable, sidecar: RecordSidecar, where: str) -> None:
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
    if sidecar.position is None:
        convert_kilometres(rows, sidecar.track)


def convert_kilometres(rows: ChannelRows, track: KilometreTable | None) -> None:
    """Convert positions that are kilometres of the line to positions in running direction [m], in place."""
    if track is not None:
        for number, values in rows.get("position", {}).items():
            rows["position"][number] = track.direction * (values - 1000 * track.zero_km)


def _read_arc(arc: ArcTable, file: FileColumns) -> tuple[RealArray, RealArray]:
    """Arcs, and time under load, as 1, 0 or NaN for a missing value."""
    level = file.table.values[:, file.find(arc.detector, "arc.detector")]
    arcing = np.where(np.isfinite(level), level > arc.above, np.nan)
    if arc.current is None or arc.nominal_current_A is None:
        return arcing, np.full(level.size, np.nan)
    current = np.abs(file.read(arc.current, "A", "arc.current"))
    return arcing, np.where(np.isfinite(current), current > LOADED_SHARE * arc.nominal_current_A, np.nan)


def _find_position(
    source: PulsePosition | MarkPosition,
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
        find = count_distance if source.kind == "counter" else pulse_distance
        return source.start_m + find(values, source.metres_per_pulse)
    except PulsesUnusable as error:
        raise InputError(
            f"{where}, key position.column", str(error), "Cut the record, or place it by marks or by the speed."
        ) from None

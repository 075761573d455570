"""Reading of the further sources of a record: their channels, and the ties of their clocks to that of the record."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.measured_table import MeasuredTable
from pantocheck.conformance.core.table_sidecar import locate_table
from pantocheck.conformance.quantities.line_signals import SUPPORT_TOLERANCE_M
from pantocheck.conformance.records.clock_join import Clock, fit_clock
from pantocheck.conformance.records.column_values import FileColumns
from pantocheck.conformance.records.record import CHANNELS, ChannelRows
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.sidecar_tables import KilometreTable, MarkPosition
from pantocheck.conformance.records.source_alignment import GAP_STEPS, RecordSources, SourceSamples
from pantocheck.conformance.records.source_tables import (
    SOURCE_CHANNELS,
    PassageJoin,
    PulseJoin,
    SourceTable,
    TimeJoin,
    list_source_columns,
)
from pantocheck.conformance.records.table_rows import find_impossible_values, read_rows, read_single_table
from pantocheck.conformance.records.track_position import (
    RISING,
    PulsesUnusable,
    convert_kilometres,
    find_rising_edges,
    interpolate_marks,
)

LONGEST_GAPS_S = {"position": 1.0, "speed": 1.0, "force": None}
"""Longest gap that is interpolated [s]: the averaging time of the speed; of a force, none."""

SAME_RATE_SHARE = 0.01
"""Largest difference of the rates of two forces [-]: a slower one has a smaller band, a faster one is aliased."""

SECOND_TOLERANCE_S = 0.4
"""Largest difference of two pulses of the same second, by the stated offset [s]."""

COPIED = {"uplift": "support", "force": "pantograph"}
"""Channels whose samples are never equal at two supports or pantographs."""

FEWEST_TIES = 2
"""Smallest number of seconds or marks that join two clocks: one alone may be a disturbance."""


def read_sources(sidecar_path: Path, sidecar: RecordSidecar, table: MeasuredTable, rows: ChannelRows) -> RecordSources:
    """Read the further sources of a record.

    Args:
        sidecar_path: Path of the sidecar.
        sidecar: The sidecar.
        table: First file of the record.
        rows: Its channels.

    Raises:
        InputError: A file cannot be read, or lacks a channel; a channel is in two sources; a clock cannot be joined.
    """
    if not sidecar.source:
        return RecordSources()
    if "time" not in rows:
        found = "needs the time of the first file, which has none"
        raise InputError(f"sidecar '{sidecar_path.name}', key source", found, "Name its column: time_s in [columns].")
    uplift, added, clocks, taken = list[SourceSamples](), ChannelRows(), list[tuple[str, str, Clock]](), dict(rows)
    uplifts = {CHANNELS["uplift"].column(k): (table.source, row) for k, row in rows.get("uplift", {}).items()}
    for number, source in enumerate(sidecar.source, 1):
        where = f"sidecar '{sidecar_path.name}', source[{number}]"
        repeated = sum(other.file == source.file for other in (sidecar, *sidecar.source)) > 1
        name = f"{source.file} (source {number})" if repeated else source.file
        path, used = locate_table(sidecar_path, source.file, source.sha256), list_source_columns(source)
        own_table = read_single_table(path, source, used)
        own, errors = read_rows(own_table, source, sidecar, used if source.columns is None else (), where)
        for channel, numbered in own.items():
            errors += find_impossible_values(channel, numbered, f"record '{name}'")
        if errors:
            raise join_errors(errors)
        convert_kilometres(own, sidecar.track)
        _check_channels(own, taken, where, name)
        time, kept = _find_time(own, where, name)
        own = {channel: {k: values[kept] for k, values in numbered.items()} for channel, numbered in own.items()}
        clock = _join(source, _FirstFile(table, rows["time"][1]), own_table, kept, own, sidecar.track, where)
        if "uplift" in own:
            places = np.array([(sidecar.support_position_m or ())[k - 1] for k in sorted(own["uplift"])])
            values = np.vstack([own["uplift"][k] for k in sorted(own["uplift"])])
            uplift.append(SourceSamples(name, source.join.kind, time, places, values, clock))
            columns = {CHANNELS["uplift"].column(k): (name, row) for k, row in sorted(own["uplift"].items())}
            refuse_copies("uplift", columns, uplifts, where)
            uplifts |= columns
        if "force" in own:
            _check_rate(time, rows["time"][1], where, name)
        for channel, longest_s in LONGEST_GAPS_S.items():
            for k, values in own.get(channel, {}).items():
                gap = longest_s or GAP_STEPS * float(np.median(np.diff(time)))
                added.setdefault(channel, {})[k] = _resample(rows["time"][1], clock.convert(time), values, gap)
                clocks.append((name, source.join.kind, clock))
        for channel, numbered in own.items():
            taken[channel] = {**taken.get(channel, {}), **numbered}
    return RecordSources(tuple(uplift), added, tuple(dict.fromkeys(clocks)))


def _check_channels(own: ChannelRows, taken: ChannelRows, where: str, name: str) -> None:
    """Refuse channels that do not belong to a further source, or are in another one, and a source without a channel."""
    for channel, found in own.items():
        if channel not in SOURCE_CHANNELS:
            hint = "Give it with the first file of the record, or name the columns of the source in [source.columns]."
            raise InputError(f"{where}, {name}", f"has the channel {CHANNELS[channel].key}", hint)
        if channel != "time" and (repeated := found.keys() & taken.get(channel, {}).keys()):
            column = CHANNELS[channel].column(min(repeated))
            raise InputError(f"{where}, {name}", f"repeats the channel {column} of another source", "Name it once.")
    if not own.keys() - {"time"}:
        raise InputError(f"{where}, {name}", "has no channel beside the time", "Name its columns in [source.columns].")


def refuse_copies(
    channel: str, own: Mapping[str, tuple[str, RealArray]], others: Mapping[str, tuple[str, RealArray]], where: str
) -> None:
    """Refuse an uplift or force with the samples of another one; both by column, with the name of the source."""
    seen = dict(others)
    for column, (name, values) in own.items():
        for other, (file, known) in seen.items():
            if np.array_equal(values, known, equal_nan=True) and np.unique(values[np.isfinite(values)]).size > 1:
                found = f"{column} of {name} has the same samples as {other} of {file}, at another {COPIED[channel]}"
                hint = f"Name the file and column that was recorded at each {COPIED[channel]}."
                raise InputError(where, found, hint)
        seen[column] = name, values


def _find_time(own: ChannelRows, where: str, name: str) -> tuple[RealArray, RealArray]:
    """Time of a source [s], and the samples that have one."""
    if "time" not in own:
        hint = "Name its column: time_s in [source.columns]."
        raise InputError(f"{where}, {name}", "has no time", hint)
    kept = np.isfinite(own["time"][1])
    time = own["time"][1][kept]
    if time.size < 2:
        raise InputError(f"{where}, {name}", f"has {time.size} samples with a time", "Export the file again.")
    if (np.diff(time) <= 0).any():
        sample = int(np.argmax(np.diff(time) <= 0)) + 2
        found = f"the time of sample {sample} is not greater than that of the sample before"
        raise InputError(f"{where}, {name}", found, "Cut the file there, or correct the time.")
    return time, kept


def _check_rate(time: RealArray, record_time: RealArray, where: str, name: str) -> None:
    """Refuse a force with another rate than that of the first file."""
    rates = [1 / float(np.median(np.diff(part[np.isfinite(part)]))) for part in (time, record_time)]
    if abs(rates[0] / rates[1] - 1) > SAME_RATE_SHARE:
        found = f"has a force with {rates[0]:.6g} samples per second, and the first file {rates[1]:.6g}"
        raise InputError(f"{where}, {name}", found, "Export both forces with the same rate.")


def _resample(time: RealArray, own: RealArray, values: RealArray, longest_gap: float) -> RealArray:
    """Channel at the times of the first file; NaN outside of the source and in gaps longer than `longest_gap` [s]."""
    known = np.isfinite(values)
    if known.sum() < 2:
        return np.full(time.size, np.nan)
    found = interpolate_marks(time, own[known], values[known])
    index = np.clip(np.searchsorted(own[known], time), 1, known.sum() - 1)
    gap = own[known][index] - own[known][index - 1]
    return np.where(gap > longest_gap, np.nan, found)


@dataclass(frozen=True)
class _FirstFile:
    """Table of the first file, and its time (n,) [s]."""

    table: MeasuredTable
    time: RealArray


def _join(
    source: SourceTable,
    first: _FirstFile,
    table: MeasuredTable,
    kept: RealArray,
    own: ChannelRows,
    track: KilometreTable | None,
    where: str,
) -> Clock:
    """Clock of a source; of a passage, the stated offset and the range of the search."""
    join, time = source.join, own["time"][1]
    match join:
        case TimeJoin():
            return Clock(join.offset_s, join.uncertainty_s)
        case PassageJoin():
            if "uplift" not in own:
                hint = "Join a source without uplift by time, pps or marks."
                found = "a passage shows in the uplift, which the source lacks"
                raise InputError(f"{where}, key join.kind", found, hint)
            return Clock(join.offset_s, join.within_s)
        case PulseJoin():
            known = np.isfinite(first.time)
            record_time, record = first.time[known], FileColumns(first.table, where)
            edges = _find_edges(FileColumns(table, where), join.column, "join.column", time, kept)
            others = _find_edges(record, join.record_column, "join.record_column", record_time, known)
            ties = list(_pair_seconds(edges, others, join.offset_s))
            # A pulse rises between two samples, in all seconds at the same place if the rate is a whole number.
            steps = [float(np.median(np.diff(part))) for part in (time, record_time)]
            scatter, common = max(steps) / np.sqrt(12), RISING * sum(steps)
        case MarkPosition():
            if track is None or "position" not in own:
                found = "kilometre marks need the table track, and the position in the source"
                raise InputError(f"{where}, key join.kind", found, "Give both, or join by time.")
            ties = list(_pair_marks(join, time, own["position"], track))
            speed = float(np.median(np.abs(np.gradient(own["position"][min(own["position"])], time))))
            scatter, common = SUPPORT_TOLERANCE_M / max(speed, 1.0), 0.0
    if len(ties) < FEWEST_TIES:
        found = f"source and record share {len(ties)} pulses or marks, expected at least {FEWEST_TIES}"
        raise InputError(f"{where}, key join", found, "Correct offset_s or the marks, or join by time.")
    times = np.array(ties).T
    return fit_clock(times[0], times[1], scatter, common)


def _find_edges(file: FileColumns, column: str, key: str, time: RealArray, kept: RealArray) -> RealArray:
    """Times of the rising edges of a column of pulses [s]."""
    signal = file.table.values[:, file.find(column, key)][kept]
    try:
        edges = find_rising_edges(signal)
    except PulsesUnusable as error:
        hint = "Name the column with one pulse at each full second."
        raise InputError(f"{file.where}, key {key}", str(error), hint) from None
    return np.interp(edges, np.arange(time.size), time)


def _pair_seconds(edges: RealArray, others: RealArray, offset: float) -> Iterator[tuple[float, float]]:
    """Times in the source and in the record of each second that both have."""
    for edge in edges:
        nearest = others[np.argmin(np.abs(others - edge - offset))]
        if abs(nearest - edge - offset) <= SECOND_TOLERANCE_S:
            yield float(edge), float(nearest)


def _pair_marks(
    join: MarkPosition, time: RealArray, position: dict[int, RealArray], track: KilometreTable
) -> Sequence[tuple[float, float]]:
    """Times in the source and in the record of each kilometre mark that the source passes."""
    known = np.isfinite(position[1])
    places = np.array([track.place(mark.km) for mark in join.mark])
    own = np.interp(places, position[1][known], time[known], left=np.nan, right=np.nan)
    return [(float(a), mark.time_s) for a, mark in zip(own, join.mark, strict=True) if np.isfinite(a)]

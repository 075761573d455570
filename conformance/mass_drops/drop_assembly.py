"""From columns of numbers and what is said about them to records, every doubt checked on the way."""

from dataclasses import dataclass, field

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.channel_units import convert_unit, parse_direction
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_record import (
    DropChannel,
    DropDescription,
    DropLine,
    DropRecord,
    MotionQuantity,
)
from pantocheck.conformance.mass_drops.drop_sidecar import DropChannelTable, DropSidecar

LEAST_SAMPLES = 16
RATE_TOLERANCE = 1e-3
LARGEST_ACCELERATION = 500.0  # [m/s2]; a wire that loses 40 kg stays an order of magnitude below
SAME_EXTREMES = 4  # so many samples in a row on the very same extreme are a flat top, not a peak


@dataclass(frozen=True)
class DropColumn:
    """What a file itself says of a column; what it does not say is None."""

    name: str | None = None
    unit: str | None = None
    table: DropChannelTable | None = None


@dataclass(frozen=True)
class DropColumns:
    """One run as a file holds it.

    Parameters
    ----------
    values : (n, c) ndarray
        In the file's units.
    columns : tuple[DropColumn, ...]
        (c,) what the file says of them.
    time : (n,) ndarray or None
        Time column [s] if the file has one.
    rate : float or None
        Samples per second that the file states [Hz].
    title : str
        Name of the test.
    run : int
        Which of several runs of the file, from 1; 0 if the file holds one.
    drop, line : DropDescription or DropLine
        As far as the file tells.
    """

    values: RealArray
    columns: tuple[DropColumn, ...]
    time: RealArray | None = None
    rate: float | None = None
    title: str = ""
    run: int = 0
    drop: DropDescription = field(default_factory=DropDescription)
    line: DropLine = field(default_factory=DropLine)


def assemble_drop_records(table: DropColumns, sidecar: DropSidecar | None, source: str) -> DropRecord:
    """A record in SI units.

    Parameters
    ----------
    table : DropColumns
        One run.
    sidecar : DropSidecar or None
        What stands beside it; wins over the file where the two can both speak, and must not contradict it.
    source : str
        Name of the file, for messages.

    Raises
    ------
    InputError
        Anything that would turn into a wrong number.
    """
    n, width = table.values.shape
    if n < LEAST_SAMPLES:
        raise InputError(source, f"only {n} samples", "Export the whole record, from rest to the end of the decay.")
    described = _described(table, sidecar, source)
    rate = _rate(table, sidecar, source)
    signals = np.empty((n, len(described)))
    channels, quantities, warnings = [], set[MotionQuantity](), list[str]()
    for c, channel in enumerate(described):
        where = f"{source}, channel '{channel.name}'"
        if channel.column > width:
            raise InputError(
                where,
                f"is column {channel.column}, but the file has {width}",
                "A channel is missing from the export, or the sidecar belongs to another file.",
            )
        values = table.values[:, channel.column - 1]
        _check_finite(values, rate, where)
        quantity, factor = convert_unit(channel.unit, where)
        axis, sign = parse_direction(channel.direction, where)
        signals[:, c] = values * (factor * sign)
        quantities.add(quantity)
        channels.append(DropChannel(channel.name, channel.sensor, axis, channel.wire.upper(), channel.position_m))
        warnings += _doubts(signals[:, c], quantity, rate, where)
    name = (sidecar.test.name if sidecar else "") or table.title or source
    return DropRecord(
        name=name + (f" run {table.run}" if table.run else ""),
        source=source,
        rate=rate,
        signals=signals,
        channels=tuple(channels),
        quantity=_one(quantities, sidecar, source),
        drop=_drop(table, sidecar, n / rate, source),
        line=_line(table, sidecar),
        warnings=tuple(warnings),
    )


def find_flat_tops(signal: RealArray) -> list[tuple[int, int]]:
    """Stretches [start, end) where a signal stays on its own maximum or minimum.

    A signal that never moves is not clipped but dead, and is reported as one stretch.
    """
    found = []
    for extreme in {float(signal.max()), float(signal.min())}:
        edges = np.flatnonzero(np.diff(np.concatenate([[False], signal == extreme, [False]]).astype(np.int8)))
        found += [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a >= SAME_EXTREMES]
    return sorted(found)


def find_clipping(signal: RealArray) -> list[tuple[int, int]]:
    """Flat tops [start, end) of a saturated amplifier: those far from the signal's middle.

    A converter's quiet floor also repeats its smallest value; it lies near the median.
    """
    middle, reach = np.median(signal), 0.2 * np.ptp(signal)
    return [top for top in find_flat_tops(signal) if abs(signal[top[0]] - middle) > reach]


def _described(table: DropColumns, sidecar: DropSidecar | None, source: str) -> tuple[DropChannelTable, ...]:
    width = table.values.shape[1]
    if sidecar is None:
        own = tuple(column.table for column in table.columns)
        if any(channel is None for channel in own):
            raise InputError(
                source,
                "does not say what its columns are and has no sidecar",
                "Put NAME.toml beside it, with [record] sampling_rate_hz and one [[channel]] per column.",
            )
        return tuple(channel for channel in own if channel is not None)
    declared = sidecar.record.n_channels
    if declared is not None and declared != len(sidecar.channel):
        raise InputError(
            f"sidecar of {source}",
            f"n_channels = {declared}, but {len(sidecar.channel)} channels are described",
            "Describe every column once.",
        )
    if declared is not None and width < declared:
        missing = [channel.name for channel in sidecar.channel if channel.column > width]
        raise InputError(
            source,
            f"{width} columns, the sidecar describes {declared} (missing: {', '.join(missing[:6]) or 'unknown'})",
            "A channel is missing from the export, or the sidecar belongs to another file.",
        )
    columns = [channel.column for channel in sidecar.channel]
    if len(set(columns)) < len(columns):
        twice = next(column for column in columns if columns.count(column) > 1)
        raise InputError(f"sidecar of {source}", f"column {twice} is described twice", "Describe every column once.")
    for channel in sidecar.channel:
        if channel.column <= width:
            _check_same(channel, table.columns[channel.column - 1], source)
    return sidecar.channel


def _check_same(channel: DropChannelTable, column: DropColumn, source: str) -> None:
    if column.name and column.name.strip() != channel.name.strip():
        raise InputError(
            source,
            f"column {channel.column} is headed '{column.name[:60]}', the sidecar calls it '{channel.name}'",
            "Correct the sidecar: a channel taken for another one gives wrong shapes.",
        )
    if column.unit and convert_unit(column.unit, source) != convert_unit(channel.unit, f"sidecar of {source}"):
        raise InputError(
            f"{source}, channel '{channel.name}'",
            f"the file says {column.unit}, the sidecar says {channel.unit}",
            "Correct the one that is wrong.",
        )


def _rate(table: DropColumns, sidecar: DropSidecar | None, source: str) -> float:
    stated = [
        (rate, who)
        for rate, who in (
            (sidecar.record.sampling_rate_hz if sidecar else None, "the sidecar"),
            (table.rate, "the file"),
            (_rate_of_time(table.time, source) if table.time is not None else None, "the time column"),
        )
        if rate is not None
    ]
    if not stated:
        raise InputError(source, "states no sampling rate", "Give sampling_rate_hz in a sidecar.")
    rate, who = stated[0]
    if not (np.isfinite(rate) and rate > 0):
        raise InputError(source, f"sampling rate {rate} Hz", "The rate is a positive number of samples per second.")
    for other, other_who in stated[1:]:
        if abs(other / rate - 1) > RATE_TOLERANCE:
            raise InputError(
                source,
                f"{who} says {rate:g} samples per second, {other_who} says {other:g}",
                "Every frequency is proportional to the rate: correct the one that is wrong.",
            )
    return rate


def _rate_of_time(time: RealArray, source: str) -> float:
    if not np.isfinite(time).all():
        at = int(np.flatnonzero(~np.isfinite(time))[0])
        raise InputError(source, f"time of sample {at + 1} is not a number", "Export the record again.")
    steps = np.diff(time)
    step = (time[-1] - time[0]) / (time.size - 1)
    if step <= 0:
        raise InputError(source, "the time column does not increase", "Export the record again, in order of time.")
    # Printed times are rounded; a whole missing sample is not.
    worst = int(np.argmax(np.abs(steps - step)))
    if abs(steps[worst] - step) > 0.5 * step:
        raise InputError(
            source,
            f"the time column steps by {steps[worst]:g} s after {time[worst]:g} s, elsewhere by {step:g} s",
            "The record must be sampled evenly and without gaps.",
        )
    return float(1 / step)


def _check_finite(values: RealArray, rate: float, where: str) -> None:
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise InputError(
            where,
            f"{bad.size} samples are not numbers, the first at {bad[0] / rate:g} s",
            "Export the record again, or leave this channel out of the sidecar.",
        )


def _doubts(signal: RealArray, quantity: MotionQuantity, rate: float, where: str) -> list[str]:
    if np.ptp(signal) == 0:
        raise InputError(where, "never changes", "The sensor was dead: leave this channel out of the sidecar.")
    found = []
    tops = find_clipping(signal)
    if tops:
        found.append(
            f"{where}: clipped, {len(tops)} times between {tops[0][0] / rate:.2f} s and {tops[-1][1] / rate:.2f} s"
        )
    if quantity == "acceleration" and float(np.abs(signal - np.median(signal)).max()) > LARGEST_ACCELERATION:
        found.append(f"{where}: peak of {np.abs(signal).max():.3g} m/s2; check its unit")
    return found


def _one(quantities: set[MotionQuantity], sidecar: DropSidecar | None, source: str) -> MotionQuantity:
    if len(quantities) > 1:
        raise InputError(source, f"mixes {' and '.join(sorted(quantities))}", "Give one file per kind of sensor.")
    (quantity,) = quantities
    if sidecar is not None and sidecar.record.quantity not in (None, quantity):
        raise InputError(
            f"sidecar of {source}",
            f"quantity = '{sidecar.record.quantity}', but the units are those of {quantity}",
            "Correct the quantity or the units.",
        )
    return quantity


def _drop(table: DropColumns, sidecar: DropSidecar | None, duration: float, source: str) -> DropDescription:
    drop = table.drop
    if sidecar is not None:
        said = sidecar.drop
        trigger = sidecar.record.trigger_nominal_s
        drop = DropDescription(
            said.mass_kg if said.mass_kg is not None else drop.mass,
            said.wire.upper() or drop.wire,
            said.position_m if said.position_m is not None else drop.position,
            trigger if trigger is not None else drop.trigger_nominal,
        )
    if drop.trigger_nominal is not None and drop.trigger_nominal >= duration:
        raise InputError(
            source,
            f"the trigger is at {drop.trigger_nominal:g} s, the record ends at {duration:g} s",
            "The record is cut short, or the trigger time belongs to another one.",
        )
    return drop


def _line(table: DropColumns, sidecar: DropSidecar | None) -> DropLine:
    if sidecar is None:
        return table.line
    test = sidecar.test
    return DropLine(
        test.spans_m or table.line.spans,
        test.cw_tension_n if test.cw_tension_n is not None else table.line.contact_wire_tension,
        test.mw_tension_n if test.mw_tension_n is not None else table.line.messenger_wire_tension,
    )

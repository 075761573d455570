"""Facts about the channels of a measured table: ranges, gaps, repetitions and suspicious contents."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.channel_names import find_factor, has_word, list_meanings
from pantocheck.conformance.core.measured_table import MeasuredTable, TableColumn
from pantocheck.conformance.core.units import find_key_units
from pantocheck.conformance.records.column_values import find_stated_unit
from pantocheck.conformance.records.force_checks import find_clipping
from pantocheck.conformance.records.record import CHANNELS

GAP_INTERVALS = 1.5
"""Smallest gap in the time, in median sampling intervals: a missing sample gives two."""

HELD_SHARE = 0.5
"""Share of unchanged samples from which a channel counts as recorded at a lower rate than the others."""

SELDOM_SHARE = 0.95
"""Share of unchanged samples from which a channel counts as slow or coarsely resolved: one change in twenty samples."""


@dataclass(frozen=True)
class ChannelFacts:
    """Facts about a column."""

    column: TableColumn
    """Column with its name."""
    unit: str | None
    """Unit that the file states."""
    smallest: float
    largest: float
    """Range of its numbers; NaN without a number."""
    missing: float
    """Share of missing values [-]."""
    trend: int
    """1 if its numbers never decrease, -1 if they never increase, otherwise 0."""
    remarks: tuple[str, ...]
    """Suspicious contents."""


@dataclass(frozen=True)
class TimeFacts:
    """Facts about the time of a table."""

    source: str
    """Origin of the time: a column, or the file."""
    column: TableColumn | None
    """Column of the time; None if the file holds it beside its channels."""
    rate: float
    """Sampling rate from the median interval [Hz]."""
    duration: float
    """Time from the first to the last sample [s]."""
    remarks: tuple[str, ...]
    """Gaps, repetitions and steps backwards."""
    start: float = 0.0
    """Time of the first sample [s]."""


def list_channel_facts(table: MeasuredTable) -> list[ChannelFacts]:
    """Facts about every column of a table."""
    facts = [_describe_column(column, table.values[:, i]) for i, column in enumerate(table.columns)]
    equal = _find_equal(table)
    return [
        replace(fact, remarks=(*fact.remarks, f"same numbers as {equal[i]!r}")) if i in equal else fact
        for i, fact in enumerate(facts)
    ]


def _describe_column(column: TableColumn, values: RealArray) -> ChannelFacts:
    known = np.isfinite(values)
    unit = find_stated_unit(column)
    if not known.any():
        return ChannelFacts(column, unit, np.nan, np.nan, 1.0, 0, ("text or empty",))
    numbers = values[known]
    smallest, largest, missing = float(numbers.min()), float(numbers.max()), float(1 - known.mean())
    return ChannelFacts(
        column, unit, smallest, largest, missing, _find_trend(numbers), tuple(_list_remarks(numbers, smallest, largest))
    )


def _find_trend(numbers: RealArray) -> int:
    steps = np.diff(numbers)
    return int((steps >= 0).all() and (steps > 0).any()) - int((steps <= 0).all() and (steps < 0).any())


def _list_remarks(numbers: RealArray, smallest: float, largest: float) -> Iterator[str]:
    """Suspicious contents of a channel; a channel of two values marks events."""
    if smallest == largest:
        yield "constant"
    elif not np.isin(numbers[1:], (smallest, largest)).all():
        inner = ~np.isin(numbers[1:], (smallest, largest))
        held = float(np.mean(np.diff(numbers)[inner] == 0))
        if held >= HELD_SHARE:
            yield _describe_held(numbers, held)
        elif clipped := find_clipping(numbers):
            yield f"flat at its extreme {len(clipped)} times: overloaded?"


def _describe_held(numbers: RealArray, held: float) -> str:
    """Remark on a channel if many of its samples repeat the preceding one."""
    if held < SELDOM_SHARE:
        return f"{100 * held:.0f} % of the samples repeat the one before: recorded at a lower rate?"
    values = np.unique(numbers)
    step = float(np.diff(values).min())
    return (
        f"changes seldom: {values.size} different values in {numbers.size} samples, at least {step:.3g} apart. "
        "A slow quantity with a coarse resolution or a lower rate looks like this; a dead channel is constant"
    )


def _find_equal(table: MeasuredTable) -> dict[int, str]:
    """Earlier column with the same numbers, by the index of the later one; constants are left out."""
    seen: dict[bytes, str] = {}
    equal: dict[int, str] = {}
    for i, column in enumerate(table.columns):
        values = table.values[:, i]
        if np.isfinite(values).any() and np.nanmax(values) > np.nanmin(values):
            key = np.ascontiguousarray(values).tobytes()
            if key in seen:
                equal[i] = seen[key]
            else:
                seen[key] = column.label
    return equal


def find_time(table: MeasuredTable) -> TimeFacts | None:
    """Time of a table: a column with a name of time, the time of the file, or its rate; None without any."""
    if (found := table.find_time_column()) is not None:
        index, factor = found
        column = table.columns[index]
        return describe_time(f"column {column.label!r}", column, table.values[:, index] * factor)
    if table.time is not None:
        return describe_time("time of the file", None, table.time)
    if table.rate is not None:
        duration = (table.values.shape[0] - 1) / table.rate
        return TimeFacts("sampling interval of the file", None, table.rate, duration, ())
    return None


def describe_time(source: str, column: TableColumn | None, time: RealArray) -> TimeFacts | None:
    """Rate, gaps and repetitions of a time [s]; None for fewer than two samples."""
    if time.size < 2 or not np.isfinite(time).all():
        return None
    steps = np.diff(time)
    interval = float(np.median(steps))
    if interval <= 0:
        return TimeFacts(source, column, np.nan, float(time[-1] - time[0]), ("does not increase",), float(time[0]))
    remarks = []
    for text, wrong in (("repeated", steps == 0), ("backwards", steps < 0)):
        if wrong.any():
            first = time[int(np.argmax(wrong))]
            remarks.append(f"{wrong.sum()} times {text}, first at {first:.6g} s")
    gaps = steps > GAP_INTERVALS * interval
    if gaps.any():
        longest = int(np.argmax(steps))
        remarks.append(f"{gaps.sum()} gaps, the longest of {steps[longest]:.4g} s at {time[longest]:.6g} s")
    elif not remarks and np.abs(steps / interval - 1).max() > 0.1:
        remarks.append("uneven sampling intervals")
    return TimeFacts(source, column, 1 / interval, float(time[-1] - time[0]), tuple(remarks), float(time[0]))


# Probable meaning of the channels of a logger file, by unit and name; a guess for a sidecar that is to be checked.
def guess_channels(facts: Sequence[ChannelFacts]) -> dict[str, list[ChannelFacts]]:
    """Columns that probably hold each channel of a force record, in the order of the file.

    A column counts for a channel if its name has a word of the channel, and its unit, if stated, is of this quantity.
    """
    found: dict[str, list[ChannelFacts]] = {}
    for fact in facts:
        channel = next((channel for channel, _ in list_meanings(fact.column.label, fact.column.unit)), None)
        if fact.missing < 1 and channel in CHANNELS and channel != "time":
            found.setdefault(channel, []).append(fact)
    return found


def list_force_signals(facts: Sequence[ChannelFacts]) -> list[ChannelFacts]:
    """Columns with the name of a force and the unit of another quantity, such as the volts of a force sensor."""
    units = find_key_units("N")
    return [
        fact
        for fact in facts
        if fact.missing < 1
        and fact.unit is not None
        and has_word(fact.column.label, "force")
        and find_factor(fact.unit, units) is None
    ]


def is_acceleration(fact: ChannelFacts) -> bool:
    """Whether a column probably holds the acceleration of a mass drop."""
    if fact.unit is not None:
        return find_factor(fact.unit, find_key_units("m_s2")) is not None
    return next((channel for channel, _ in list_meanings(fact.column.label, None)), None) == "acceleration"


def is_drop_channel(fact: ChannelFacts) -> bool:
    """Whether a column may be a channel of a mass drop: a motion, the force of a hammer, or a signal without a unit."""
    known = (find_key_units(unit) for unit in ("m_s2", "m_s", "m", "N"))
    return fact.unit is None or any(find_factor(fact.unit, units) is not None for units in known)

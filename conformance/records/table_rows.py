"""Rows of the channels of one file: its table, by the names of the suite or by those that the sidecar maps."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.channel_names import find_factor
from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.core.measured_table import (
    EVERY_CHANNEL,
    EVERY_RATE,
    MDF,
    SAMPLED_TOGETHER,
    ChannelNames,
    MeasuredTable,
    TableColumn,
    read_tables,
)
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.core.units import find_key_units, suggest_key
from pantocheck.conformance.records.column_values import TIME_COLUMN, add_time_column, read_mapped_rows
from pantocheck.conformance.records.record import (
    CHANNELS,
    LARGEST_NUMBER,
    MAX_SAMPLES,
    OUTPUT_COLUMN,
    ChannelRows,
    RecordColumn,
    find_column,
)
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.source_tables import ColumnFile

LARGEST_TIME = 1e10
"""Largest time [s]."""


def read_single_table(path: Path, file: ColumnFile, used: tuple[str, ...]) -> MeasuredTable:
    """Read the table of a file of a record.

    Args:
        path: The file.
        file: Its description.
        used: Columns that the description names.

    Raises:
        InputError: The file cannot be read, or holds several runs.
    """
    names: ChannelNames = EVERY_CHANNEL if file.columns is None else EVERY_RATE
    if file.columns is not None and path.suffix.lower() in MDF.suffixes:
        # Groups of an MDF file have their own times: the named channels decide which group is read.
        names = tuple(name for name in used if name != TIME_COLUMN)
    tables = read_tables(path, names, MAX_SAMPLES, layout=file.table)
    if len(tables) > 1 and tables[0].run:
        raise InputError(f"record '{path.name}'", f"holds {len(tables)} runs", "Write one file per run.")
    needed = [set(used) & {column.label for column in add_time_column(table).columns} for table in tables]
    together = set[str]().union(*needed)
    if together not in needed:
        rates = "; ".join(", ".join(sorted(part)) for part in needed if part)
        found = f"the columns have different sampling times: {rates[:200]}"
        raise InputError(f"record '{path.name}'", found, SAMPLED_TOGETHER)
    return tables[needed.index(together)]


def read_rows(
    table: MeasuredTable, file: ColumnFile, sidecar: RecordSidecar, further: tuple[str, ...], where: str
) -> tuple[ChannelRows, list[InputError]]:
    """Rows of the channels of a file by number from 1, and an error for each wrong column.

    Args:
        table: Table of the file.
        file: Its description.
        sidecar: Sidecar with the numbers of pantographs and supports.
        further: Columns that are not channels.
        where: Place of the description in messages.

    Raises:
        InputError: A named column is missing, or its unit is missing or wrong. The error lists all such columns.
    """
    if file.columns is None:
        rows, errors = _read_own_rows(table, sidecar, further)
    else:
        rows, errors = read_mapped_rows(add_time_column(table), file.columns, where), []
    if "time" not in rows and (time := _find_own_time(table)) is not None:
        rows["time"] = {1: time}
    return rows, errors


def _read_own_rows(
    table: MeasuredTable, sidecar: RecordSidecar, further: tuple[str, ...]
) -> tuple[ChannelRows, list[InputError]]:
    """Rows of a file that uses the names of the channels, and an error for each wrong column."""
    where, rows, errors = table.where, ChannelRows(), list[InputError]()
    for column, values in zip(table.columns, table.values.T, strict=True):
        if column.label in further:
            continue
        try:
            if (column.name or "").startswith(OUTPUT_COLUMN):
                continue
            meaning = _find_meaning(column, sidecar, where)
        except InputError as error:
            errors.append(error)
            continue
        channel = rows.setdefault(meaning.channel.name, {})
        if meaning.number in channel:
            place = f"{where}, column {str(column.name)[:80]!r}"
            errors.append(InputError(place, "repeats the channel of another column", "Store each channel once."))
            continue
        with np.errstate(invalid="ignore", over="ignore"):  # numbers too large are reported below
            channel[meaning.number] = meaning.factor * values
    return rows, errors


def _find_own_time(table: MeasuredTable) -> RealArray | None:
    """Time beside the channels, or from the rate that the file states [s]; None without both."""
    if table.time is not None:
        return table.time
    return None if table.rate is None else np.arange(table.values.shape[0]) / table.rate


def _find_meaning(column: TableColumn, sidecar: RecordSidecar, where: str) -> RecordColumn:
    """Channel and number of a column, checked against the numbers of pantographs and supports in the sidecar."""
    if column.name is None:
        raise InputError(where, "has no head line", "Write the names of the columns in the first line.")
    place = f"{where}, column {column.name[:80]!r}"
    meaning = find_column(column.name, column.row)
    if meaning is None:
        known = [channel.column(i + 1) for channel in CHANNELS.values() for i in range(sidecar.rows(channel.per))]
        hint = suggest_key(column.name, None, known) or suggest_names(column.name, known)
        raise InputError(place, "unknown column", hint)
    stated = None if column.unit is None else find_factor(column.unit, find_key_units(meaning.channel.unit))
    if column.unit is not None and stated != meaning.factor:
        hint = f"Correct the wrong one, or map the columns ([columns]). See {DocumentationPage.LOGGER_FILES}."
        raise InputError(place, f"has the unit {column.unit!r} in the file, which is not that of its name", hint)
    allowed = sidecar.rows(meaning.channel.per)
    if meaning.number > allowed:
        hint = f"It has {allowed}: correct the sidecar, or remove the column."
        raise InputError(place, f"the sidecar has no {meaning.channel.per} {meaning.number}", hint)
    return meaning


def find_impossible_values(name: str, rows: dict[int, RealArray], where: str) -> Iterator[InputError]:
    """Channels with infinite or impossibly large values; NaN marks a missing value, and a time may count from 1970."""
    largest = LARGEST_TIME if name == "time" else LARGEST_NUMBER
    for number, values in rows.items():
        impossible = np.abs(values) > largest
        if impossible.any():
            sample = int(np.argmax(impossible))
            yield InputError(
                f"{where}, {CHANNELS[name].column(number)}",
                f"sample {sample + 1} has the impossible value {values[sample]:.3g}",
                "Correct the value, or write nan for a missing value.",
            )

"""Channels of a contact-force record from a measured table: rows of samples in SI units."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.counted_noun import count_noun
from pantocheck.conformance.input_files.documentation_pages import DocumentationPage
from pantocheck.conformance.input_files.input_error import InputError, join_errors
from pantocheck.conformance.input_files.measured_table import (
    EVERY_CHANNEL,
    ChannelNames,
    MeasuredTable,
    TableColumn,
)
from pantocheck.conformance.input_files.suggestions import suggest_names
from pantocheck.conformance.input_files.table_formats import MDF, read_tables
from pantocheck.conformance.input_files.units import find_key_units, suggest_key
from pantocheck.conformance.records.logger.column_values import add_time_column, find_factor
from pantocheck.conformance.records.logger.mapped_rows import read_mapped_rows
from pantocheck.conformance.records.logger.placed_rows import (
    MARKS,
    list_further_columns,
    list_used_channels,
    place_rows,
)
from pantocheck.conformance.records.record import LARGEST_NUMBER, MAX_SAMPLES
from pantocheck.conformance.records.record_channels import CHANNELS, ChannelRows, RecordColumn, find_column
from pantocheck.conformance.records.record_sidecar import RecordSidecar


def read_channel_rows(path: Path, sidecar: RecordSidecar) -> tuple[ChannelRows, tuple[TableColumn, ...]]:
    """Read the table of a record.

    Args:
        path: The table.
        sidecar: Sidecar of the record.

    Returns:
        rows: Rows of each channel by number from 1.
        unused: Columns that the sidecar does not use.

    Raises:
        InputError: The table is damaged, has an unknown column, lacks a channel, or contradicts its sidecar. The error
            lists all such columns and channels.
    """
    where, sidecar_where = f"record '{path.name}'", f"sidecar '{path.with_suffix('.toml').name}'"
    # Groups of an MDF file have their own times: the named channels decide which group is read.
    named = sidecar.columns is not None and path.suffix.lower() in MDF.suffixes
    names: ChannelNames = list_used_channels(sidecar) if named else EVERY_CHANNEL
    tables = read_tables(path, names, MAX_SAMPLES, layout=sidecar.table)
    if len(tables) > 1:
        raise InputError(where, f"holds {len(tables)} runs", "Write one file per run.")
    table = tables[0]
    if sidecar.columns is None:
        rows, errors = _read_own_rows(table, sidecar)
    else:
        rows, errors = read_mapped_rows(add_time_column(table), sidecar.columns, sidecar_where), []
    if "time" not in rows and (time := _find_own_time(table)) is not None:
        rows["time"] = {1: time}
    if not errors:  # a wrong column may be the missing one
        place_rows(rows, table, sidecar, sidecar_where)
        errors += _find_missing_channels(rows, sidecar, where)
    for name in rows.keys() - MARKS:
        errors += _find_impossible_values(name, rows[name], where)
    if errors:
        raise join_errors(errors)
    return rows, () if sidecar.columns is None else _list_unused(table, sidecar)


def _list_unused(table: MeasuredTable, sidecar: RecordSidecar) -> tuple[TableColumn, ...]:
    used = list_used_channels(sidecar)
    return tuple(column for column in table.columns if column.label and column.label not in used)


def _read_own_rows(table: MeasuredTable, sidecar: RecordSidecar) -> tuple[ChannelRows, list[InputError]]:
    """Rows of a file that uses the names of the channels, and an error for each wrong column."""
    where, rows, errors = table.where, ChannelRows(), list[InputError]()
    used = list_further_columns(sidecar)
    for column, values in zip(table.columns, table.values.T, strict=True):
        if column.label in used:
            continue
        try:
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


def _find_missing_channels(rows: ChannelRows, sidecar: RecordSidecar, where: str) -> Iterator[InputError]:
    """Missing channels, and channels without a row for each pantograph; uplift may be measured at some supports."""
    for missing, present in (
        ("force_N", "force" in rows),
        ("time_s or position_m", rows.keys() & {"time", "position"}),
    ):
        if not present:
            yield InputError(where, f"has no channel {missing}", "Store force_N, and time_s or position_m.")
    for name, numbered in rows.items():
        if name in MARKS:
            continue
        expected = sidecar.rows(CHANNELS[name].per)
        first_alone = name == "position" and list(numbered) == [1] and sidecar.spacing_m is not None
        if name != "uplift" and len(numbered) != expected and not first_alone:
            found = f"has {count_noun(len(numbered), 'row')} of {CHANNELS[name].key}, expected {expected}"
            hint = "Store one row per pantograph; for positions, position_1_m and spacing_m in the sidecar are enough."
            if name == "position" and list(numbered) == [1]:
                found = f"spacing_m is missing from the sidecar, and the table {found}"
                distances = count_noun(expected - 1, "distance")
                hint = f"Give spacing_m, {distances} between pantographs, or one row per pantograph."
            yield InputError(where, found, hint)


def _find_impossible_values(name: str, rows: dict[int, RealArray], where: str) -> Iterator[InputError]:
    """Channels with infinite or impossibly large values; NaN marks a missing value."""
    for number, values in rows.items():
        impossible = np.abs(values) > LARGEST_NUMBER
        if impossible.any():
            sample = int(np.argmax(impossible))
            yield InputError(
                f"{where}, {CHANNELS[name].column(number)}",
                f"sample {sample + 1} has the impossible value {values[sample]:.3g}",
                "Correct the value, or write nan for a missing value.",
            )

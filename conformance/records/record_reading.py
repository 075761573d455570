"""Reading of records: tables of samples with a sidecar, and summaries."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.channel_names import find_factor
from pantocheck.conformance.core.files import MAX_FILE_BYTES, check_file
from pantocheck.conformance.core.input_error import InputError, join_errors, suggest_names
from pantocheck.conformance.core.measured_table import (
    EVERY_CHANNEL,
    MDF,
    ChannelNames,
    MeasuredTable,
    TableColumn,
    read_tables,
)
from pantocheck.conformance.core.table_sidecar import read_sidecar
from pantocheck.conformance.core.texts import DocumentationPage, count_noun
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.core.units import find_key_units, suggest_key
from pantocheck.conformance.records.column_values import (
    add_time_column,
    list_left_out_sensors,
    read_mapped_rows,
)
from pantocheck.conformance.records.record import (
    CHANNELS,
    LARGEST_NUMBER,
    MAX_SAMPLES,
    STRIP_CHANNELS,
    ChannelRows,
    Record,
    RecordColumn,
    RecordInvalid,
    find_column,
)
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.record_summary import RecordSummary
from pantocheck.conformance.records.samples import RecordSamples, build_record
from pantocheck.conformance.records.track_position import (
    ARCING,
    EVENTS,
    LOADED,
    MARKS,
    complete_position_rows,
    list_further_columns,
    list_used_channels,
)

RECORD_SCHEMAS: dict[str, type[RecordSidecar] | type[RecordSummary]] = {
    "pantocheck.record/1": RecordSidecar,
    "pantocheck.summary/1": RecordSummary,
}


def open_record(path: Path) -> RecordSidecar | RecordSummary:
    """Read the TOML file of a record: a sidecar or a summary. The path may also be that of the table.

    Raises:
        InputError: The file cannot be read, does not fit its model, or is neither a sidecar nor a summary; a table has
            no sidecar.
    """
    table, path = path, path.with_suffix(".toml")
    if table != path and not path.exists():
        check_file(table, f"record '{table.name}'", MAX_FILE_BYTES)
        raise InputError(
            f"record '{table.name}'",
            f"its sidecar {path.name} is missing",
            f"Write it: pantocheck describe {table} --sidecar {path}",
        )
    schema = read_toml(path, "record").get("schema")
    model = RECORD_SCHEMAS.get(schema) if isinstance(schema, str) else None
    if model is None:
        expected = " or ".join(f'"{name}"' for name in RECORD_SCHEMAS)
        raise InputError(
            f"record '{path.name}', key schema",
            "missing" if schema is None else f"found {str(schema)[:60]!r}",
            f"Write schema = {expected}.",
        )
    return read_model(path, model, "sidecar" if model is RecordSidecar else "summary record")


def read_record(
    path: Path, evaluated: tuple[float, float] | None = None, case_start: float | None = None
) -> tuple[Record, RecordSidecar]:
    """Read a record.

    Args:
        path: Sidecar, or table with the sidecar beside it.
        evaluated: Analysis section of the case [m], used if the sidecar states none.
        case_start: Start of the first pantograph in the case [m], to be named where the sidecar states none.

    Returns:
        Record and its sidecar.

    Raises:
        InputError: A file is missing or damaged, table and sidecar contradict each other, values are missing, or the
            time is not uniform.
    """
    samples, sidecar, table = read_samples(path)
    try:
        record = build_record(samples, sidecar, evaluated, case_start)
    except RecordInvalid as error:
        raise build_record_error(table, error) from None
    return record, sidecar


def read_samples(path: Path) -> tuple[RecordSamples, RecordSidecar, Path]:
    """Read the samples of a record; values may be missing, and times may be unevenly spaced.

    Args:
        path: Sidecar, or table with the sidecar beside it.

    Returns:
        Samples, sidecar and path of the table.

    Raises:
        InputError: A file is missing or damaged, or table and sidecar contradict each other.
    """
    sidecar, table = read_sidecar(path, RecordSidecar)
    rows, unused = read_channel_rows(table, sidecar)
    return _build_samples(rows, sidecar, unused), sidecar, table


def build_record_error(table: Path, error: RecordInvalid) -> InputError:
    """Input error for a table whose samples are not a valid record."""
    return InputError(
        f"record '{table.name}', channel {error.channel}", error.found, f"See {DocumentationPage.RECORDS}."
    )


def _build_samples(rows: ChannelRows, sidecar: RecordSidecar, unused: tuple[TableColumn, ...]) -> RecordSamples:
    """Stack the rows of each channel; supports without a row of uplift are left out."""
    marks = {name: rows.pop(name, {}) for name in MARKS}
    channels: dict[str, RealArray] = {
        name: numbered[1] if CHANNELS[name].per == "record" else np.vstack([numbered[i] for i in sorted(numbered)])
        for name, numbered in rows.items()
    }
    supports = [(sidecar.support_position_m or ())[i - 1] for i in sorted(rows.get("uplift", {}))]
    return RecordSamples(
        force=channels["force"],
        time=channels.get("time"),
        speed=channels.get("speed"),
        position=channels.get("position"),
        contact_height=channels.get("contact_height"),
        **{name: channels[name] for name in STRIP_CHANNELS if name in channels},
        uplift=channels.get("uplift"),
        support_position=np.array(supports) if supports else None,
        ignored=tuple(column.label for column in unused),
        left_out_sensors=list_left_out_sensors(sidecar.columns or {}, unused),
        event_level=np.vstack(list(marks[EVENTS].values())) if marks[EVENTS] else None,
        arcing=_fill_rows(marks[ARCING], channels["force"]),
        loaded=_fill_rows(marks[LOADED], channels["force"]),
    )


def _fill_rows(rows: dict[int, RealArray], force: RealArray) -> RealArray | None:
    """Rows of all pantographs, (p, n), with NaN for those without a channel; None without any channel."""
    if not rows:
        return None
    missing = np.full(force.shape[1], np.nan)
    return np.vstack([rows.get(number, missing) for number in range(1, force.shape[0] + 1)])


# Channels of a contact-force record from a measured table: rows of samples in SI units.
def read_channel_rows(path: Path, sidecar: RecordSidecar) -> tuple[ChannelRows, tuple[TableColumn, ...]]:
    """Read the table of a record.

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
    if "force" not in rows and all(name in rows for name in STRIP_CHANNELS):
        front, rear = (rows[name] for name in STRIP_CHANNELS)
        rows["force"] = {number: front[number] + rear[number] for number in front if number in rear}
    if not errors:  # a wrong column may be the missing one
        complete_position_rows(rows, table, sidecar, sidecar_where)
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
            hint = "Store force_N or the forces of both strips, and time_s or position_m."
            yield InputError(where, f"has no channel {missing}", hint)
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

"""Reading of records: tables of samples with a sidecar, and summaries."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.files import MAX_FILE_BYTES, check_file
from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.measured_table import MeasuredTable, TableColumn
from pantocheck.conformance.core.table_sidecar import read_sidecar
from pantocheck.conformance.core.texts import DocumentationPage, count_noun
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.records.column_values import list_left_out_sensors
from pantocheck.conformance.records.record import CHANNELS, STRIP_CHANNELS, ChannelRows, Record, RecordInvalid
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.record_summary import RecordSummary
from pantocheck.conformance.records.samples import RecordSamples, build_record
from pantocheck.conformance.records.source_alignment import RecordSources
from pantocheck.conformance.records.source_reading import COPIED, read_sources, refuse_copies
from pantocheck.conformance.records.table_rows import find_impossible_values, read_rows, read_single_table
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
    if sidecar.source:
        hint = "Assess it by a profile; the run of a case is one table with one time."
        raise InputError(
            f"sidecar '{path.with_suffix('.toml').name}', key source", "the record has several clocks", hint
        )
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
    rows, unused, sources = _read_channel_rows(table, sidecar, path.with_suffix(".toml"))
    return replace(_build_samples(rows, sidecar, unused), sources=sources), sidecar, table


def list_tables(path: Path, sidecar: RecordSidecar) -> tuple[Path, ...]:
    """Tables of a record in the folder of its path, each once: the first file, and those of its further sources."""
    return tuple(dict.fromkeys(path.parent / source.file for source in (sidecar, *sidecar.source)))


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
        front_strip=channels.get("front_strip"),
        rear_strip=channels.get("rear_strip"),
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


def _read_channel_rows(
    path: Path, sidecar: RecordSidecar, sidecar_path: Path
) -> tuple[ChannelRows, tuple[TableColumn, ...], RecordSources]:
    """Read the tables of a record.

    Returns:
        rows: Rows of each channel by number from 1, at the times of the first file.
        unused: Columns of the first file that the sidecar does not use.
        sources: Channels with their own times, and clocks.

    Raises:
        InputError: A table is damaged, has an unknown column, lacks a channel, or contradicts its sidecar. The error
            lists all such columns and channels.
    """
    where, sidecar_where = f"record '{path.name}'", f"sidecar '{sidecar_path.name}'"
    table = read_single_table(path, sidecar, list_used_channels(sidecar))
    rows, errors = read_rows(table, sidecar, sidecar, list_further_columns(sidecar), sidecar_where)
    sources = RecordSources()
    if "force" not in rows and all(name in rows for name in STRIP_CHANNELS):
        front, rear = (rows[name] for name in STRIP_CHANNELS)
        rows["force"] = {number: front[number] + rear[number] for number in front if number in rear}
    if not errors:  # a wrong column may be the missing one
        complete_position_rows(rows, table, sidecar, sidecar_where)
        sources = read_sources(sidecar_path, sidecar, table, rows)
        for name, added in sources.rows.items():
            rows[name] = {**rows.get(name, {}), **added}
        for name in COPIED:
            numbered = {CHANNELS[name].column(k): (path.name, row) for k, row in rows.get(name, {}).items()}
            refuse_copies(name, numbered, {}, sidecar_where)
        errors += _find_missing_channels(rows, sidecar, where)
    for name in rows.keys() - MARKS:
        errors += find_impossible_values(name, rows[name], where)
    if errors:
        raise join_errors(errors)
    return rows, () if sidecar.columns is None else _list_unused(table, sidecar), sources


def _list_unused(table: MeasuredTable, sidecar: RecordSidecar) -> tuple[TableColumn, ...]:
    used = list_used_channels(sidecar)
    return tuple(column for column in table.columns if column.label and column.label not in used)


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

"""Reading of records: tables of samples with a sidecar, and summaries."""

import hashlib
from pathlib import Path

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.bounded_file import MAX_FILE_BYTES, check_file, file_digest
from pantocheck.conformance.input_files.documentation_pages import DocumentationPage
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import TableColumn
from pantocheck.conformance.input_files.toml_file import read_model, read_toml
from pantocheck.conformance.records.channel_rows import read_channel_rows
from pantocheck.conformance.records.logger.placed_rows import ARCING, EVENTS, LOADED, MARKS
from pantocheck.conformance.records.logger.sensor_warnings import list_left_out_sensors
from pantocheck.conformance.records.record import Record, RecordInvalid
from pantocheck.conformance.records.record_channels import CHANNELS, ChannelRows
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.record_summary import RecordSummary
from pantocheck.conformance.records.samples import RecordSamples, build_record

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
    if table != path and table.is_file() and not path.exists():
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
    sidecar_path = path.with_suffix(".toml")
    sidecar = read_model(sidecar_path, RecordSidecar, "sidecar")
    table = locate_table(sidecar_path, sidecar.file, sidecar.sha256)
    rows, unused = read_channel_rows(table, sidecar)
    return _build_samples(rows, sidecar, unused), sidecar, table


def locate_table(sidecar_path: Path, name: str, digest: str | None) -> Path:
    """Find the table of a sidecar.

    Args:
        sidecar_path: The sidecar.
        name: Name of the table, from the sidecar.
        digest: Its SHA-256 by the sidecar.

    Raises:
        InputError: The table is missing, is a link to a file in another folder, or has another SHA-256.
    """
    table = sidecar_path.parent / name
    check_file(table, f"record '{table.name}'", MAX_FILE_BYTES)
    if not table.resolve().is_relative_to(sidecar_path.parent.resolve()):
        raise InputError(f"record '{table.name}'", "is a link to a file outside its folder", "Copy the table itself.")
    if digest is not None and file_digest(table) != digest:
        raise InputError(
            f"record '{table.name}'",
            "the content does not agree with sha256 in the sidecar",
            "Copy table and sidecar again, or write them again.",
        )
    return table


def record_digest(sidecar_path: Path, table: Path | None = None) -> str:
    """SHA-256 of the sidecar and the table of a record, or of a summary alone."""
    paths = [sidecar_path.with_suffix(".toml"), *([] if table is None else [table])]
    return "sha256:" + hashlib.sha256("\n".join(map(file_digest, paths)).encode()).hexdigest()


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

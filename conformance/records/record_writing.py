"""Writing of contact-force records: the table first, then the sidecar, so that every sidecar has its table."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.files import file_digest, produce_atomically, write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import CSV, HDF5, TableFormat, find_table_format
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.records.record import CHANNELS, STRIP_CHANNELS, Record, RecordChannel
from pantocheck.conformance.records.record_sidecar import RECORD_SCHEMA, RecordSidecar

Rows = dict[RecordChannel, RealArray]
"""Samples of each channel, one row per pantograph or support."""


def write_record(
    path: Path,
    record: Record,
    case: str | None = None,
    system: dict[str, str] | None = None,
    run: dict[str, float | None] | None = None,
    further: Mapping[str, object] | None = None,
    outputs: Mapping[str, RealArray] | None = None,
) -> Path:
    """Write a record as CSV or HDF5, by the suffix of the path, with a sidecar beside it.

    Args:
        path: Path of the table, ending in .csv, .h5 or .hdf5.
        record: Record to write.
        case: Id of the case that was run.
        system: `name` and `version` of the simulator or measuring system.
        run: Table `run` of the sidecar; keys with None are left out.
        further: Further keys of the sidecar, such as `case_digest` and `line`; keys with None are left out.
        outputs: Further columns of the table by their names, (n,) each, such as outputs of an FMU.

    Raises:
        InputError: The suffix is not that of a record, a file cannot be written, or the sidecar would overwrite another
            file.
    """
    check_record_path(path)
    table_format = find_table_format(path, tuple(RECORD_WRITERS))
    produce_atomically(path, partial(_write_table, record, outputs or {}, table_format))
    sidecar: dict[str, Any] = {
        "schema": RECORD_SCHEMA,
        "case": case,
        "file": path.name,
        "sha256": file_digest(path),
        "speed_km_h": float(f"{3.6 * record.speed:.12g}"),
        "pantographs": record.pantographs,
        "evaluated_m": [float(x) for x in record.evaluated],
        "filter_applied_Hz": "none" if record.filter_applied_Hz is None else record.filter_applied_Hz,
        "support_position_m": None if record.support_position is None else record.support_position.tolist(),
        "system": system,
        "run": {key: value for key, value in (run or {}).items() if value is not None},
        **(further or {}),
    }
    known = {key: value for key, value in sidecar.items() if value is not None}
    RecordSidecar.model_validate(known)
    target = path.with_suffix(".toml")
    write_atomically(target, tomli_w.dumps(known).encode())
    return target


def check_record_path(path: Path) -> None:
    """Check the path of a record before a long computation.

    Raises:
        InputError: The suffix is not that of a record, its package is not installed, or the sidecar would overwrite
            another file.
    """
    find_table_format(path, tuple(RECORD_WRITERS)).require_library(path)
    target = path.with_suffix(".toml")
    if target.exists() and read_toml(target, "sidecar").get("schema") != RECORD_SCHEMA:
        raise InputError(
            f"record '{path}'",
            f"the sidecar would overwrite {target.name}, which is not a sidecar of a record",
            "Give the record another name.",
        )


def _write_table(record: Record, outputs: Mapping[str, RealArray], table_format: TableFormat, path: Path) -> None:
    """Write the channels of a record in a format, whatever the suffix of the path."""
    channels = {
        "time": record.time,
        "position": record.position,
        "force": record.force,
        "contact_height": record.contact_height,
        **{name: getattr(record, name) for name in STRIP_CHANNELS},
        "uplift": record.support_uplift,
    }
    rows = {CHANNELS[name]: values for name, values in channels.items() if values is not None}
    RECORD_WRITERS[table_format](path, rows, outputs)


def _write_csv(path: Path, rows: Rows, outputs: Mapping[str, RealArray]) -> None:
    names = [channel.column(i + 1) for channel, values in rows.items() for i in range(len(np.atleast_2d(values)))]
    write_csv_table(path, [*names, *outputs], np.vstack([*rows.values(), *outputs.values()]).T, 12)


def _write_hdf5(path: Path, rows: Rows, outputs: Mapping[str, RealArray]) -> None:
    from pantocheck.conformance.core.hdf5_table import write_hdf5_table

    write_hdf5_table(path, {}, {channel.key: values for channel, values in rows.items()} | dict(outputs))


RECORD_WRITERS: dict[TableFormat, Callable[[Path, Rows, Mapping[str, RealArray]], None]] = {
    CSV: _write_csv,
    HDF5: _write_hdf5,
}
"""Formats in which records are written, with their writers."""

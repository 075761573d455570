"""Parquet tables, with a sidecar: one column per channel; needs the extra `parquet`."""

import json
from pathlib import Path

import numpy as np
import pyarrow
import pyarrow.parquet

from pantocheck.conformance.core.files import MAX_FILE_BYTES, open_file, produce_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import (
    ChannelNames,
    MeasuredTable,
    TableColumn,
    convert_damage_errors,
    stack_channels,
)

DESCRIPTION = b"pantocheck"
"""Key of the metadata that describe the columns of a table which this suite has written."""

OWN_TIME = "time of the file"
"""Name of the column with the times that another format holds beside its channels."""


def read_parquet_table(path: Path, names: ChannelNames, largest: int) -> list[MeasuredTable]:
    """Read a Parquet file; columns that are not numbers are missing. Arguments and errors as in `Reader`."""
    where = f"record '{path.name}'"
    with open_file(path, where, MAX_FILE_BYTES) as file, convert_damage_errors(where, "Parquet"):
        content = pyarrow.parquet.ParquetFile(file)
        if content.metadata.num_rows * content.metadata.num_columns > largest:
            raise InputError(where, f"holds more than {largest} numbers", "Shorten the record, or leave channels out.")
        table = content.read()
        described = json.loads((table.schema.metadata or {}).get(DESCRIPTION, b"{}"))
        columns = [TableColumn(**column) for column in described.get("columns", ())]
        rate = described.get("rate_Hz")
        vectors = [_read_numbers(column) for column in table.columns]
        labels = list(table.column_names)
    if not vectors or not vectors[0].size:
        raise InputError(where, "holds no samples", "Export the record again.")
    time = vectors.pop(labels.index(OWN_TIME)) if OWN_TIME in labels and columns else None
    columns = columns or [TableColumn(label) for label in labels]
    if len(columns) != len(vectors):
        raise InputError(where, "has other columns than its description", "Import the file again.")
    return [MeasuredTable(path.name, stack_channels(vectors, where, largest), tuple(columns), time=time, rate=rate)]


def _read_numbers(column: pyarrow.ChunkedArray) -> np.ndarray:
    kind = column.type
    if not (pyarrow.types.is_floating(kind) or pyarrow.types.is_integer(kind) or pyarrow.types.is_boolean(kind)):
        return np.full(len(column), np.nan)
    return np.asarray(column.cast(pyarrow.float64()).to_numpy(zero_copy_only=False), dtype=np.float64)


def write_parquet_table(path: Path, table: MeasuredTable) -> None:
    """Write a table so that reading gives the same numbers, names, units and times.

    Raises:
        InputError: The file cannot be written.
    """
    labels = [column.label or "column" for column in table.columns]
    unique = [label if labels.count(label) == 1 else f"{label} ({i})" for i, label in enumerate(labels, 1)]
    arrays = dict(zip(unique, table.values.T, strict=True))
    if table.time is not None:
        arrays[OWN_TIME] = table.time
    columns = [{"name": column.name, "row": column.row, "unit": column.unit} for column in table.columns]
    description = json.dumps({"columns": columns, "rate_Hz": table.rate}).encode()
    content = pyarrow.table({name: np.ascontiguousarray(values) for name, values in arrays.items()})
    content = content.replace_schema_metadata({DESCRIPTION: description})
    produce_atomically(path, lambda temporary: pyarrow.parquet.write_table(content, temporary, compression="zstd"))

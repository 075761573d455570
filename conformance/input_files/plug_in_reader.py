"""Readers of file formats from other distributions: the entry point has the name of the suffix, without its dot."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import ChannelNames, MeasuredTable, TableColumn
from pantocheck.conformance.plug_ins.plug_in import PlugIn
from pantocheck.conformance.plug_ins.plug_in_loading import guard_plug_in, load_plug_in


@dataclass(frozen=True)
class TableReader:
    """Reader of a file format, the object of an entry point `pantocheck.readers`.

    Parameters
    ----------
    read : callable
        Function of the path of a file that returns its runs, one `MeasuredTable` each, with all channels. It raises
        `InputError` for a damaged file.
    """

    read: Callable[[Path], Sequence[MeasuredTable]]


@dataclass(frozen=True)
class PlugInFormat:
    """File format whose reader is a plug-in.

    Parameters
    ----------
    plug_in : PlugIn
        Entry point of the reader.
    """

    plug_in: PlugIn

    def read(self, path: Path, names: ChannelNames, largest: int) -> list[MeasuredTable]:
        """Read a file and check the tables; arguments and errors as in `table_formats.Reader`."""
        del names  # as for any format that describes itself, the sidecar chooses among all channels
        reader = load_plug_in(self.plug_in, TableReader)
        with guard_plug_in(self.plug_in):
            tables = list(reader.read(path))
            for table in tables:
                _check_table(table, largest)
        if not tables:
            raise InputError(f"{self.plug_in.text}, record '{path.name}'", "holds no run", "Export the record again.")
        return [replace(table, source=path.name) for table in tables]


def _check_table(table: object, largest: int) -> None:
    """Refuse a table that does not agree with its own description."""
    if not isinstance(table, MeasuredTable):
        raise TypeError(f"the reader returned a {type(table).__name__} in place of a MeasuredTable")
    if not isinstance(table.values, np.ndarray) or table.values.ndim != 2 or table.values.dtype != np.float64:
        raise TypeError("values of a table must be an array of float64 with two axes")
    if table.values.shape[1] != len(table.columns) or not all(isinstance(part, TableColumn) for part in table.columns):
        raise ValueError(f"{table.values.shape[1]} columns of values, {len(table.columns)} descriptions (TableColumn)")
    if table.values.size == 0 or table.values.size > largest:
        raise ValueError(f"{table.values.size} values; at least 1 and at most {largest} are accepted")
    if table.time is not None and np.shape(table.time) != table.values.shape[:1]:
        raise ValueError("the time column has another length than the values")
    if table.rate is not None and not (np.isfinite(table.rate) and table.rate > 0):
        raise ValueError(f"the sampling rate is {table.rate}")

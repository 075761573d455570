"""MATLAB tables of version 5 (scipy) and 7.3 (HDF5), with a sidecar: a matrix of samples, or a vector per channel."""

import math
import struct
import zlib
from pathlib import Path
from typing import BinaryIO

import h5py
import numpy as np
import scipy.io
from scipy.io.matlab import MatReadError

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.channel_names import find_time_factor
from pantocheck.conformance.core.files import MAX_FILE_BYTES, open_file
from pantocheck.conformance.core.hdf5_table import open_hdf5, read_numbers
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import (
    ChannelNames,
    EveryChannel,
    EveryRate,
    MeasuredTable,
    SampledChannel,
    TableColumn,
    convert_damage_errors,
    group_by_sampling,
    stack_channels,
)

NUMERIC_CLASSES = {"double", "single", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))}
COMPRESSED = 15
"""Type of a compressed element of version 5."""

RATE_NAMES = ("sampling_rate_hz", "fs", "rate")


def read_matlab_table(path: Path, names: ChannelNames, largest: int) -> list[MeasuredTable]:
    """Read the run of a MATLAB file; arguments and errors as in `measured_table.Reader`."""
    where = f"record '{path.name}'"
    arrays = _read_version_7_3(path, where, largest) if h5py.is_hdf5(path) else _read_version_5(path, where, largest)
    times = {name: factor for name in arrays if (factor := find_time_factor(name, None)) is not None}
    time = next((times[name] * arrays[name].ravel() for name in times if arrays[name].size > 1), None)
    rate = next((float(array.ravel()[0]) for array in _find_arrays(arrays, RATE_NAMES) if array.size), None)
    data = {name: array for name, array in arrays.items() if name not in times and name.lower() not in RATE_NAMES}
    if isinstance(names, EveryRate):
        clocks = {arrays[name].size: times[name] * arrays[name].ravel() for name in times}
        found = (
            SampledChannel(TableColumn(name, number), row, None, clocks.get(row.size))
            for name, array in data.items()
            if array.ndim == 2
            for number, row in enumerate(array if array.shape[0] <= array.shape[1] else array.T, 1)
        )
        return group_by_sampling(path.name, found, largest)
    if isinstance(names, EveryChannel):
        columns, values = _list_vectors(data, where, largest)
    elif names and all(name in data for name in names):
        values = stack_channels([data[name].ravel() for name in names], where, largest)
        columns = tuple(TableColumn(name) for name in names)
    else:
        values = _find_largest_matrix(data, where)
        columns = (TableColumn(),) * values.shape[1]
    if time is not None and time.size != values.shape[0]:
        raise InputError(where, f"holds {time.size} times for {values.shape[0]} samples", "Store one time per sample.")
    return [MeasuredTable(path.name, values, columns, time=time, rate=rate)]


def _find_arrays(arrays: dict[str, RealArray], names: tuple[str, ...]) -> list[RealArray]:
    """Arrays with these names, in the order of the names; letter case is ignored."""
    return [array for wanted in names for name, array in arrays.items() if name.lower() == wanted]


def _list_vectors(data: dict[str, RealArray], where: str, largest: int) -> tuple[tuple[TableColumn, ...], RealArray]:
    """Columns and samples of the variables with the most samples; a matrix has one channel per row or column."""
    length = max((max(array.shape) for array in data.values() if array.ndim == 2 and array.size > 1), default=0)
    columns, channels = list[TableColumn](), list[RealArray]()
    for name, array in data.items():
        if array.ndim != 2 or length not in array.shape:
            continue
        rows = array if array.shape[1] == length else array.T
        columns += [TableColumn(name, row) for row in range(1, len(rows) + 1)]
        channels += list(rows)
    if not channels:
        hint = "Store one vector per channel; save the fields of a structure with -struct."
        raise InputError(where, "holds no vector of numbers", hint)
    return tuple(columns), stack_channels(channels, where, largest)


def _find_largest_matrix(data: dict[str, RealArray], where: str) -> RealArray:
    """Matrix of the samples, (n, c): the largest one of the file."""
    tables = {name: array for name, array in data.items() if array.ndim == 2 and max(array.shape) > 1}
    if not tables:
        raise InputError(
            where,
            f"holds no table of samples; variables besides time and rate: {', '.join(sorted(data)[:8]) or 'none'}",
            "Store one matrix (samples by channels), or one vector per channel named as in the sidecar.",
        )
    most = max(table.size for table in tables.values())
    largest = sorted(name for name, table in tables.items() if table.size == most)
    if len(largest) > 1:
        raise InputError(
            f"{where}, {', '.join(largest[:8])}",
            "have the same size, so that the table of samples is not known",
            "Name each vector as in the sidecar, or store one matrix (samples by channels).",
        )
    table = tables[largest[0]]
    return np.ascontiguousarray(table if table.shape[0] >= table.shape[1] else table.T)


def _read_version_5(path: Path, where: str, largest: int) -> dict[str, RealArray]:
    """Numeric variables; the stated shapes and the size of the decompressed data are checked before reading."""
    with open_file(path, where, MAX_FILE_BYTES) as file, convert_damage_errors(where, "a MATLAB file", MatReadError):
        inflated = _inflates_over(file, 8 * largest + 2**20)  # `whosmat` inflates whole variables
        stated = [] if inflated else scipy.io.whosmat(file)
        shapes = {name: shape for name, shape, kind in stated if kind in NUMERIC_CLASSES}
        numbers = sum(math.prod(shape) for shape in shapes.values())
        if inflated or numbers > largest:
            raise InputError(where, f"holds more than {largest} numbers", "Shorten the record, or leave channels out.")
        content = scipy.io.loadmat(file, variable_names=list(shapes))
        return {
            name: np.asarray(value, dtype=np.float64)
            for name, value in content.items()
            if name in shapes and isinstance(value, np.ndarray) and value.dtype.kind in "fiu"
        }


def _inflates_over(file: BinaryIO, limit: int) -> bool:
    """Whether the compressed variables of a version-5 file hold more than `limit` [bytes] together."""
    file.seek(126)
    order = "<" if file.read(2) == b"IM" else ">"
    total = 0
    while len(tag := file.read(8)) == 8:
        kind, size = struct.unpack(f"{order}II", tag)
        end = file.tell() + size
        if kind == COMPRESSED:
            inflation, left = zlib.decompressobj(), size
            while total <= limit and (data := file.read(min(left, 2**20))):
                left -= len(data)
                while data and total <= limit:
                    total += len(inflation.decompress(data, 2**20))
                    data = inflation.unconsumed_tail
        if total > limit:
            return True
        file.seek(end)
    return False


def _read_version_7_3(path: Path, where: str, largest: int) -> dict[str, RealArray]:
    with open_hdf5(path, largest) as file:
        return {
            # MATLAB stores matrices by columns, so they are transposed here.
            name: read_numbers(item, f"{where}, variable {name!r}").T
            for name, item in file.items()
            # h5py returns a name that is not UTF-8 as bytes; a sidecar cannot contain such a name.
            if isinstance(name, str) and isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu"
        }

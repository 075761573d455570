"""MATLAB records, version 5 (scipy) and 7.3 (HDF5): a table of samples or one vector per channel, with a sidecar."""

import struct
import zlib
from pathlib import Path

import h5py
import numpy as np
import scipy.io
from scipy.io.matlab import MatReadError

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_assembly import DropColumn, DropColumns
from pantocheck.conformance.mass_drops.drop_sidecar import DropSidecar

MATLAB_TIME_NAMES = ("time", "time_s", "t")
RATE_NAMES = ("sampling_rate_hz", "fs", "rate")
MATLAB_DAMAGE = (
    ValueError,
    TypeError,
    KeyError,
    IndexError,
    EOFError,
    OSError,
    NotImplementedError,
    MatReadError,
    struct.error,
    zlib.error,
)
"""What scipy raises for files that are damaged."""


def read_matlab_drops(path: Path, sidecar: DropSidecar | None) -> list[DropColumns]:
    """The one run of a MATLAB file; errors as in `read_records`."""
    source = path.name
    arrays = _version_7_3(path, source) if h5py.is_hdf5(path) else _version_5(path, source)
    time = next((array.ravel() for array in _named(arrays, MATLAB_TIME_NAMES) if array.size > 1), None)
    rate = next((float(array.ravel()[0]) for array in _named(arrays, RATE_NAMES) if array.size), None)
    data = {name: array for name, array in arrays.items() if name.lower() not in MATLAB_TIME_NAMES + RATE_NAMES}
    names = [channel.name for channel in sorted(sidecar.channel, key=lambda one: one.column)] if sidecar else []
    if names and all(name in data for name in names):
        vectors = [data[name].ravel() for name in names]
        if len({vector.size for vector in vectors}) > 1:
            raise InputError(source, "its channels differ in length", "The channels must be sampled together.")
        values, columns = np.column_stack(vectors), tuple(DropColumn(name) for name in names)
    else:
        values = _largest_table(data, source)
        columns = (DropColumn(),) * values.shape[1]
    if time is not None and time.size != values.shape[0]:
        raise InputError(source, f"{time.size} times for {values.shape[0]} samples", "Export the record again.")
    return [DropColumns(values, columns, time=time, rate=rate)]


def _named(arrays: dict[str, RealArray], names: tuple[str, ...]) -> list[RealArray]:
    """Arrays of these names, in their order; capitals do not count."""
    return [array for wanted in names for name, array in arrays.items() if name.lower() == wanted]


def _largest_table(data: dict[str, RealArray], source: str) -> RealArray:
    """The one table of samples, (n, c)."""
    tables = {name: array for name, array in data.items() if array.ndim == 2 and max(array.shape) > 1}
    if not tables:
        raise InputError(
            source,
            f"holds no table of samples ({', '.join(sorted(data)[:8]) or 'nothing'})",
            "Store one matrix (samples by channels), or one vector per channel named as in the sidecar.",
        )
    most = max(table.size for table in tables.values())
    largest = sorted(name for name, table in tables.items() if table.size == most)
    if len(largest) > 1:
        raise InputError(
            f"{source}, {', '.join(largest[:8])}",
            "holds several tables of one size",
            "Name each vector as in the sidecar, or store one matrix (samples by channels).",
        )
    table = tables[largest[0]]
    return np.ascontiguousarray(table if table.shape[0] >= table.shape[1] else table.T)


def _version_5(path: Path, source: str) -> dict[str, RealArray]:
    try:
        content = scipy.io.loadmat(path, struct_as_record=True)
    except MATLAB_DAMAGE as error:
        raise InputError(source, f"is damaged or not a MATLAB file ({str(error)[:100]})", "Export it again.") from None
    return {
        name: np.asarray(value, dtype=np.float64)
        for name, value in content.items()
        if not name.startswith("__") and isinstance(value, np.ndarray) and value.dtype.kind in "fiu"
    }


def _version_7_3(path: Path, source: str) -> dict[str, RealArray]:
    try:
        with h5py.File(path, "r") as file:
            return {
                # MATLAB stores by columns, so its matrices come out transposed.
                name: np.asarray(item[()], dtype=np.float64).T
                for name, item in file.items()
                # h5py gives a name that is no UTF-8 as bytes; no sidecar can mean it.
                if isinstance(name, str) and isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu"
            }
    except (OSError, KeyError, TypeError, ValueError, RuntimeError) as error:
        raise InputError(source, f"is damaged ({str(error)[:100]})", "Export it again.") from None

"""HDF5 tables: runs `run_<k>/<quantity>` with a group `channels` and attributes, or data sets at the root."""

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import ArrayLike

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.bounded_file import MAX_FILE_BYTES, open_file
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import MeasuredTable, TableColumn, refuse_damage

MOST_ITEMS = 10_000
"""Largest count of data sets in a group, and of channels."""

OWN_DATA = "Store the data sets themselves in the file."

MOTION_QUANTITIES = ("acceleration", "velocity", "displacement")


def read_hdf5_table(path: Path, names: tuple[str, ...], largest: int) -> list[MeasuredTable]:
    """Read all runs of an HDF5 file in the order of their numbers; arguments and errors as in `table_formats.Reader`.

    A file without groups `run_<k>` is one run whose data sets, of one or more rows, stand at its root.
    """
    with open_hdf5(path, largest) as file:
        where = f"record '{path.name}'"
        runs = sorted((name for name in file if name.startswith("run_")), key=_run_number)
        if not runs:
            return [_read_root(file, path.name)]
        columns = _read_columns(file, bool(names), where)
        return [_read_run(file, name, k if len(runs) > 1 else 0, columns, path.name) for k, name in enumerate(runs, 1)]


@contextmanager
def open_hdf5(path: Path, largest: int) -> Iterator[h5py.File]:
    """Open an HDF5 file for reading; failures of the library inside the block become `InputError`.

    Parameters
    ----------
    path : Path
        The file.
    largest : int
        Largest count of numbers in its data sets.

    Raises
    ------
    InputError
        The file is damaged, a part of its data stands in another place or file, or its data are too large.
    """
    where = f"record '{path.name}'"
    # The library reads from the open file, so that no other file can take its name after the check of its kind.
    with (
        open_file(path, where, MAX_FILE_BYTES) as content,
        refuse_damage(where, "HDF5"),
        h5py.File(content, "r") as file,
    ):
        numbers = _check_items(file, where, largest)
        if numbers > largest:
            raise InputError(where, f"{numbers} numbers", f"At most {largest} numbers are read.")
        yield file


def read_numbers(item: object, where: str) -> RealArray:
    """Read a data set of numbers of a file from `open_hdf5`, which has checked its size.

    Raises
    ------
    InputError
        It is no data set of numbers.
    """
    if not isinstance(item, h5py.Dataset) or item.dtype.kind not in "fiu" or item.shape is None:
        raise InputError(where, "holds no table of samples", "Store an array of numbers.")
    with np.errstate(invalid="ignore", over="ignore"):  # numbers that are not finite are reported with their place
        return np.asarray(item[()], dtype=np.float64)


def write_hdf5_table(path: Path, attributes: Mapping[str, Any], datasets: Mapping[str, ArrayLike | list[str]]) -> None:
    """Write an HDF5 file; the same content gives the same bytes.

    Parameters
    ----------
    path : Path
        The file.
    attributes : mapping
        Attributes of the root.
    datasets : mapping
        Arrays, or lists of texts, by path inside the file.
    """
    with h5py.File(path, "w", track_order=True) as file:
        for name, value in attributes.items():
            file.attrs[name] = value
        for name, values in datasets.items():
            texts = isinstance(values, list) and isinstance(values[0], str)
            dtype = h5py.string_dtype("utf-8") if texts else None
            file.create_dataset(name, data=values, dtype=dtype, track_times=False)


def _check_items(group: h5py.Group, where: str, largest: int) -> int:
    """Count of numbers in the data sets of a group and of its runs, which must all stand in this file.

    The SHA-256 of the file would not cover data of another file, and a chunk is read as a whole.
    """
    if len(group) > MOST_ITEMS:
        raise InputError(where, f"{len(group)} data sets", f"At most {MOST_ITEMS} are read.")
    numbers = 0
    for name in group:
        place = f"{where}, {str(name)[:80]!r}"
        if not isinstance(group.get(name, getlink=True), h5py.HardLink):
            raise InputError(place, "is a link to another place", OWN_DATA)
        item = group[name]
        if isinstance(item, h5py.Dataset):
            if item.external or item.is_virtual:
                raise InputError(place, "stores its numbers in another place", OWN_DATA)
            if math.prod(item.chunks or ()) > max(largest, MOST_ITEMS):
                raise InputError(place, f"its chunks have the shape {item.chunks}", "Store smaller chunks.")
            numbers += item.size or 0
        elif isinstance(item, h5py.Group) and (name == "channels" or str(name).startswith("run_")):
            numbers += _check_items(item, place, largest)
    return numbers


def _run_number(name: str) -> tuple[int, str]:
    tail = name.removeprefix("run_")
    return (int(tail) if tail.isdecimal() else 0, tail)


def _read_root(file: h5py.File, source: str) -> MeasuredTable:
    """Table of the data sets at the root, one column per row."""
    where, columns, rows = f"record '{source}'", list[TableColumn](), list[RealArray]()
    if not len(file):
        raise InputError(where, "holds no data", "Store each run as run_<k>/acceleration, or one data set per channel.")
    for name, item in file.items():
        place = f"{where}, data set {str(name)[:80]!r}"
        values = read_numbers(item, place)
        if values.ndim not in (1, 2) or (rows and values.shape[-1] != rows[0].size):
            first = f"; the first data set has {rows[0].size} samples" if rows else ""
            raise InputError(
                place, f"its shape is {values.shape}{first}", "Store arrays of shape (samples) or (rows, samples)."
            )
        for row, samples in enumerate(np.atleast_2d(values), 1):
            columns.append(TableColumn(str(name), row))
            rows.append(samples)
    return MeasuredTable(source, np.column_stack(rows), tuple(columns))


def _read_columns(file: h5py.File, described: bool, where: str) -> tuple[TableColumn, ...] | None:
    """Columns from the group `channels`; with a sidecar only name and unit, which must agree with it."""
    if "channels" not in file:
        return None
    group = file["channels"]
    names, units = _texts(group["name"]), _texts(group["unit"])
    if described:
        return tuple(TableColumn(name, unit=unit) for name, unit in zip(names, units, strict=True))
    facts = (group["sensor"][()], _texts(group["wire"]), group["position_m"][()], _texts(group["direction"]))
    if not names:
        raise InputError(where, "describes no channel", "Fill the group 'channels', or write a sidecar.")
    return tuple(
        TableColumn(name, 1, unit, int(sensor), wire, float(position) if np.isfinite(position) else None, direction)
        for name, unit, sensor, wire, position, direction in zip(names, units, *facts, strict=True)
    )


def _read_run(
    file: h5py.File, name: str, run: int, columns: tuple[TableColumn, ...] | None, source: str
) -> MeasuredTable:
    where = f"record '{source}', {name}"
    data = next((file[name][quantity] for quantity in MOTION_QUANTITIES if quantity in file[name]), None)
    values = read_numbers(data, where).T
    if values.ndim != 2:
        raise InputError(
            where, "holds no table of samples", f"Store {name}/acceleration as an array of shape (channels, samples)."
        )
    if columns is not None and len(columns) != values.shape[1]:
        raise InputError(
            where,
            f"{values.shape[1]} channels, but {len(columns)} are described",
            "A channel is missing: export the record again.",
        )
    attributes = {key: _plain(value) for key, value in file.attrs.items()}
    rate = attributes.get("sampling_rate_hz")
    return MeasuredTable(
        source,
        values,
        columns if columns is not None else (TableColumn(),) * values.shape[1],
        rate=None if rate is None else float(rate),
        run=run,
        attributes=attributes,
    )


def _plain(value: Any) -> Any:
    return value.decode("utf-8") if isinstance(value, bytes) else value


def _texts(data: Any) -> list[str]:
    return [str(_plain(value)) for value in data[()]]

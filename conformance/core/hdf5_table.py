"""HDF5 tables: runs `run_<k>/<quantity>` with a group `channels` and attributes, or data sets in the root group."""

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import ArrayLike

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.files import MAX_FILE_BYTES, open_file
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import (
    ChannelNames,
    EveryRate,
    MeasuredTable,
    SampledChannel,
    TableColumn,
    convert_damage_errors,
    group_by_sampling,
)

MOST_ITEMS = 10_000
"""Largest number of data sets in a group, and of channels."""

DEEPEST_GROUP = 4
"""Largest number of nested groups in which channels are searched."""

SELF_CONTAINED = "Store all data sets in this file itself, without links to other places."

MOTION_QUANTITIES = ("acceleration", "velocity", "displacement")


def read_hdf5_table(path: Path, names: ChannelNames, largest: int) -> list[MeasuredTable]:
    """Read all runs of an HDF5 file in the order of their numbers; arguments and errors as in `measured_table.Reader`.

    A file without groups `run_<k>` holds one run, with data sets of one or more rows in the root group.
    """
    with open_hdf5(path, largest) as file:
        where = f"record '{path.name}'"
        runs = sorted((name for name in file if name.startswith("run_")), key=_run_number)
        if not runs and isinstance(names, EveryRate):
            return group_by_sampling(path.name, _list_rows(file, where, largest), largest)
        if not runs:
            nested = bool(names) and any(isinstance(item, h5py.Group) for item in file.values())
            return [_read_groups(file, path.name, largest) if nested else _read_root(file, path.name)]
        columns = _read_columns(file, bool(names), where)
        return [_read_run(file, name, k if len(runs) > 1 else 0, columns, path.name) for k, name in enumerate(runs, 1)]


@contextmanager
def open_hdf5(path: Path, largest: int) -> Iterator[h5py.File]:
    """Open an HDF5 file for reading, and convert errors of the library inside the block into `InputError`.

    Args:
        path: The file.
        largest: Largest accepted number of values in its data sets.

    Raises:
        InputError: The file is damaged, refers to data in another place or file, or its data sets are too large.
    """
    where = f"record '{path.name}'"
    # The library reads from the open file, so that no other file can take its name after the check of its kind.
    with (
        open_file(path, where, MAX_FILE_BYTES) as content,
        convert_damage_errors(where, "HDF5"),
        h5py.File(content, "r") as file,
    ):
        numbers = _check_items(file, where, largest)
        if numbers > largest:
            raise InputError(where, f"holds {numbers} numbers", f"At most {largest} numbers are accepted.")
        yield file


def read_numbers(item: object, where: str) -> RealArray:
    """Read a data set of numbers of a file from `open_hdf5`, which has checked its size.

    Raises:
        InputError: The item is not a data set of numbers; `where` is its place in the message.
    """
    if not isinstance(item, h5py.Dataset) or item.dtype.kind not in "fiu" or item.shape is None:
        raise InputError(where, "holds no table of samples", "Store an array of numbers.")
    with np.errstate(invalid="ignore", over="ignore"):  # numbers that are not finite are reported with their place
        return np.asarray(item[()], dtype=np.float64)


def write_hdf5_table(path: Path, attributes: Mapping[str, Any], datasets: Mapping[str, ArrayLike | list[str]]) -> None:
    """Write an HDF5 file; the same content gives the same bytes.

    Args:
        path: The file.
        attributes: Attributes of the root.
        datasets: Arrays, or lists of texts, by path inside the file.
    """
    with h5py.File(path, "w", track_order=True) as file:
        for name, value in attributes.items():
            file.attrs[name] = value
        for name, values in datasets.items():
            texts = isinstance(values, list) and isinstance(values[0], str)
            dtype = h5py.string_dtype("utf-8") if texts else None
            file.create_dataset(name, data=values, dtype=dtype, track_times=False)


def _check_items(group: h5py.Group, where: str, largest: int) -> int:
    """Number of values in the data sets of a group and of its runs; data in another file are refused.

    The SHA-256 of the file would not cover data in another file. Large chunks are refused, because HDF5 reads a whole
    chunk at once.
    """
    if len(group) > MOST_ITEMS:
        raise InputError(where, f"holds {len(group)} data sets", f"At most {MOST_ITEMS} are accepted.")
    numbers = 0
    for name in group:
        place = f"{where}, {str(name)[:80]!r}"
        if not isinstance(group.get(name, getlink=True), h5py.HardLink):
            raise InputError(place, "is a link to another place", SELF_CONTAINED)
        item = group[name]
        if isinstance(item, h5py.Dataset):
            if item.external or item.is_virtual:
                raise InputError(place, "takes its numbers from another place", SELF_CONTAINED)
            if math.prod(item.chunks or ()) > max(largest, MOST_ITEMS):
                raise InputError(place, f"has chunks of the shape {item.chunks}", "Store smaller chunks.")
            numbers += item.size or 0
        elif isinstance(item, h5py.Group) and (name == "channels" or str(name).startswith("run_")):
            numbers += _check_items(item, place, largest)
    return numbers


def _run_number(name: str) -> tuple[int, str]:
    tail = name.removeprefix("run_")
    return (int(tail) if tail.isdecimal() else 0, tail)


def _read_root(file: h5py.File, source: str) -> MeasuredTable:
    """Table of the data sets in the root group, one column per row of a data set."""
    where, columns, rows = f"record '{source}'", list[TableColumn](), list[RealArray]()
    if not len(file):
        hint = "Store each run as run_<k>/acceleration, or one data set per channel."
        raise InputError(where, "holds no data set", hint)
    for name, item in file.items():
        place = f"{where}, data set {str(name)[:80]!r}"
        values = read_numbers(item, place)
        if values.ndim not in (1, 2) or (rows and values.shape[-1] != rows[0].size):
            first = f"; the first data set has {rows[0].size} samples" if rows else ""
            hint = "Store arrays of the shape (samples) or (rows, samples), with equal numbers of samples."
            raise InputError(place, f"has the shape {values.shape}{first}", hint)
        for row, samples in enumerate(np.atleast_2d(values), 1):
            columns.append(TableColumn(str(name), row))
            rows.append(samples)
    return MeasuredTable(source, np.column_stack(rows), tuple(columns))


def _read_groups(file: h5py.File, source: str, largest: int) -> MeasuredTable:
    """Table of the longest data sets in all groups, one column per row of a data set."""
    where = f"record '{source}'"
    arrays = dict(_list_arrays(file, "", where, largest, DEEPEST_GROUP))
    length = max((max(array.shape) for array in arrays.values()), default=0)
    columns, rows = list[TableColumn](), list[RealArray]()
    for name, array in arrays.items():
        if length in array.shape:
            values = np.atleast_2d(array if array.shape[-1] == length else array.T)
            columns += [TableColumn(name, row) for row in range(1, len(values) + 1)]
            rows += list(values)
    if not rows:
        raise InputError(where, "holds no data set of numbers", "Store one data set per channel.")
    if length * len(rows) > largest:
        raise InputError(where, f"holds {length * len(rows)} numbers", f"At most {largest} numbers are accepted.")
    return MeasuredTable(source, np.column_stack(rows), tuple(columns))


def _list_rows(file: h5py.File, where: str, largest: int) -> Iterator[SampledChannel]:
    """Every row of the data sets of a file; the longer axis of a data set is that of the samples."""
    for name, array in _list_arrays(file, "", where, largest, DEEPEST_GROUP):
        rows = np.atleast_2d(array if array.ndim == 1 or array.shape[0] <= array.shape[1] else array.T)
        yield from (SampledChannel(TableColumn(name, number), row) for number, row in enumerate(rows, 1))


def _list_arrays(
    group: h5py.Group, prefix: str, where: str, largest: int, levels: int
) -> Iterator[tuple[str, RealArray]]:
    """Numeric data sets of one or two dimensions by path inside the file; links and large groups are refused."""
    if _check_items(group, f"{where}, group {group.name!r}", largest) > largest:
        raise InputError(where, f"holds more than {largest} numbers", "Shorten the record, or leave channels out.")
    for name, item in group.items():
        if isinstance(item, h5py.Group) and levels > 1:
            yield from _list_arrays(item, f"{prefix}{name}/", where, largest, levels - 1)
        elif isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu" and item.ndim in (1, 2) and item.size:
            yield f"{prefix}{name}", read_numbers(item, where)


def _read_columns(file: h5py.File, described: bool, where: str) -> tuple[TableColumn, ...] | None:
    """Columns from the group `channels`; only name and unit if a sidecar describes the channels."""
    if "channels" not in file:
        return None
    group = file["channels"]
    names, units = _texts(group["name"]), _texts(group["unit"])
    if described:
        return tuple(TableColumn(name, unit=unit) for name, unit in zip(names, units, strict=True))
    facts = (group["sensor"][()], _texts(group["wire"]), group["position_m"][()], _texts(group["direction"]))
    if not names:
        raise InputError(
            f"{where}, group 'channels'", "describes no channel", "Describe every channel there, or write a sidecar."
        )
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
            where, "holds no table of samples", f"Store {name}/acceleration, of the shape (channels, samples)."
        )
    if columns is not None and len(columns) != values.shape[1]:
        raise InputError(
            where,
            f"holds {values.shape[1]} channels, but the group 'channels' describes {len(columns)}",
            "Export the record again: a channel or its description is missing.",
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

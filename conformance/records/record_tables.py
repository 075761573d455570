"""Tables of samples as they lie on disk: CSV and HDF5, read into named rows of numbers in SI units."""

import re
import warnings
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.records.record import MAX_SAMPLES
from pantocheck.conformance.records.record_channels import (
    CHANNELS,
    RecordChannel,
    RecordColumn,
    column_name,
    find_column,
    find_dataset,
    suggest_column,
)
from pantocheck.conformance.records.record_sidecar import RecordSidecar

FORMAT = "See docs/records.md for the format."
Rows = dict[str, dict[int, RealArray]]
"""Rows of each channel by number from 1."""


def read_csv(path: Path, sidecar: RecordSidecar, where: str) -> Rows:
    """Rows of a CSV file; errors as in `read_samples`."""
    try:
        with path.open(encoding="utf-8-sig") as file:
            names = [name.strip() for name in file.readline(100_000).split(",")]
            if not any(names):
                raise InputError(where, "the first line is empty, expected the names of the columns", FORMAT)
            columns = _columns(names, sidecar, where)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)  # no data is said below, an empty line is no sample
                samples = np.loadtxt(
                    file, delimiter=",", ndmin=2, comments=None, max_rows=MAX_SAMPLES // len(names) + 1
                )
    except UnicodeDecodeError as error:
        raise InputError(where, f"byte {error.start + 1} is not text", "A CSV record is UTF-8 text.") from None
    except InputError:
        raise
    except ValueError as error:
        raise InputError(where, _telling(str(error)), "Separate columns by commas and decimals by points.") from None
    if samples.size > MAX_SAMPLES:
        raise InputError(
            where, f"more than {MAX_SAMPLES} numbers", "Cut the record into several, or leave channels out."
        )
    if samples.size == 0 or samples.shape[1] != len(names):
        raise InputError(
            where,
            f"{samples.shape[1] if samples.size else 'no'} columns of numbers under {len(names)} names",
            "Give one number per column on every line.",
        )
    rows: Rows = {}
    for column, values in zip(columns, samples.T, strict=True):
        rows.setdefault(column.channel.name, {})[column.number] = column.factor * values
    return rows


def _columns(names: list[str], sidecar: RecordSidecar, where: str) -> list[RecordColumn]:
    columns = []
    for name in names:
        column = find_column(name)
        if column is None:
            raise InputError(
                f"{where}, line 1, column {name[:80]!r}", "unknown column", suggest_column(name, _known(sidecar))
            )
        allowed = sidecar.rows(column.channel.per)
        if column.number > allowed:
            of = f"{column.channel.per} {column.number}"
            raise InputError(f"{where}, line 1, column {name!r}", f"the sidecar has no {of}", f"It has {allowed}.")
        columns.append(column)
    if len({(column.channel.name, column.number) for column in columns}) != len(columns):
        raise InputError(where, "two columns have the same name", "Each channel stands in one column.")
    return columns


def _known(sidecar: RecordSidecar) -> list[str]:
    return [
        column_name(channel.key, i) for channel in CHANNELS.values() for i in range(1, sidecar.rows(channel.per) + 1)
    ]


def _telling(message: str) -> str:
    """numpy's message with the line of the file in place of its row."""
    bad = re.search(r"could not convert string '(.{0,40}).*' to float64 at row (\d+), column (\d+)", message, re.DOTALL)
    if bad:
        return f"line {int(bad[2]) + 2}, column {bad[3]}: {bad[1]!r} is not a number (nan marks a missing one)"
    changed = re.search(r"columns changed from (\d+) to (\d+) at row (\d+)", message)
    if changed:
        return f"line {int(changed[3]) + 1}: {changed[2]} columns where there were {changed[1]}"
    return f"cannot be read as numbers ({message[:120]})"


def read_hdf5(path: Path, sidecar: RecordSidecar, where: str) -> Rows:
    """Rows of an HDF5 file; errors as in `read_samples`."""
    import h5py

    rows: Rows = {}
    try:
        with h5py.File(path, "r") as file:
            names = list(file)
            for name in names:
                column = find_dataset(name)
                at = f"{where}, dataset {name[:80]!r}"
                if column is None:
                    raise InputError(at, "unknown dataset", suggest_column(name, [c.key for c in CHANNELS.values()]))
                if column.channel.name in rows:
                    raise InputError(at, f"a second dataset of {column.channel.name}", "Keep one of them.")
                dataset = file[name]
                if not isinstance(dataset, h5py.Dataset) or dataset.dtype.kind not in "fiu":
                    raise InputError(at, "not an array of numbers", FORMAT)
                shape = _shape(dataset.shape, dataset.size, column.channel, sidecar, at)
                with np.errstate(invalid="ignore", over="ignore"):  # what is not finite is said of, with its place
                    values = column.factor * np.asarray(dataset[()], dtype=np.float64)
                rows[column.channel.name] = dict(enumerate(values.reshape(shape), 1))
    except InputError:
        raise
    except (OSError, RuntimeError, LookupError, ValueError, TypeError, MemoryError) as error:  # of damaged bytes
        raise InputError(
            where, f"is not a readable HDF5 file ({' '.join(str(error).split())[:120]})", "Write the record again."
        ) from None
    return rows


def _shape(
    shape: tuple[int, ...] | None, size: int, channel: RecordChannel, sidecar: RecordSidecar, at: str
) -> tuple[int, ...]:
    """Rows and samples of a dataset, checked before it is read: damaged bytes may claim any size."""
    expected = sidecar.rows(channel.per)
    found = (1, *shape) if shape is not None and len(shape) == 1 else shape
    few = channel.name == "position" and found is not None and found[0] == 1
    if found is None or len(found) != 2 or (found[0] != expected and not few) or size > MAX_SAMPLES:
        raise InputError(at, f"its shape is {shape}", f"Expected {expected} row(s) of at most {MAX_SAMPLES} samples.")
    return found


def check_complete(present: Iterable[str], where: str) -> None:
    """Refuse a table without force, or without anything that says where or when it was.

    Raises
    ------
    InputError
        a channel is missing.
    """
    here = set(present)
    if "force" not in here:
        raise InputError(where, "there is no channel force_N", "A record needs force_N, and time_s or position_m.")
    if not here & {"time", "position"}:
        raise InputError(where, "there is no channel time_s or position_m", "A record needs force_N, and one of these.")

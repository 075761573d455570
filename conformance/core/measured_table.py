"""Measured table: columns of numbers in the units of their file, with the descriptions that the file contains."""

import struct
import zlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from importlib import import_module
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.channel_names import find_time_factor
from pantocheck.conformance.core.extras import refuse_missing_package, require_package
from pantocheck.conformance.core.files import MAX_FILE_BYTES, open_file
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.text_settings import TextSettings

Axis = Literal["x", "y", "z"]

LIBRARY_ERRORS: tuple[type[Exception], ...] = (
    *(OSError, EOFError, LookupError, TypeError, ValueError, AttributeError, RuntimeError, OverflowError, MemoryError),
    *(struct.error, zlib.error),
)
"""Exceptions that the libraries of the file formats raise for damaged files."""

SAMPLED_TOGETHER = (
    "All channels of a table need the same sampling times: name those of each rate in [columns], or in one [[source]]."
)


@dataclass(frozen=True)
class EveryChannel:
    """Request for every channel of a file, by the names in the file."""


@dataclass(frozen=True)
class EveryRate(EveryChannel):
    """Request for every channel of a file, with one table for the channels that are sampled together."""


EVERY_CHANNEL = EveryChannel()
EVERY_RATE = EveryRate()

ChannelNames = tuple[str, ...] | EveryChannel
"""Names of the channels in a sidecar, in the order of its columns; empty for a file that describes itself."""


@dataclass(frozen=True)
class TableColumn:
    """Description of a column; None and empty text stand for facts that the file does not hold."""

    name: str | None = None
    """Name in the file."""
    row: int = 1
    """Row of its data set, from 1, where a data set of the file has several rows."""
    unit: str | None = None
    """Unit as the file spells it."""
    sensor: int | None = None
    """Number of the sensor."""
    wire: str = ""
    """Wire that carries the sensor."""
    position: float | None = None
    """Position of the sensor along the line [m]."""
    direction: str | None = None
    """Direction of measurement, such as `+z`."""

    @property
    def label(self) -> str:
        """Name with the number of its row, if its data set has several: `force_N[2]`."""
        return (self.name or "") if self.row == 1 else f"{self.name}[{self.row}]"


@dataclass(frozen=True)
class MeasuredTable:
    """Table of one run."""

    source: str
    """Name of the file."""
    values: RealArray
    """Samples in the units of the file, (n, c)."""
    columns: tuple[TableColumn, ...]
    """Descriptions of the c columns."""
    time: RealArray | None = None
    """Time column, (n,) [s]."""
    rate: float | None = None
    """Sampling rate that the file states [Hz]."""
    run: int = 0
    """Number of the run from 1; 0 in a file of one run."""
    attributes: dict[str, Any] = field(default_factory=dict)
    """Data of the run under the names of the HDF5 attributes, such as `drop_mass_kg`."""

    @property
    def where(self) -> str:
        """Name of the file in messages."""
        return f"record '{self.source}'"

    def find_time_column(self) -> tuple[int, float] | None:
        """Index of the first increasing column with the name of a time, and its factor to seconds; None without any."""
        for index, column in enumerate(self.columns):
            factor, values = find_time_factor(column.label, column.unit), self.values[:, index]
            if factor is not None and np.isfinite(values).all() and values[-1] > values[0]:
                return index, factor
        return None

    def separate_time(self) -> "MeasuredTable":
        """Same table with its column of the time, if it has one, apart from the channels [s].

        Raises:
            InputError: The table has no other column.
        """
        if (found := self.find_time_column()) is None:
            return self
        index, factor = found
        if len(self.columns) == 1:
            raise InputError(self.where, "holds the time column only", "Store at least one channel beside the time.")
        columns = (*self.columns[:index], *self.columns[index + 1 :])
        return replace(
            self, values=np.delete(self.values, index, axis=1), columns=columns, time=factor * self.values[:, index]
        )


@contextmanager
def convert_damage_errors(where: str, kind: str, *others: type[Exception]) -> Iterator[None]:
    """Convert exceptions that a library raises for a damaged file into `InputError`.

    Args:
        where: Name of the file in messages.
        kind: Kind of file, e.g. `HDF5`.
        *others: Exceptions of this library beside `LIBRARY_ERRORS`.
    """
    try:
        yield
    except InputError:
        raise
    except (*LIBRARY_ERRORS, *others) as error:
        message = " ".join(str(error).split())[:120]
        raise InputError(where, f"is damaged, or is not {kind} ({message})", "Export the record again.") from None


def parse_direction(text: str, where: str) -> tuple[Axis, float]:
    """Axis and sign of a direction such as `+z` or `-x`; `where` is the place of the text in messages.

    Raises:
        InputError: The text is not one of +x, -x, +y, -y, +z, -z.
    """
    name = text.strip().lower()
    for axis in get_args(Axis):
        if name.lstrip("+-") == axis:
            return axis, -1.0 if name.startswith("-") else 1.0
    raise InputError(where, f"has the unknown direction {text[:40]!r}", "Write +x, -x, +y, -y, +z or -z; z is upward.")


def stack_channels(channels: list[RealArray], where: str, largest: int) -> RealArray:
    """Samples of channels as columns, (n, c); `where` is the name of the file in messages.

    Raises:
        InputError: The channels differ in length, or hold more than `largest` values together.
    """
    if len({channel.size for channel in channels}) > 1:
        raise InputError(where, "has channels of different length", SAMPLED_TOGETHER)
    if sum(channel.size for channel in channels) > largest:
        raise InputError(where, f"holds more than {largest} numbers", "Shorten the record, or leave channels out.")
    return np.column_stack(channels)


@dataclass(frozen=True)
class SampledChannel:
    """Channel of a file whose channels may have different rates."""

    column: TableColumn
    values: RealArray
    """Samples, (n,)."""
    step: float | None = None
    """Sampling interval that the file states [s]."""
    time: RealArray | None = None
    """Times of the samples, (n,) [s]."""


def group_by_sampling(source: str, channels: Iterable[SampledChannel], largest: int) -> list[MeasuredTable]:
    """Tables of the channels that are sampled together, that with the most samples first.

    Args:
        source: Name of the file.
        channels: All channels of the file.
        largest: Largest accepted number of values.

    Raises:
        InputError: There is no channel with samples, or there are too many values.
    """
    groups = dict[tuple[object, ...], list[SampledChannel]]()
    for channel in channels:
        if channel.values.size:
            times = None if channel.time is None else (channel.time[0], channel.time[-1])
            step = None if channel.step is None else round(channel.step, 12)
            groups.setdefault((channel.values.size, step, times), []).append(channel)
    where = f"record '{source}'"
    if not groups:
        raise InputError(where, "holds no channel of numbers", "Export the record again.")
    if sum(channel.values.size for group in groups.values() for channel in group) > largest:
        raise InputError(where, f"holds more than {largest} numbers", "Shorten the record, or leave channels out.")
    return [
        MeasuredTable(
            source,
            np.column_stack([channel.values for channel in group]),
            tuple(channel.column for channel in group),
            time=group[0].time,
            rate=1 / group[0].step if group[0].step else None,
        )
        for group in sorted(groups.values(), key=lambda group: -group[0].values.size)
    ]


# File formats of measured tables. A new format is a file beside this one and a row in `TABLE_FORMATS`.
Reader = Callable[[Path, ChannelNames, int], list[MeasuredTable]]
"""Reader of a format. Its arguments are the path, the names of the channels in the sidecar (empty for a file that
describes itself, `EVERY_CHANNEL` for all channels by their names in the file) and the largest accepted number of
values. The reader of text tables has the stated layout as fourth argument. It raises `InputError` for a file that
cannot be used."""


@dataclass(frozen=True)
class TableFormat:
    """File format of measured tables."""

    module: str
    """File of its reader in this folder; the reader is called `read_` and the name of the file."""
    suffixes: tuple[str, ...]
    """Suffixes of its files in lower case, the usual one first."""
    library: str = ""
    """Package of an extra that reads and writes it; empty if none is needed."""

    def read(self, path: Path, names: ChannelNames, largest: int, *layout: TextSettings) -> list[MeasuredTable]:
        """Read a file of this format; arguments and errors as in `Reader`.

        The library of the format is imported only here, because imports take time.
        """
        with refuse_missing_package(f"record '{path.name}'"):
            module = import_module(f"pantocheck.conformance.core.{self.module}")
            reader: Callable[..., list[MeasuredTable]] = getattr(module, f"read_{self.module}")
            return reader(path, names, largest, *layout)

    def require_library(self, path: Path) -> None:
        """Require the package of this format before a file of it is computed.

        Raises:
            InputError: The package is not installed.
        """
        if self.library:
            require_package(self.library, f"record '{path.name}'")


CSV = TableFormat("csv_table", (".csv", ".txt", ".asc", ".dat"))
MDF = TableFormat("mdf_table", (".mf4", ".mdf"), library="asammdf")
UFF = TableFormat("uff_table", (".uff", ".unv", ".uf", ".uff58", ".58"), library="pyuff")
HDF5 = TableFormat("hdf5_table", (".h5", ".hdf5"), library="h5py")
XLSX = TableFormat("sheet_table", (".xlsx",), library="openpyxl")
ODS = TableFormat("sheet_table", (".ods",))

TABLE_FORMATS = (
    CSV,
    UFF,
    TableFormat("matlab_table", (".mat",), library="h5py"),
    HDF5,
    TableFormat("tdms_table", (".tdms",), library="nptdms"),
    MDF,
    TableFormat("parquet_table", (".parquet",), library="pyarrow"),
    XLSX,
    ODS,
)

TABLE_SUFFIXES = tuple(suffix for table_format in TABLE_FORMATS for suffix in table_format.suffixes)


def list_suffixes(formats: tuple[TableFormat, ...]) -> str:
    """Usual suffixes of formats as text for a message: `.csv, .uff or .h5`."""
    first = [table_format.suffixes[0] for table_format in formats]
    return " or ".join(part for part in (", ".join(first[:-1]), first[-1]) if part)


def find_table_format(path: Path, formats: tuple[TableFormat, ...]) -> TableFormat:
    """Find the format of a file by its suffix, among the accepted formats of the suite.

    Raises:
        InputError: The suffix belongs to none of the formats.
    """
    where, suffix = f"record '{path.name}'", path.suffix.lower()
    if suffix == ".toml":
        raise InputError(
            where, "is a sidecar, not a table", f"Give the table in the same folder ({list_suffixes(formats)})."
        )
    for table_format in formats:
        if suffix in table_format.suffixes:
            return table_format
    known = f"Known formats are {list_suffixes(formats)}."
    if suffix == "":
        raise InputError(where, "has no suffix", f"Did you mean {path.name}{formats[0].suffixes[0]} ? {known}")
    raise InputError(where, f"has the unknown suffix '{suffix}'", known)


def read_tables(
    path: Path,
    names: ChannelNames,
    largest: int,
    formats: tuple[TableFormat, ...] = TABLE_FORMATS,
    layout: TextSettings | None = None,
) -> list[MeasuredTable]:
    """Read all runs in a file.

    Args:
        path: The file.
        names: Names of the channels in its sidecar, in the order of the columns; empty for a file that describes
            itself.
        largest: Largest accepted number of values.
        formats: Accepted formats.
        layout: Layout of a text table, as far as it is stated.

    Returns:
        One table per run.

    Raises:
        InputError: The file cannot be read, is damaged, too large or of another format.
    """
    table_format = find_table_format(path, formats)
    where = f"record '{path.name}'"
    with open_file(path, where, MAX_FILE_BYTES) as file:
        if not file.read(1):
            raise InputError(where, "is empty", "Export the record again.")
    if layout is None or not layout.is_stated:
        return table_format.read(path, names, largest)
    if table_format is not CSV:
        raise InputError(
            f"sidecar of {where}, key table",
            f"states the layout of a text table, but {path.suffix} is not a text table",
            "Remove separator, decimal, header_lines and encoding.",
        )
    return table_format.read(path, names, largest, layout)

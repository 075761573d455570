"""Measured table: columns of numbers in the units of their file, with the descriptions that the file contains."""

import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, Literal, get_args

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.input_error import InputError

Axis = Literal["x", "y", "z"]

LIBRARY_ERRORS: tuple[type[Exception], ...] = (
    *(OSError, EOFError, LookupError, TypeError, ValueError, AttributeError, RuntimeError, OverflowError, MemoryError),
    *(struct.error, zlib.error),
)
"""Exceptions that the libraries of the file formats raise for damaged files."""

SAMPLED_TOGETHER = "All channels of a record need the same sampling times."

TIME_NAMES = ("time", "time_s", "t", "t_s", "zeit", "temps")
"""Names of a time column, in lower case."""


@dataclass(frozen=True)
class EveryChannel:
    """Request for every channel of a file, by the names in the file."""


EVERY_CHANNEL = EveryChannel()

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

    def separate_time(self) -> "MeasuredTable":
        """Same table with its first column as time column [s], if the name of this column is a name of time.

        Raises:
            InputError: The table has no other column.
        """
        if (self.columns[0].name or "").lower() not in TIME_NAMES:
            return self
        if len(self.columns) == 1:
            raise InputError(self.where, "holds the time column only", "Store at least one channel beside the time.")
        return replace(self, values=self.values[:, 1:], columns=self.columns[1:], time=self.values[:, 0])


@contextmanager
def refuse_damage(where: str, kind: str, *others: type[Exception]) -> Iterator[None]:
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
        InputError: The text is none of +x, -x, +y, -y, +z, -z.
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

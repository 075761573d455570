"""Channels of a contact-force record, and the names of their columns in any unit."""

import re
from dataclasses import dataclass
from typing import Literal

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.units import find_key_units

ChannelRows = dict[str, dict[int, RealArray]]
"""Rows of each channel by number from 1."""


@dataclass(frozen=True)
class RecordChannel:
    """Channel: one quantity of a record, with one or more rows of samples."""

    name: str
    """Name without number and unit."""
    unit: str
    """SI unit as at the end of a key, such as `m_s`."""
    per: Literal["record", "pantograph", "support"]
    """Owner of a row: the record (one row only), each pantograph, or each support."""

    @property
    def key(self) -> str:
        """Name with the SI unit, as in HDF5 files."""
        return f"{self.name}_{self.unit}"

    def column(self, number: int) -> str:
        """Name of a CSV column, such as `force_2_N` for the force of pantograph 2."""
        return self.key if self.per == "record" else f"{self.name}_{number}_{self.unit}"


CHANNELS: dict[str, RecordChannel] = {
    channel.name: channel
    for channel in (
        RecordChannel("time", "s", "record"),
        RecordChannel("speed", "m_s", "record"),
        RecordChannel("position", "m", "pantograph"),
        RecordChannel("force", "N", "pantograph"),
        RecordChannel("contact_height", "m", "pantograph"),
        RecordChannel("uplift", "m", "support"),
    )
}


@dataclass(frozen=True)
class RecordColumn:
    """Channel, number and unit of a column."""

    channel: RecordChannel
    """Channel of the column."""
    number: int
    """Number of the pantograph or support, from 1; 1 for a channel of the record."""
    factor: float
    """Factor to the SI unit of the channel."""


def find_column(name: str, row: int) -> RecordColumn | None:
    """Find the channel of a column `force_1_N`, or of a row of the data set `force_N`; None if there is no such one."""
    for stem, number, unit in _list_readings(name):
        channel = CHANNELS.get(stem)
        if channel is None or (number is not None and channel.per == "record"):
            continue
        factor = find_key_units(channel.unit).get(unit)
        if factor is not None:
            return RecordColumn(channel, int(number or row), factor)
    return None


def _list_readings(name: str) -> list[tuple[str, str | None, str]]:
    """Every way to split a name into channel, number and unit; units such as `m_s` contain underscores."""
    splits = [(name[: mark.start()], name[mark.end() :]) for mark in re.finditer("_", name)]
    readings: list[tuple[str, str | None, str]] = [(stem, None, unit) for stem, unit in splits]
    for stem, unit in splits:
        channel, _, number = stem.rpartition("_")
        if re.fullmatch("[1-9][0-9]{0,3}", number):
            readings.append((channel, number, unit))
    return readings

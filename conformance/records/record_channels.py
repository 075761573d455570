"""Channels of a contact-force record, and the names of their columns with any unit of the channel."""

import re
from dataclasses import dataclass
from typing import Literal

from pantocheck.conformance.input_files.units import find_key_units


@dataclass(frozen=True)
class RecordChannel:
    """Kind of channel.

    Parameters
    ----------
    name : str
        Name without number and unit.
    unit : str
        SI unit as at the end of a key, such as `m_s`.
    per : {"record", "pantograph", "support"}
        Each pantograph or support has one row of the channel; `record` stands for one row in all.
    """

    name: str
    unit: str
    per: Literal["record", "pantograph", "support"]

    @property
    def key(self) -> str:
        """Name with the SI unit, as in HDF5 files."""
        return f"{self.name}_{self.unit}"

    def column(self, number: int) -> str:
        """Name of a CSV column: the force of pantograph 2 is `force_2_N`."""
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
    """Meaning of a column.

    Parameters
    ----------
    channel : RecordChannel
        Channel.
    number : int
        Number of the pantograph or support, from 1; 1 for a channel of the record.
    factor : float
        Factor to the SI unit of the channel.
    """

    channel: RecordChannel
    number: int
    factor: float


def find_column(name: str, row: int) -> RecordColumn | None:
    """Meaning of a column `force_1_N`, or of a row of the data set `force_N`; None if there is no such channel."""
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

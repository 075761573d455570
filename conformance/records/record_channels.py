"""Channels of a record: what may be in a table, and the units that may stand at the end of a name."""

import re
from dataclasses import dataclass

from pantocheck.conformance.input_files.key_units import KEY_UNITS, convert_key
from pantocheck.conformance.input_files.suggestions import suggest_names


@dataclass(frozen=True)
class RecordChannel:
    """A kind of channel.

    Parameters
    ----------
    name : str
        Without number and unit.
    unit : str
        That it is kept in, as at the end of its key.
    per : str
        What has one row of it each; `record`: there is one for all.
    """

    name: str
    unit: str
    per: str

    @property
    def key(self) -> str:
        """Name of the channel in SI units, as HDF5 files have it."""
        return f"{self.name}_{self.unit}"

    @property
    def units(self) -> dict[str, float]:
        """Units that a file may use, each with its factor to `unit`."""
        kind, base = KEY_UNITS[self.unit]
        return {unit: factor / base for unit, (of, factor) in KEY_UNITS.items() if of == kind}


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
    """What a column or dataset holds: its channel, its number (1 if there is one for the record), and its factor."""

    channel: RecordChannel
    number: int
    factor: float


def find_column(name: str) -> RecordColumn | None:
    """Meaning of a CSV column such as `force_1_N`; None if there is no such column."""
    for stem, number, unit in _readings(name):
        channel = CHANNELS.get(stem)
        if channel is not None and (number is None) == (channel.per == "record") and unit in channel.units:
            return RecordColumn(channel, int(number or 1), channel.units[unit])
    return None


def find_dataset(name: str) -> RecordColumn | None:
    """Meaning of an HDF5 dataset such as `force_N`; None if there is no such dataset."""
    for channel in CHANNELS.values():
        unit = name.removeprefix(f"{channel.name}_")
        if unit != name and unit in channel.units:
            return RecordColumn(channel, 1, channel.units[unit])
    return None


def column_name(key: str, number: int) -> str:
    """Name of a CSV column: `force_N` of pantograph 2 is `force_2_N`."""
    channel = next(channel for channel in CHANNELS.values() if channel.key == key)
    return key if channel.per == "record" else f"{channel.name}_{number}_{channel.unit}"


def suggest_column(name: str, known: list[str]) -> str:
    """What an unknown column or dataset probably was meant to be."""
    return convert_key(name, None, known) or suggest_names(name, known)


def _readings(name: str) -> list[tuple[str, str | None, str]]:
    """Every way to split a name into channel, number and unit: units such as m_s hold an underscore themselves."""
    parts = name.split("_")
    splits = [("_".join(parts[:i]), "_".join(parts[i:])) for i in range(1, len(parts))]
    found: list[tuple[str, str | None, str]] = [(stem, None, unit) for stem, unit in splits]
    for stem, unit in splits:
        channel, _, number = stem.rpartition("_")
        if re.fullmatch("[1-9][0-9]{0,3}", number):
            found.append((channel, number, unit))
    return found

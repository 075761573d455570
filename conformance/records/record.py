"""Record: signals of a passage, simulated or measured, on a uniform time axis in SI units."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.units import find_key_units

MAX_SAMPLES = 20_000_000
"""Largest number of values in one array; more follow from a mistake in unit or rate, and would exhaust the memory."""

LARGEST_NUMBER = 1e9
"""Largest force, position or time in SI units; the squares of larger values lose digits in the statistics."""

SPEED_TOLERANCE = 0.005
"""Relative tolerance of the speed of a run [-]: a tenth of the width of a resonance over speed."""


STRIP_CHANNELS = ("front_strip", "rear_strip")
"""Channels of the two strips of a pantograph."""

OUTPUT_COLUMN = "fmu "
"""Prefix of the column of an output of an FMU, which is not a channel; its name is `fmu 1: NAME`."""

FORCE_CHANNELS = ("force", *STRIP_CHANNELS)
"""Contact forces: the total, then those of the strips if there are strips."""

STRIP_TOLERANCE_N = 0.1
"""Largest difference of the contact force from the sum of its strips: rounding of three channels [N]."""


def name_outputs(outputs: Iterable[tuple[int, Mapping[str, RealArray]]]) -> dict[str, RealArray]:
    """Columns of a record with the outputs of FMUs, given by pantograph and name.

    Signs that end a column, a line or a group of a file are replaced.
    """
    columns: dict[str, RealArray] = {}
    for number, named in outputs:
        for name, values in named.items():
            column = f"{OUTPUT_COLUMN}{number}: " + re.sub(r"[^\w.()\[\]-]", "_", name)
            while column in columns:
                column += "_"
            columns[column] = values
    return columns


class RecordInvalid(ValueError):
    """Invalid channel of a record; statistics of such a record would have no meaning.

    Args:
        channel: Name of the channel.
        found: Fault of the channel.
    """

    def __init__(self, channel: str, found: str) -> None:
        super().__init__(f"{channel}: {found}")
        self.channel = channel
        self.found = found


@dataclass(frozen=True)
class Record:
    """Contact force and motion of p pantographs and s supports, n samples; pantographs in running order.

    Raises:
        RecordInvalid: Shapes disagree, a value is not finite or not possible, or the time axis is not uniform.
    """

    time: RealArray
    """Uniform time axis, (n,) [s]."""
    speed: float
    """Speed of the train [m/s]."""
    position: RealArray
    """Contact point along the track, (p, n) [m]."""
    force: RealArray
    """Contact force as delivered, (p, n) [N]."""
    evaluated: tuple[float, float]
    """Start and end of the analysis section [m]."""
    filter_applied_Hz: float | None = None
    """Cut-off of the low-pass filter already applied to the force [Hz]; None if unfiltered."""
    contact_height: RealArray | None = None
    """Height of the contact point above its height at rest, or above the rail, (p, n) [m]."""
    support_position: RealArray | None = None
    """Positions of the supports, (s,) [m]."""
    support_uplift: RealArray | None = None
    """Uplift of the contact wire at the supports, (s, n) [m]; NaN where it is not known."""
    front_strip: RealArray | None = None
    rear_strip: RealArray | None = None
    """Contact forces of both strips of every pantograph, whose sum is its force, (p, n) [N]."""
    rate: float = field(init=False)

    def __post_init__(self) -> None:
        for item in fields(self):
            if item.name in _ARRAYS and (value := getattr(self, item.name)) is not None:
                object.__setattr__(self, item.name, _check_array(item.name, value))
        object.__setattr__(self, "rate", _rate(self.time))
        self._check_shapes()
        if not (np.isfinite(self.speed) and self.speed > 0):
            raise RecordInvalid("speed", f"found {self.speed:g} m/s, expected a positive speed")
        start, end = self.evaluated
        if not (np.isfinite([start, end]).all() and start < end):
            raise RecordInvalid("evaluated", f"the analysis section from {start:g} m to {end:g} m is empty")
        if self.filter_applied_Hz is not None and not (
            np.isfinite(self.filter_applied_Hz) and self.filter_applied_Hz > 0
        ):
            found = f"found {self.filter_applied_Hz:g} Hz, expected a positive cut-off frequency"
            raise RecordInvalid("filter_applied_Hz", found)

    def _check_shapes(self) -> None:
        n = self.time.size
        if self.force.ndim != 2 or self.force.shape[1] != n:
            raise RecordInvalid("force", f"has the shape {self.force.shape}, expected (pantographs, {n})")
        for name in ("position", "contact_height", *STRIP_CHANNELS):
            value = getattr(self, name)
            if value is not None and value.shape != self.force.shape:
                raise RecordInvalid(name, f"has the shape {value.shape}, expected {self.force.shape} as for the force")
        check_strip_forces(self.force, self.front_strip, self.rear_strip)
        if (self.support_position is None) != (self.support_uplift is None):
            raise RecordInvalid("support_uplift", "uplift and positions of the supports are needed together")
        if self.support_position is not None and self.support_uplift is not None:
            expected = (self.support_position.size, n)
            if self.support_position.ndim != 1 or self.support_uplift.shape != expected:
                found = f"has the shape {self.support_uplift.shape}, expected {expected}"
                raise RecordInvalid("support_uplift", found)
        if np.any(np.diff(self.position, axis=1) <= 0):
            raise RecordInvalid("position", "does not increase from each sample to the next for every pantograph")

    @property
    def pantographs(self) -> int:
        """Number of pantographs."""
        return int(self.force.shape[0])


def check_strip_forces(force: RealArray, front: RealArray | None, rear: RealArray | None) -> None:
    """Refuse forces of two strips that contradict the contact force; NaN marks a missing value.

    Args:
        force: Contact force, (p, n) [N].
        front, rear: Contact force of each strip, (p, n) [N]; None: not recorded.

    Raises:
        RecordInvalid: One strip is missing, or both do not add up to the contact force.
    """
    strips = dict(zip(STRIP_CHANNELS, (front, rear), strict=True))
    if front is None or rear is None:
        for name, present in strips.items():
            if present is None and not (front is None and rear is None):
                raise RecordInvalid(name, "missing; the forces of both strips are needed together")
        return
    difference = np.abs(front + rear - force)
    if (wrong := np.argwhere(difference > STRIP_TOLERANCE_N)).size:
        row, sample = wrong[0]
        found = f"by {difference[row, sample]:.3g} N at sample {sample + 1} of pantograph {row + 1}"
        raise RecordInvalid(STRIP_CHANNELS[0], f"the forces of both strips do not add up to the contact force, {found}")


_ARRAYS = frozenset(
    {"time", "position", "force", "contact_height", *STRIP_CHANNELS, "support_position", "support_uplift"}
)
_WITH_GAPS = frozenset({"support_uplift"})
"""Arrays that may hold NaN: a simulation that moves only a part of the line does not know the motion far behind it."""


def _check_array(name: str, value: ArrayLike) -> RealArray:
    array = np.array(value, dtype=np.float64)
    if array.size > MAX_SAMPLES:
        raise RecordInvalid(name, f"has {array.size} values, at most {MAX_SAMPLES} are accepted")
    bad = np.flatnonzero(np.isinf(array) if name in _WITH_GAPS else ~np.isfinite(array))
    if bad.size:
        raise RecordInvalid(
            name, f"{bad.size} values are not finite, the first at sample {bad[0] % array.shape[-1] + 1}"
        )
    impossible = np.flatnonzero(np.abs(array) > LARGEST_NUMBER)
    if impossible.size:
        raise RecordInvalid(
            name,
            f"sample {impossible[0] % array.shape[-1] + 1} has the impossible value {array.flat[impossible[0]]:.3g}",
        )
    array.setflags(write=False)
    return array


def _rate(time: RealArray) -> float:
    if time.ndim != 1 or time.size < 2:
        raise RecordInvalid("time", "has fewer than two samples")
    step = (time[-1] - time[0]) / (time.size - 1)
    # Printed times are rounded by up to a hundredth of a step; more is a gap or a changing rate.
    if not step > 0 or not np.abs(time - np.linspace(time[0], time[-1], time.size)).max() <= 0.01 * step:
        raise RecordInvalid("time", "samples are not evenly spaced in time")
    return float(1 / step)


# Channels of a contact-force record, and the names of their columns in any unit.
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
        *(RecordChannel(name, "N", "pantograph") for name in STRIP_CHANNELS),
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

"""The record of one mass drop, in SI units and with every axis pointing the positive way."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]
Axis = Literal["x", "y", "z"]
MotionQuantity = Literal["acceleration", "velocity", "displacement"]


@dataclass(frozen=True)
class DropChannel:
    """One measured direction of one sensor.

    Parameters
    ----------
    name : as the file calls it
    sensor : number of the sensor
    axis : x along the track, y lateral, z upward
    wire : `CW` contact wire, `MW` messenger wire or another name; empty if not known
    position : along the line from its first support [m]; None if not known
    """

    name: str
    sensor: int
    axis: Axis
    wire: str = ""
    position: float | None = None


@dataclass(frozen=True)
class DropDescription:
    """What was dropped.

    Parameters
    ----------
    mass : [kg]; None if not known
    wire : wire it hung from; empty if not known
    position : along the line from its first support [m]; None if not known
    trigger_nominal : when the release was planned, in the record's time [s]; None if not known
    """

    mass: float | None = None
    wire: str = ""
    position: float | None = None
    trigger_nominal: float | None = None


@dataclass(frozen=True)
class DropLine:
    """What the file says of the line: enough to tell whether two records are of the same one.

    Parameters
    ----------
    spans : lengths of the spans [m]; empty if not known
    contact_wire_tension, messenger_wire_tension : [N]; None if not known
    """

    spans: tuple[float, ...] = ()
    contact_wire_tension: float | None = None
    messenger_wire_tension: float | None = None


@dataclass(frozen=True)
class DropRecord:
    """Signals of all channels over rest, release and decay.

    Parameters
    ----------
    name : test and run
    source : name of the file, for messages
    rate : samples per second [Hz]
    signals : (n, c) [m/s2], [m/s] or [m] after `quantity`; read-only
    channels : (c,) what each column is
    quantity : what the sensors measure
    drop, line : the test
    warnings : what is doubtful about the record
    file : where it was read from, which tells files of one name apart; empty if it was not read
    """

    name: str
    source: str
    rate: float
    signals: Real
    channels: tuple[DropChannel, ...]
    quantity: MotionQuantity = "acceleration"
    drop: DropDescription = DropDescription()
    line: DropLine = DropLine()
    warnings: tuple[str, ...] = ()
    file: str = ""

    def __post_init__(self) -> None:
        self.signals.flags.writeable = False

    @property
    def time(self) -> Real:
        """Time of every sample from the first one [s], (n,)."""
        return np.arange(self.signals.shape[0]) / self.rate

    @property
    def duration(self) -> float:
        """[s]"""
        return float(self.signals.shape[0] / self.rate)

    def along(self, axis: Axis) -> tuple[int, ...]:
        """Columns that measure along an axis."""
        return tuple(c for c, channel in enumerate(self.channels) if channel.axis == axis)

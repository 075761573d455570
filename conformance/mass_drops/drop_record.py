"""The record of one mass drop, in SI units and with every axis pointing the positive way."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from pantocheck.conformance.array_types import RealArray

Axis = Literal["x", "y", "z"]
MotionQuantity = Literal["acceleration", "velocity", "displacement"]


@dataclass(frozen=True)
class DropChannel:
    """One measured direction of one sensor.

    Parameters
    ----------
    name : str
        As the file calls it.
    sensor : int
        Number of the sensor.
    axis : Axis
        x along the track, y lateral, z upward.
    wire : str
        `CW` contact wire, `MW` messenger wire or another name; empty if not known.
    position : float or None
        Along the line from its first support [m]; None if not known.
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
    mass : float or None
        [kg]; None if not known.
    wire : str
        Wire it hung from; empty if not known.
    position : float or None
        Along the line from its first support [m]; None if not known.
    trigger_nominal : float or None
        When the release was planned, in the record's time [s]; None if not known.
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
    spans : tuple[float, ...]
        Lengths of the spans [m]; empty if not known.
    contact_wire_tension, messenger_wire_tension : float or None
        [N]; None if not known.
    """

    spans: tuple[float, ...] = ()
    contact_wire_tension: float | None = None
    messenger_wire_tension: float | None = None


@dataclass(frozen=True)
class DropRecord:
    """Signals of all channels over rest, release and decay.

    Parameters
    ----------
    name : str
        Test and run.
    source : str
        Name of the file, for messages.
    rate : float
        Samples per second [Hz].
    signals : (n, c) ndarray
        [m/s2], [m/s] or [m] after `quantity`; read-only.
    channels : tuple[DropChannel, ...]
        (c,) what each column is.
    quantity : MotionQuantity
        What the sensors measure.
    drop, line : DropDescription or DropLine
        The test.
    warnings : tuple[str, ...]
        What is doubtful about the record.
    file : str
        Where it was read from, which tells files of one name apart; empty if it was not read.
    """

    name: str
    source: str
    rate: float
    signals: RealArray
    channels: tuple[DropChannel, ...]
    quantity: MotionQuantity = "acceleration"
    drop: DropDescription = DropDescription()
    line: DropLine = DropLine()
    warnings: tuple[str, ...] = ()
    file: str = ""

    def __post_init__(self) -> None:
        self.signals.flags.writeable = False

    @property
    def time(self) -> RealArray:
        """Time of every sample from the first one [s], (n,)."""
        return np.arange(self.signals.shape[0]) / self.rate

    @property
    def duration(self) -> float:
        """[s]"""
        return float(self.signals.shape[0] / self.rate)

    def along(self, axis: Axis) -> tuple[int, ...]:
        """Columns that measure along an axis."""
        return tuple(c for c, channel in enumerate(self.channels) if channel.axis == axis)

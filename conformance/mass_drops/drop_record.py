"""Record of one mass drop in SI units; all signals are positive in the direction of an axis."""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.measured_table import Axis
from pantocheck.conformance.input_files.units import MotionQuantity


@dataclass(frozen=True)
class DropChannel:
    """Channel: one direction of one sensor."""

    name: str
    """Name in the file."""
    sensor: int
    """Number of the sensor."""
    axis: Axis
    """x along the track, y lateral, z upward."""
    wire: str = ""
    """`CW` contact wire, `MW` messenger wire or another name; empty if not known."""
    position: float | None = None
    """Position along the line from its first support [m]; None if not known."""


@dataclass(frozen=True)
class DropDescription:
    """Mass, wire, position and planned release of one drop."""

    mass: float | None = None
    """Dropped mass [kg]; None if not known."""
    wire: str = ""
    """Wire with the mass; empty if not known."""
    position: float | None = None
    """Position along the line from its first support [m]; None if not known."""
    trigger_nominal: float | None = None
    """Planned time of the release in the record [s]; None if not known."""


@dataclass(frozen=True)
class DropLine:
    """Properties by which two records are recognised as records of the same line."""

    spans: tuple[float, ...] = ()
    """Lengths of the spans [m]; empty if not known."""
    contact_wire_tension: float | None = None
    messenger_wire_tension: float | None = None
    """Tensions of the wires [N]; None if not known."""


@dataclass(frozen=True)
class DropRecord:
    """Signals of all channels during rest, release and decay."""

    name: str
    """Test and run."""
    source: str
    """Name of the file, for messages."""
    rate: float
    """Sampling rate [Hz]."""
    signals: RealArray
    """Signals, (n, c) [m/s2, m/s or m, by `quantity`]; read-only."""
    channels: tuple[DropChannel, ...]
    """Descriptions of the c columns."""
    quantity: MotionQuantity = "acceleration"
    """Measured quantity."""
    drop: DropDescription = DropDescription()
    """Mass drop."""
    line: DropLine = DropLine()
    warnings: tuple[str, ...] = ()
    """Caveats on the record."""
    file: str = ""
    """Path of the file, which distinguishes files of the same name; empty if the record was not read."""

    def __post_init__(self) -> None:
        self.signals.flags.writeable = False

    @property
    def time(self) -> RealArray:
        """Time of each sample from the first one, (n,) [s]."""
        return np.arange(self.signals.shape[0]) / self.rate

    @property
    def duration(self) -> float:
        """Duration of the record [s]."""
        return float(self.signals.shape[0] / self.rate)

    def along(self, axis: Axis) -> tuple[int, ...]:
        """Indices of the columns whose channels measure along an axis."""
        return tuple(c for c, channel in enumerate(self.channels) if channel.axis == axis)

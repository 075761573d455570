"""Record of one mass drop in SI units; all signals are positive in the direction of an axis."""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import Axis, MeasuredTable
from pantocheck.conformance.core.units import MotionQuantity
from pantocheck.conformance.drops.drop_sidecar import DropSidecar
from pantocheck.conformance.results.identified_modes import MeasuredLine

UNKNOWN_LINE = MeasuredLine()

MOTION_ORDER = {"displacement": 0, "velocity": 1, "acceleration": 2}
"""Order of the time derivative of the displacement."""


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
    line: MeasuredLine = UNKNOWN_LINE
    """Line, by which two records are recognised as records of the same line."""
    warnings: tuple[str, ...] = ()
    """Caveats on the record."""
    file: str = ""
    """Path of the file, which distinguishes files of the same name; empty if the record was not read."""
    shared_clock: bool | None = None
    """Whether the sensors are stated to share a clock; None: not stated."""
    force: RealArray | None = None
    """Measured force of a hammer or shaker, (n,) [N]; None: the line is not driven."""

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


# Sampling rate of a mass-drop record, which must be the same in sidecar, file and time column.
LOWEST_RATE, HIGHEST_RATE = 0.1, 1e6
"""Range of sampling rates [Hz]."""
RATE_TOLERANCE = 1e-3
"""Relative difference up to which two rates are the same."""


def find_sampling_rate(table: MeasuredTable, sidecar: DropSidecar | None) -> float:
    """Find the sampling rate [Hz] of a table with or without a sidecar.

    Raises:
        InputError: The rate is not stated, not possible, or differs between sidecar, file and time column.
    """
    sources = {
        "the sidecar": sidecar.record.sampling_rate_hz if sidecar else None,
        "the file": table.rate,
        "the time column": None if table.time is None else _rate_from_time(table.time, table.where),
    }
    rates = [(source, rate) for source, rate in sources.items() if rate is not None]
    if not rates:
        raise InputError(table.where, "states no sampling rate", "Give record.sampling_rate_hz in a sidecar.")
    first, rate = rates[0]
    for source, other in rates:
        if not LOWEST_RATE <= other <= HIGHEST_RATE:
            found = f"{source} states a sampling rate of {other:g} Hz"
            raise InputError(table.where, found, f"Give a rate from {LOWEST_RATE:g} to {HIGHEST_RATE:g} Hz.")
    for source, other in rates[1:]:
        if abs(other / rate - 1) > RATE_TOLERANCE:
            raise InputError(
                table.where,
                f"{first} states a sampling rate of {rate:g} Hz, but {source} {other:g} Hz",
                "Correct the wrong rate; all frequencies are proportional to it.",
            )
    return rate


def _rate_from_time(time: RealArray, where: str) -> float:
    """Sampling rate of a time column, whose values must be evenly spaced [Hz]."""
    if not np.isfinite(time).all():
        first = int(np.argmin(np.isfinite(time)))
        raise InputError(where, f"the time of sample {first + 1} is not finite", "Export the record again.")
    steps = np.diff(time)
    step = (time[-1] - time[0]) / (time.size - 1)
    if step <= 0:
        raise InputError(where, "the time column does not increase", "Export the samples in the order of time.")
    # Printed times are rounded by less than half a step; a missing sample adds a whole step.
    worst = int(np.argmax(np.abs(steps - step)))
    if abs(steps[worst] - step) > 0.5 * step:
        raise InputError(
            where,
            f"the time increases by {steps[worst]:g} s after {time[worst]:g} s, but by {step:g} s on average",
            "Export an evenly sampled record without gaps.",
        )
    return float(1 / step)

"""Mass drop: its description, and its result. The simulation is in `mass_drop`."""

from dataclasses import dataclass

from pantocheck.model.description.arrays import Array
from pantocheck.model.dynamics.passage import FrameRequest, Frames


@dataclass(frozen=True)
class MassDropSetup:
    """Mass, position and release of a mass drop, and the recorded signals."""

    mass: float
    """Dropped mass [kg]."""
    wire: str
    """Name of the wire that carries it."""
    position: float
    """Position of the mass [m]."""
    release_duration: float
    """Time in which its weight decreases linearly to zero; 0: at once [s]."""
    hanging: float
    """Time recorded before the release [s]."""
    duration: float
    """Time recorded after the release [s]."""
    time_step: float
    """Time step [s]."""
    sensors: tuple[tuple[str, float], ...]
    """Wire and position of each sensor [-, m]."""
    axes: tuple[str, ...] = ("z",)
    """Axes that each sensor records: "z" vertical, "y" lateral, which needs a line with a lateral field."""
    frames: FrameRequest | None = None
    """Moving picture to be recorded on the mesh of `discretise_drop`; None: none."""


@dataclass(frozen=True)
class FreeDecay:
    """Result of a mass drop; T samples, U sensors times axes, sensor by sensor."""

    time: Array
    """Time after the release, negative before, (T,) [s]."""
    motion: Array
    """Displacement, velocity, acceleration along an axis, (U, T, 3) [m, m/s, m/s2]."""
    last_slack: float | None
    """Last time after the release at which a dropper was slack; None if never [s]."""
    slack_at_start: int
    """Number of slack droppers under the hanging mass."""
    frames: Frames | None = None
    """Moving picture; None: none was recorded."""

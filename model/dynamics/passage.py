"""Passage of pantographs along a line: the task of a simulation and its result, as frozen values."""

import math
from dataclasses import dataclass

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.pantograph import Pantograph


@dataclass(frozen=True)
class Passage:
    """Pantographs, speed and duration of a simulation."""

    pantographs: tuple[Pantograph, ...]
    """In running order, the leading one first."""
    start: tuple[float, ...]
    """Position of each pantograph at the start [m]."""
    speed: float
    """Speed of the train [m/s]."""
    duration: float
    """Simulated time [s]."""
    time_step: float
    """Time step [s]."""
    watched: tuple[tuple[str, float], ...] = ()
    """Wire and position of the stations whose vertical motion is recorded [-, m]."""
    reach: float = math.inf
    """Largest half-width of the active window around the pantographs [m]: stations farther away are held at rest,
    although waves may return from there. Infinite: no limit.
    """
    kept_behind: float = math.inf
    """Distance behind the last pantograph within which the motion is known until the end of the simulation [m].
    Stations from which no wave returns there, or to a pantograph, in time are held at rest. Infinite: the whole line
    is active.
    """
    ramp: float = 0.0
    """Time over which every pantograph rises from zero contact force to its static force [s]. Zero: it presses with
    its static force from the start.
    """


@dataclass(frozen=True)
class History:
    """Result of a passage; T steps, P pantographs, C strips, U watched stations."""

    time: Array
    """Time at the end of each step, (T,) [s]."""
    position: Array
    """Position of the pantographs, (P, T) [m]."""
    force: Array
    """Contact force, unfiltered, the sum over the strips of each pantograph, (P, T) [N]."""
    height: Array
    """Height of the head above the datum of the line, the mean over its strips, (P, T) [m]."""
    motion: Array
    """Vertical displacement, velocity and acceleration at the watched stations, (U, T, 3) [m, m/s, m/s2]; NaN while
    it is unknown, see `active_window`.
    """
    strip_force: Array
    """Contact force of each strip, numbered as in a `Train`, (C, T) [N]."""

"""Passage of pantographs along a line: the task of a simulation and its result, as frozen values."""

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.pantograph import Pantograph


@dataclass(frozen=True)
class FrameRequest:
    """Instants and stations of a moving picture of a passage."""

    steps: tuple[int, ...]
    """Numbers of completed steps, rising, from 1."""
    rows: tuple[int, ...]
    stations: tuple[int, ...]
    """Rows and stations of the mesh."""


@dataclass(frozen=True)
class Frames:
    """Moving picture of a passage; F frames, R rows, U stations, N connectors, P pantographs of at most n unknowns."""

    displacement: Array
    """Displacement about the initial state, (F, R, U) [m]; NaN while it is unknown."""
    tension: Array
    """Tensions of the connectors, (F, N) [N]."""
    unknowns: Array
    """Unknowns of the pantographs, (F, P, n)."""


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
    frames: FrameRequest | None = None
    """Moving picture to be recorded, unless another program moves a pantograph; None: none."""


class ForeignPantograph(Protocol):
    """Pantograph that another program moves in steps; heights above the datum of the line."""

    @property
    def can_repeat(self) -> bool:
        """Whether a step can be repeated from its start with another force."""

    def attempt(self, force: Array) -> Array:
        """Advance from the last accepted state by one step under held forces.

        Args:
            force: Force on each strip, downwards, (strips,) [N].

        Returns:
            Height of each strip at the end of the step, (strips,) [m].
        """

    def accept(self) -> None:
        """Keep the state after the last attempt as the start of the next step."""

    def restart(self) -> None:
        """Return to the state before the first step."""


@dataclass(frozen=True)
class Coupling:
    """Agreement of a line and a pantograph that another program moves, over a passage."""

    energy: float = 0.0
    """Energy that the coupling made: work on the line minus work of the program [J]."""
    exchanged: float = 0.0
    """Sum of the absolute work of all steps [J]."""
    largest_difference: float = 0.0
    """Largest difference of the heights of a strip on both sides at the end of a step [m]."""
    attempts: int = 0
    """Number of steps that the program has made, with the repeated ones."""

    def add(self, force: Array, rise: Array, difference: Array, attempts: int) -> "Coupling":
        """Coupling after a further step.

        Args:
            force: Force held on each strip, downwards, (strips,) [N].
            rise: Rise of each strip, (strips,) [m].
            difference: Height that the line has seen minus that of the program, (strips,) [m].
            attempts: Number of attempts of the step.
        """
        return Coupling(
            self.energy + float(force @ difference),
            self.exchanged + float(np.abs(force @ rise)),
            max(self.largest_difference, float(np.abs(difference).max())),
            self.attempts + attempts,
        )


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
    coupling: tuple[Coupling, ...] = ()
    """Couplings of the pantographs that other programs move, in running order."""
    frames: Frames | None = None
    """Moving picture; None: none was recorded."""

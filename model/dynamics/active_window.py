"""Which part of a line moves: what no wave has reached yet, or can come back from in time, is left standing still."""

import math

import numpy as np
from numba import njit

from pantocheck.model.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.state import KernelArrays, Motion, Train

MIN_HALF_WIDTH = 30.0
"""So far around a pantograph all moves from the start: forces reach there in a step, or short waves run ahead [m]."""


def max_wave_speed(line: DiscretisedLine) -> float:
    """Speed that no wave of interest exceeds on any wire [m/s].

    Bending makes short waves faster: 10 % above sqrt(T / m) holds up to about 60 Hz on a contact wire.
    """
    return 1.1 * math.sqrt(max(wire.tension / wire.mass_per_length for wire in line.catenary.wires))


def causal_reach(line: DiscretisedLine, speed: float, duration: float) -> float:
    """How far from the pantographs the line can stand still without them ever feeling it.

    A wave of speed c needs R / (c - v) to get R ahead of a pantograph of speed v, and R / (c + v) to come back from
    there; behind it the other way round. It cannot be back before the end of the run if R > duration (c^2 - v^2) / 2c.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.
    speed : float
        Of the pantographs [m/s].
    duration : float
        Of the run [s].

    Returns
    -------
    float
        The distance; infinite for a train faster than the waves [m].
    """
    c = max_wave_speed(line)
    return duration * (c * c - speed * speed) / (2 * c) if speed < c else math.inf


@njit(cache=True)
def active_stations(line: KernelArrays, train: Train) -> tuple[int, int]:
    """First and last of the stations that move: within reach of a pantograph and of its waves, or all without one."""
    first, last = 0, line.position.size - 1
    if train.position.size > 0:
        spread, run = MIN_HALF_WIDTH + line.front * train.elapsed[0], train.speed[0] * train.elapsed[0]
        behind, ahead = min(line.reach, spread + run), min(line.reach, max(spread - run, MIN_HALF_WIDTH))
        first = max(first, np.searchsorted(line.position, train.position.min() - behind))
        last = min(last, np.searchsorted(line.position, train.position.max() + ahead))
    return first, last


@njit(cache=True)
def hold_outside(motion: Motion, first: int, last: int) -> None:
    """Keep the stations next to the moving part still; a train that comes nearer finds them at rest."""
    for s in (first - 1, last + 1):
        if 0 <= s < motion.w.shape[2]:
            for b in range(motion.w.shape[1]):
                for i in range(1, 3):
                    motion.w[i, b, s] = 0.0
                    motion.r[i, b, s] = 0.0

"""Active window: stations that no wave can have reached yet, or from which none can return in time, are held at rest.

time ^                           With wave speed c and speed v of the pantograph, a disturbance from the pantograph
     |  \\      /pantograph       travels along the characteristics x = x0 +- c t. Outside this cone the line is
     |   \\    / /                still at rest. The domain of dependence of the contact force is narrower: a wave
     |    \\  / /                 must also return to the pantograph before the end of the simulation.
     |     \\//
     +------x0-------> x
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from pantocheck.model.arrays import Array
from pantocheck.model.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.motion import Motion
from pantocheck.model.dynamics.train import Train

MIN_HALF_WIDTH = 30.0
"""Half-width that is active around a pantograph from the first step [m]: covers the influence of one step and fast
short waves."""


class WindowArrays(NamedTuple):
    """Limits of the active window.

    Parameters
    ----------
    position : (S,) ndarray
        Positions of the stations [m].
    reach : float
        Largest half-width around the pantographs; infinite: the whole line is active [m].
    wave_front_speed : float
        Upper bound of the wave speed, which moves the edges of the window [m/s].
    """

    position: Array
    reach: float
    wave_front_speed: float


class Window(NamedTuple):
    """First and last active station."""

    first: int
    last: int


def build_window_arrays(line: DiscretisedLine, reach: float) -> WindowArrays:
    """Limits of the active window of a line; with an infinite reach the whole line is active."""
    front = max_wave_speed(line) if math.isfinite(reach) else math.inf
    return WindowArrays(line.mesh.position, reach, front)


def max_wave_speed(line: DiscretisedLine) -> float:
    """Upper bound of the speed of all waves of interest on any wire [m/s].

    Bending makes short waves faster: 10 % above sqrt(T / m) is sufficient up to about 60 Hz on a contact wire.
    """
    return 1.1 * math.sqrt(max(wire.tension / wire.mass_per_length for wire in line.catenary.wires))


def causal_reach(line: DiscretisedLine, speed: float, duration: float) -> float:
    """Half-width of the active window outside which the line cannot influence the contact forces.

    A wave of speed c needs the time R / (c - v) to get R ahead of a pantograph of speed v, and R / (c + v) to return
    from there; behind the pantograph the two are exchanged. It returns after the end if R > duration (c^2 - v^2) / 2c.

    Parameters
    ----------
    line : DiscretisedLine
        Discretised line.
    speed : float
        Speed of the pantographs [m/s].
    duration : float
        Simulated time [s].

    Returns
    -------
    float
        Half-width; infinite for a train faster than the waves [m].
    """
    c = max_wave_speed(line)
    return duration * (c * c - speed * speed) / (2 * c) if speed < c else math.inf


@njit(cache=True)
def active_window(limits: WindowArrays, train: Train) -> Window:
    """Stations within reach of a pantograph and behind its wave fronts; the whole line without a pantograph."""
    first, last = 0, limits.position.size - 1
    if train.position.size > 0:
        front = MIN_HALF_WIDTH + limits.wave_front_speed * train.elapsed[0]
        travelled = train.speed[0] * train.elapsed[0]
        behind = min(limits.reach, front + travelled)
        ahead = min(limits.reach, max(front - travelled, MIN_HALF_WIDTH))
        first = max(first, np.searchsorted(limits.position, train.position.min() - behind))
        last = min(last, np.searchsorted(limits.position, train.position.max() + ahead))
    return Window(first, last)


@njit(cache=True)
def pin_neighbours(motion: Motion, window: Window) -> None:
    """Hold the stations next to the active window at rest, so that an approaching train finds them at rest."""
    for s in (window.first - 1, window.last + 1):
        if 0 <= s < motion.w.shape[2]:
            for b in range(motion.w.shape[1]):
                for i in range(1, 3):
                    motion.w[i, b, s] = 0.0
                    motion.r[i, b, s] = 0.0

"""Central differences in time for the geometrically exact model, with one pantograph under the contact wire.

With the velocity at half steps, m (v+ - v-) / dt = f(r, v-) - c (v+ + v-) / 2 and r+ = r + dt v+. Internal damping uses
the velocity of the last half step.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from verification.formulations.exact_contact import ExactPantograph, add_contact, advance_pantograph
from verification.formulations.exact_forces import Scratch, allocate_scratch, sum_forces
from verification.formulations.exact_line import Array, ExactLine


class ExactMotion(NamedTuple):
    """Position at the end of a step and velocity half a step before, changed in place.

    Parameters
    ----------
    position, velocity : (3, N) ndarray
        Mass points [m, m/s].
    z, v : (n,) ndarray
        Unknowns of the pantograph [m, m/s].
    """

    position: Array
    velocity: Array
    z: Array
    v: Array


@njit(cache=True)
def advance(
    line: ExactLine,
    train: ExactPantograph,
    motion: ExactMotion,
    dt: float,
    x: float,
    drag: float,
    force: Array,
    scratch: Scratch,
) -> float:
    """Advance by one step and return the contact force [N].

    Parameters
    ----------
    line : ExactLine
        Line.
    train : ExactPantograph
        Pantograph.
    motion : ExactMotion
        State, changed in place.
    dt : float
        Time step [s].
    x : float
        Position of the pantograph along the track [m].
    drag : float
        Additional mass-proportional damping of all masses, for the relaxation to rest [1/s].
    force : (3, N) ndarray
        Scratch array for the forces [N].
    scratch : Scratch
        Scratch arrays.
    """
    position, velocity = motion.position, motion.velocity
    sum_forces(line, position, velocity, force, scratch)
    contact = add_contact(line, train, position, motion.z, x, force)
    mass, damping = line.mass, line.drag
    for k in range(3):
        r, v, f, free = position[k], velocity[k], force[k], line.free[k]
        for i in range(mass.size):
            half = dt * (damping[i] + drag * mass[i]) / 2
            v[i] = free[i] * ((mass[i] - half) * v[i] + dt * f[i]) / (mass[i] + half)
        for i in range(mass.size):
            r[i] += dt * v[i]
    advance_pantograph(train, motion.z, motion.v, dt, drag, contact)
    return contact


@njit(cache=True)
def relax(
    line: ExactLine, train: ExactPantograph, motion: ExactMotion, dt: float, x: float, duration: float, drag: float
) -> float:
    """Let line and pantograph come to rest; return the largest speed of a point at the end [m/s]."""
    force, scratch = np.zeros_like(motion.position), allocate_scratch(line.mass.size)
    for _ in range(round(duration / dt)):
        advance(line, train, motion, dt, x, drag, force, scratch)
    return float(np.abs(motion.velocity).max())


@njit(cache=True)
def march(
    line: ExactLine,
    train: ExactPantograph,
    motion: ExactMotion,
    dt: float,
    start: float,
    speed: float,
    interval: int,
    watched: Array,
    contact: Array,
    height: Array,
) -> None:
    """Run the pantograph along the line and record.

    Parameters
    ----------
    line, train, motion, dt
        As in `advance`.
    start, speed : float
        Position [m] and speed [m/s] of the pantograph.
    interval : int
        Number of steps per sample.
    watched : (U,) int ndarray
        Recorded points.
    contact : (T,) ndarray
        Filled with the mean contact force of every interval [N].
    height : (T, U) ndarray
        Filled with the height of the watched points at the end of every interval [m].
    """
    force, scratch = np.zeros_like(motion.position), allocate_scratch(line.mass.size)
    for n in range(contact.size):
        total = 0.0
        for k in range(interval):
            total += advance(line, train, motion, dt, start + speed * dt * (n * interval + k), 0.0, force, scratch)
        contact[n] = total / interval
        for u in range(watched.size):
            height[n, u] = motion.position[2, watched[u]]

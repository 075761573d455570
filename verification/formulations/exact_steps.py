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
    """Position at the end of a step and velocity half a step before, changed in place."""

    position: Array
    velocity: Array
    """Mass points, (3, N) [m, m/s]."""
    z: Array
    v: Array
    """Unknowns of the pantograph, (n,) [m, m/s]."""


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

    Args:
        line: Line.
        train: Pantograph.
        motion: State, changed in place.
        dt: Time step [s].
        x: Position of the pantograph along the track [m].
        drag: Additional mass-proportional damping of all masses, for the relaxation to rest [1/s].
        force: Scratch array for the forces, (3, N) [N].
        scratch: Scratch arrays.
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

    Args:
        line, train, motion, dt: As in `advance`.
        start, speed: Position [m] and speed [m/s] of the pantograph.
        interval: Number of steps per sample.
        watched: Recorded points, (U,) int.
        contact: Filled with the mean contact force of every interval, (T,) [N].
        height: Filled with the height of the watched points at the end of every interval, (T, U) [m].
    """
    force, scratch = np.zeros_like(motion.position), allocate_scratch(line.mass.size)
    for n in range(contact.size):
        total = 0.0
        for k in range(interval):
            total += advance(line, train, motion, dt, start + speed * dt * (n * interval + k), 0.0, force, scratch)
        contact[n] = total / interval
        for u in range(watched.size):
            height[n, u] = motion.position[2, watched[u]]

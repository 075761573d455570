"""Central differences in time for the geometrically exact model, with one pantograph under the contact wire.

With the velocity at half steps, m (v+ - v-) / dt = f(r, v-) - c (v+ + v-) / 2 and r+ = r + dt v+. Internal damping uses
the velocity of the last half step.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit

from pantocheck.model import DiscretisedLine, History, Passage
from pantocheck.model.description.pantograph import Pantograph
from verification.formulations.exact_forces import (
    ExactPantograph,
    Scratch,
    add_contact,
    advance_pantograph,
    allocate_scratch,
    sum_forces,
)
from verification.formulations.exact_line import Array, ExactLine, watched_points


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


# Passage of a pantograph along the geometrically exact model of a line.
TIME_STEP_PER_LENGTH = 2e-4
"""Time step over spacing: below the inverse of the speed of axial waves, about 1 / (3600 m/s) [s/m]."""
INTERVAL = 5e-4
"""Time between two samples [s]."""
RELAXATION, DRAG = 2.0, 10.0
"""Duration of a relaxation to rest [s], and mass-proportional damping close to critical for 0.8 Hz [1/s]."""
ADJUSTMENTS = 2
"""Number of adjustments of the dropper lengths, each after half a relaxation."""


@dataclass(frozen=True)
class Rest:
    """Line at rest without a pantograph."""

    line: ExactLine
    """Line with adjusted droppers."""
    position: Array
    """Positions of the points, (3, N) [m]."""
    speed: float
    """Largest speed at the end of the relaxation [m/s]."""

    @property
    def bar_tension(self) -> Array:
        """Tension of every dropper and steady arm, (B,) [N]."""
        bars = self.line.bars
        extent = self.position[:, bars.ends[:, 1]] - self.position[:, bars.ends[:, 0]]
        return bars.stiffness * (np.linalg.norm(extent, axis=0) - bars.length)


def time_step(line: ExactLine) -> float:
    """Time step of a line [s], a whole fraction of the sampling interval."""
    return float(INTERVAL / np.ceil(INTERVAL / (TIME_STEP_PER_LENGTH * line.wires.spacing.min()) - 1e-9))


def find_rest(line: ExactLine, position: Array) -> Rest:
    """Let a line come to rest and adjust its droppers, so that the contact wire hangs at its prescribed heights.

    Args:
        line: Line with the dropper lengths of the linear static state.
        position: Positions of the linear static state, (3, N) [m].
    """
    motion = ExactMotion(position.copy(), np.zeros_like(position), np.zeros(1), np.zeros(1))
    dt = time_step(line)
    droppers = line.bars.unilateral
    lower = line.bars.ends[droppers, 0]
    for _ in range(ADJUSTMENTS):
        relax(line, no_pantograph(), motion, dt, 0.0, RELAXATION / 2, DRAG)
        length = line.bars.length.copy()
        length[droppers] += motion.position[2, lower] - position[2, lower]
        line = line._replace(bars=line.bars._replace(length=length))
    speed = relax(line, no_pantograph(), motion, dt, 0.0, RELAXATION, DRAG)
    return Rest(line, motion.position, speed)


def simulate_exact_passage(discretised: DiscretisedLine, rest: Rest, passage: Passage) -> History:
    """Simulate a passage that starts like the reference simulator: at rest, with the full static force.

    Args:
        discretised: Line from which the exact model was built.
        rest: Exact model at rest.
        passage: Passage of one pantograph; its time step is that of the samples.

    Returns:
        Contact force and uplift at the watched supports.
    """
    (pantograph,), (start,) = passage.pantographs, passage.start
    train = _build_pantograph(pantograph)
    n = pantograph.head.size
    motion = ExactMotion(rest.position.copy(), np.zeros_like(rest.position), np.zeros(n), np.zeros(n))
    line, dt = rest.line, time_step(rest.line)
    relax(line, train, motion, dt, start, RELAXATION, DRAG)
    watched = watched_points(discretised, passage.watched)
    samples = round(passage.duration / INTERVAL)
    contact, height = np.zeros(samples), np.zeros((samples, watched.size))
    march(line, train, motion, dt, start, passage.speed, round(INTERVAL / dt), watched, contact, height)
    time = INTERVAL * (np.arange(samples) + 0.5)
    uplift = (height - rest.position[2, watched]).T[:, :, None]
    position = (start + passage.speed * time)[None]
    return History(time, position, contact[None], np.full_like(contact, np.nan)[None], uplift, contact[None])


def _build_pantograph(pantograph: Pantograph) -> ExactPantograph:
    return ExactPantograph(
        inverse_mass=np.linalg.inv(pantograph.mass),
        damping=pantograph.damping.copy(),
        stiffness=pantograph.stiffness.copy(),
        head=pantograph.head.copy(),
        force=pantograph.force.copy(),
        contact_stiffness=pantograph.contact_stiffness,
        wire=0,
    )


def no_pantograph() -> ExactPantograph:
    """A pantograph without contact, for the line alone."""
    nothing = np.zeros((1, 1))
    return ExactPantograph(np.eye(1), nothing, nothing, np.zeros(1), np.zeros(1), 0.0, 0)

"""Motion of the line about its initial state, as a time step needs it.

With the predictors q* = q + dt v + dt^2/4 a and v* = v + dt/2 a of Newmark's method, the state of one step follows from
that of the step before without a corrector:

    q* <- q* + dt v* + dt^2 a,    v* <- v* + dt a        and    q = q* + dt^2/4 a,    v = v* + dt/2 a

Arrays of a time step hold q*, v* and a. Their rows are longer than the line: whole vectors (`vectors`) and local
columns of the inverse may reach beyond its end, where everything is zero.
"""

from typing import NamedTuple

import numpy as np

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.kernel_compilation import kernel
from pantocheck.model.dynamics.vectors import align
from pantocheck.model.statics.static_solver import Deflection


class Layout(NamedTuple):
    """Number of stations of a line, and length of a row of an array of its motion."""

    stations: int
    width: int


class Motion(NamedTuple):
    """State of the line; B rows, S' stations with those beyond the end, F scalar forces (`scalar_forces`)."""

    w: Array
    r: Array
    """Deflection and slope, (3, B, S'): predicted displacement q*, predicted velocity v*, acceleration
    [m, -; per s; per s2].
    """
    force: Array
    """Scalar forces, (F,): tensions of the connectors [N], then those of the distributed forces."""
    load: Array
    """External load, upwards, (1,) [N]."""
    active: Indices
    """First and last station of the active window of the last step, (2,)."""


def build_motion(layout: Layout, time_step: float, fields: tuple[Array, Array], force: Array) -> Motion:
    """Build the state of a line.

    Args:
        layout: Layout of the rows.
        time_step: Time step [s].
        fields: Displacement, velocity and acceleration of deflections, and those of slopes, each (3, B, S).
        force: Scalar forces, (F,).
    """
    padded = [np.pad(field, ((0, 0), (0, 0), (0, layout.width - layout.stations))) for field in fields]
    for field in padded:
        field[0] -= time_step**2 / 4 * field[2]
        field[1] -= time_step / 2 * field[2]
    w, r = map(align, padded)
    return Motion(w, r, force.astype(np.float64), np.zeros(1), np.array([0, -1]))


def motion_at_rest(layout: Layout, deflection: Deflection, distributed: int = 0) -> Motion:
    """Build the state of a line at rest in a static deflection.

    The first step determines the distributed forces; zero is a first guess.
    """
    # Far from the loads the deflection decays to denormal numbers, which processors handle a hundred times slower.
    displacement = np.where(np.abs(deflection.displacement) < 1e-30, 0.0, deflection.displacement)
    w, r = (np.zeros((3, *displacement.shape[:2])) for _ in range(2))
    w[0], r[0] = displacement[..., 0], displacement[..., 1]
    return build_motion(layout, 0.0, (w, r), np.append(deflection.tension, np.zeros(distributed)))


def end_of_step(motion: Motion, layout: Layout, time_step: float) -> tuple[Array, Array]:
    """Displacement, velocity and acceleration at the end of the last step, of deflections and of slopes, (3, B, S)."""
    fields = []
    for field in (motion.w, motion.r):
        q, v, a = field[:, :, : layout.stations]
        fields.append(np.stack([q + time_step**2 / 4 * a, v + time_step / 2 * a, a]))
    return fields[0], fields[1]


@kernel
def hold_passed_stations(dt: float, motion: Motion, window: Window) -> None:
    """Hold the stations that have left the active window at rest at their last displacement."""
    first, last = motion.active[0], motion.active[1]
    motion.active[0], motion.active[1] = window.first, window.last
    for field in (motion.w, motion.r):
        for b in range(field.shape[1]):
            for s in range(first, min(window.first, last + 1)):
                _hold(dt, field, b, s)
            for s in range(max(first, window.last + 1), last + 1):
                _hold(dt, field, b, s)


@kernel
def _hold(dt: float, field: Array, row: int, station: int) -> None:
    """Hold one station at rest."""
    field[0, row, station] += dt * dt / 4 * field[2, row, station]
    field[1, row, station] = 0.0
    field[2, row, station] = 0.0

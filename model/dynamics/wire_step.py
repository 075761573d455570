"""Wires in a time step: predictors, forces of stiffness and damping, correctors.

The forces of an element with deflections w1, w2 and slopes r1, r2 split into a symmetric and an antisymmetric part:

    ^ F1      ^ F2        F1 = -(drag + shear)    drag :  both ends are pushed in the same direction
    o---------o           F2 = -(drag - shear)    shear:  the ends are pushed in opposite directions
    M1        M2          M1 = -(tilt + bend)     tilt :  both ends are turned in the same direction
                          M2 = -(tilt - bend)     bend :  the ends are turned in opposite directions

With the stiffness entries kij of the element and the deflections q + beta v (stiffness-proportional damping beta),

    shear = k11 (w1 - w2) + k12 (r1 + r2)           drag = 0
    tilt  = k12 (w1 - w2) + (k22 + k24)/2 (r1 + r2)
    bend  = (k22 - k24)/2 (r1 - r2)

With the velocities v, u of w, r and the damped mass m = alpha m_l h / 420 (mass-proportional damping alpha), the
consistent mass adds, in the same splitting,

    shear = m [ 51  (v1 - v2) +  4.5 h (u1 + u2)]       drag = m   [105   (v1 + v2) + 17.5 h (u1 - u2)]
    tilt  = m h [4.5 (v1 - v2) + 0.5 h (u1 + u2)]       bend = m h [ 17.5 (v1 + v2) +  3.5 h (u1 - u2)]

Eight stations are processed at a time (`vectors`), each from the predictor of its motion to its force.
"""

from typing import Any, NamedTuple

import numpy as np

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.extents import Extents, active_run, clip_extent, find_runs
from pantocheck.model.dynamics.kernel_compilation import inline_kernel, kernel
from pantocheck.model.dynamics.motion import Layout, Motion
from pantocheck.model.dynamics.vectors import LANES, align, load, shift_down, shift_up, splat, store
from pantocheck.model.fem.beams import Beams, element_stiffness

# Consistent mass over m_l h / 420 in the splitting above; a slope counts times h.
MASS_SHEAR, MASS_SHEAR_TILT, MASS_TILT = 51.0, 4.5, 0.5
MASS_DRAG, MASS_DRAG_BEND, MASS_BEND = 105.0, 17.5, 3.5

ENTRIES = 6
"""Number of values of an element in a time step."""


class WireArrays(NamedTuple):
    """Wires of a line in a time step; B rows, S' stations with those beyond the end of the line."""

    extents: Extents
    """Merged extents of the wires."""
    elements: Array
    """Entries k11, k12, (k22 + k24) / 2, (k22 - k24) / 2 of the stiffness of the element after each station
    [N/m, N, N m, N m], its mass times its mass-proportional damping, over 420 [kg/s], and its length [m],
    (U, 6, S'). Equal rows are stored once: U rows differ.
    """
    element_row: Indices
    """Index into `elements` of each row of wires, (B,)."""
    stiffness_coefficient: Array
    """Stiffness-proportional damping of the wires, (B,) [s]."""
    lumped_run: Indices
    """First of the springs and dampers on a single row of each run (`find_runs`), and Q, (R + 1,)."""
    lumped_station: Indices
    lumped_index: Indices
    """Stations of these parts, and their indices in a flattened plane of rows, (Q,)."""
    lumped_stiffness: Array
    lumped_damping: Array
    """Coefficients of these parts, (Q,) [N/m, N s/m]."""


def build_wire_arrays(beams: Beams, extents: Extents, layout: Layout) -> WireArrays:
    """Wires of a line in a time step, with the merged extents of its wires and the layout of its rows."""
    rows, elements = beams.mass_per_length.shape
    matrices = np.array([element_stiffness(beams, row) for row in range(rows)])
    k11, k12, k22, k24 = (matrices[:, :, i, j] for i, j in ((0, 0), (0, 1), (1, 1), (1, 3)))
    damped_mass = beams.mass_coefficient[:, None] * beams.mass_per_length * beams.length / 420
    length = np.broadcast_to(beams.length, k11.shape)
    values = np.zeros((rows, ENTRIES, layout.width))
    values[:, :, :elements] = np.stack([k11, k12, (k22 + k24) / 2, (k22 - k24) / 2, damped_mass, length], axis=1)
    # Both fields of a wire have the same elements, which then take half of the memory.
    number: dict[bytes, int] = {}
    element_row = np.array([number.setdefault(row.tobytes(), len(number)) for row in values], dtype=np.int64)
    different = values[np.unique(element_row, return_index=True)[1]]
    lumped = np.nonzero((beams.lumped_stiffness != 0) | (beams.lumped_damping != 0))
    row, station = lumped
    return WireArrays(
        extents=extents,
        elements=align(different),
        element_row=element_row,
        stiffness_coefficient=beams.stiffness_coefficient,
        lumped_run=find_runs(station),
        lumped_station=np.ascontiguousarray(station),
        lumped_index=row * layout.width + station,
        lumped_stiffness=beams.lumped_stiffness[lumped],
        lumped_damping=beams.lumped_damping[lumped],
    )


@kernel
def predict_wires(dt: float, wires: WireArrays, motion: Motion, window: Window) -> None:
    """Predict the motion of the active stations, and store the forces of the wires in place of their accelerations.

    The stations next to the active window are at rest: they hold its ends, and their prediction changes nothing.
    """
    for n in range(wires.extents.row.size):
        row, active = wires.extents.row[n], clip_extent(wires.extents, n, window)
        if active.first <= active.last:
            _predict_wire(
                dt,
                wires.stiffness_coefficient[row],
                wires.elements,
                wires.element_row[row],
                motion.w,
                motion.r,
                row,
                active,
            )


@kernel
def _predict_wire(
    dt: float, coefficient: float, elements: Array, element_row: int, w: Array, r: Array, row: int, active: Window
) -> None:
    """Predict the motion of one wire, and store its forces."""
    width = w.shape[2]
    plane = w.shape[1] * width
    at, e = row * width, element_row * ENTRIES * width
    delta, square, beta = splat(dt), splat(dt * dt), splat(coefficient)
    shear_before, drag_before, tilt_before, bend_before = splat(0.0), splat(0.0), splat(0.0), splat(0.0)
    start = max(active.first - LANES, 0)
    w0, v0 = _predict(w, at + start, plane, delta, square)
    r0, u0 = _predict(r, at + start, plane, delta, square)
    for s in range(start, active.last + 1, LANES):
        # Eight stations, and those after each of them.
        w_next, v_next = _predict(w, at + s + LANES, plane, delta, square)
        r_next, u_next = _predict(r, at + s + LANES, plane, delta, square)
        v1, u1 = shift_down(v0, v_next), shift_down(u0, u_next)
        damped_w, damped_r = w0 + beta * v0, r0 + beta * u0
        difference = damped_w - shift_down(damped_w, w_next + beta * v_next)
        slope_1 = shift_down(damped_r, r_next + beta * u_next)
        total = damped_r + slope_1
        k12 = load(elements, e + width + s)
        shear = load(elements, e + s) * difference + k12 * total
        tilt = k12 * difference + load(elements, e + 2 * width + s) * total
        bend = load(elements, e + 3 * width + s) * (damped_r - slope_1)
        mass, length = load(elements, e + 4 * width + s), load(elements, e + 5 * width + s)
        apart, along = v0 - v1, v0 + v1
        alike, against = length * (u0 + u1), length * (u0 - u1)
        shear = shear + mass * (splat(MASS_SHEAR) * apart + splat(MASS_SHEAR_TILT) * alike)
        drag = mass * (splat(MASS_DRAG) * along + splat(MASS_DRAG_BEND) * against)
        moment = mass * length
        tilt = tilt + moment * (splat(MASS_SHEAR_TILT) * apart + splat(MASS_TILT) * alike)
        bend = bend + moment * (splat(MASS_DRAG_BEND) * along + splat(MASS_BEND) * against)
        if s >= active.first:
            # Reactions of the elements before and after each station.
            force = (shift_up(shear, shear_before) - shear) - (shift_up(drag, drag_before) + drag)
            couple = (shift_up(bend, bend_before) - bend) - (shift_up(tilt, tilt_before) + tilt)
            store(w, at + 2 * plane + s, force)
            store(r, at + 2 * plane + s, couple)
        shear_before, drag_before, tilt_before, bend_before = shear, drag, tilt, bend
        w0, v0, r0, u0 = w_next, v_next, r_next, u_next


@inline_kernel
def _predict(field: Array, at: int, plane: int, delta: Any, square: Any) -> tuple[Any, Any]:
    """Predict displacement and velocity of eight stations."""
    q, v, a = load(field, at), load(field, at + plane), load(field, at + 2 * plane)
    q, v = q + (delta * v + square * a), v + delta * a
    store(field, at, q)
    store(field, at + plane, v)
    return q, v


@kernel
def add_lumped_forces(wires: WireArrays, motion: Motion, window: Window) -> None:
    """Add the forces of the active springs and dampers on single rows."""
    w = motion.w.reshape(motion.w.size)
    plane = motion.w.shape[1] * motion.w.shape[2]
    for k in range(wires.lumped_run.size - 1):
        first, end = active_run(wires.lumped_station, wires.lumped_run, k, window)
        for n in range(first, end):
            at = wires.lumped_index[n]
            elastic, viscous = wires.lumped_stiffness[n] * w[at], wires.lumped_damping[n] * w[at + plane]
            w[at + 2 * plane] -= elastic + viscous

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
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from pantocheck.model.arrays import Array, Indices
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.extents import Extents, active_run, clip_extent, find_extents, find_runs
from pantocheck.model.dynamics.motion import Motion
from pantocheck.model.fem.beams import Beams, element_stiffness

PIECE = 256
"""Number of elements of a wire that are processed together, so that they stay in the fastest cache."""

# Consistent mass over m_l h / 420 in the splitting above; a slope counts times h.
MASS_SHEAR, MASS_SHEAR_TILT, MASS_TILT = 51.0, 4.5, 0.5
MASS_DRAG, MASS_DRAG_BEND, MASS_BEND = 105.0, 17.5, 3.5


class WireArrays(NamedTuple):
    """Wires of a line in a time step; B rows, S stations.

    Parameters
    ----------
    extents : Extents
        Extents of the wires.
    length : (S-1,) ndarray
        Lengths of the elements [m].
    stiffness : (B, 4, S-1) ndarray
        Entries k11, k12, (k22 + k24) / 2, (k22 - k24) / 2 of the stiffness of each element [N/m, N, N m, N m].
    damped_mass : (B, S-1) ndarray
        Mass of each element times its mass-proportional damping, over 420 [kg/s].
    mass_coefficient, stiffness_coefficient : (B,) ndarray
        Rayleigh damping of the wires [1/s, s].
    lumped_run : (R + 1,) int ndarray
        First of the springs and dampers on a single row of each run (`find_runs`), and Q.
    lumped_row, lumped_station : (Q,) int ndarray
        Their rows and stations.
    lumped_stiffness, lumped_damping : (Q,) ndarray
        Their coefficients [N/m, N s/m].
    """

    extents: Extents
    length: Array
    stiffness: Array
    damped_mass: Array
    mass_coefficient: Array
    stiffness_coefficient: Array
    lumped_run: Indices
    lumped_row: Indices
    lumped_station: Indices
    lumped_stiffness: Array
    lumped_damping: Array


class ElementForces(NamedTuple):
    """Forces of a piece of wire; entry 0 belongs to the last element of the piece before, the others to its elements.

    Parameters
    ----------
    shear, drag : (PIECE + 1,) ndarray
        Antisymmetric and symmetric force on the ends [N].
    tilt, bend : (PIECE + 1,) ndarray
        Symmetric and antisymmetric moment on the ends [N m].
    """

    shear: Array
    drag: Array
    tilt: Array
    bend: Array


class WireWorkspace(NamedTuple):
    """Scratch arrays of `apply_wire_forces`: deflection and slope of a piece plus damping times their rates, forces."""

    w: Array
    r: Array
    forces: ElementForces


class PieceStiffness(NamedTuple):
    """Stiffness entries k11, k12, (k22 + k24) / 2, (k22 - k24) / 2 of the elements of a piece, (n,) ndarrays."""

    shear: Array
    coupling: Array
    tilt: Array
    bend: Array


def build_wire_arrays(beams: Beams) -> WireArrays:
    """Wires of a line in a time step."""
    matrices = np.array([element_stiffness(beams, row) for row in range(len(beams.mass_per_length))])
    k11, k12, k22, k24 = (matrices[:, :, i, j] for i, j in ((0, 0), (0, 1), (1, 1), (1, 3)))
    lumped = np.nonzero((beams.lumped_stiffness != 0) | (beams.lumped_damping != 0))
    lumped_row, lumped_station = (np.ascontiguousarray(index) for index in lumped)
    return WireArrays(
        extents=find_extents(beams),
        length=beams.length,
        stiffness=np.stack([k11, k12, (k22 + k24) / 2, (k22 - k24) / 2], axis=1),
        damped_mass=beams.mass_coefficient[:, None] * beams.mass_per_length * beams.length / 420,
        mass_coefficient=beams.mass_coefficient,
        stiffness_coefficient=beams.stiffness_coefficient,
        lumped_run=find_runs(lumped_station),
        lumped_row=lumped_row,
        lumped_station=lumped_station,
        lumped_stiffness=beams.lumped_stiffness[lumped],
        lumped_damping=beams.lumped_damping[lumped],
    )


def allocate_wire_workspace() -> WireWorkspace:
    """Scratch arrays for one simulation."""
    arrays = [np.zeros(PIECE + 1) for _ in range(6)]
    return WireWorkspace(arrays[0], arrays[1], ElementForces(*arrays[2:]))


@njit(cache=True)
def predict_wires(dt: float, extents: Extents, motion: Motion, window: Window) -> None:
    """Replace displacement and velocity of the active stations by Newmark's predictors."""
    for field in (motion.w, motion.r):
        for n in range(extents.row.size):
            q, v, a = _active(field, extents, n, window)
            for s in range(q.size):
                q[s] += dt * v[s] + dt * dt / 4 * a[s]
            for s in range(q.size):
                v[s] += dt / 2 * a[s]


@njit(cache=True)
def correct_wires(dt: float, extents: Extents, motion: Motion, window: Window) -> None:
    """Complete the predictors with the accelerations at the end of the step."""
    for field in (motion.w, motion.r):
        for n in range(extents.row.size):
            q, v, a = _active(field, extents, n, window)
            for s in range(q.size):
                q[s] += dt * dt / 4 * a[s]
            for s in range(q.size):
                v[s] += dt / 2 * a[s]


@njit(cache=True)
def _active(field: Array, extents: Extents, n: int, window: Window) -> tuple[Array, Array, Array]:
    """Displacement, velocity and acceleration of the active stations of a wire."""
    row, active = extents.row[n], clip_extent(extents, n, window)
    first, end = active.first, max(active.last + 1, active.first)
    return field[0, row, first:end], field[1, row, first:end], field[2, row, first:end]


@njit(cache=True)
def apply_wire_forces(wires: WireArrays, motion: Motion, work: WireWorkspace, window: Window) -> None:
    """Store forces and moments of wires and lumped parts on the active stations in place of their accelerations.

    The wires are processed in pieces that stay in the fastest cache, and every loop fills one or two arrays from a few
    others: in this form they compile to vector instructions. One more station on either side, at rest, holds the
    active part.
    """
    widened = Window(window.first - 1, window.last + 1)
    forces = work.forces
    for wire in range(wires.extents.row.size):
        b = wires.extents.row[wire]
        first, last = clip_extent(wires.extents, wire, widened)
        if first >= last:
            continue
        for force in forces:
            force[:] = 0.0  # there is no element before the first
        for start in range(first, last, PIECE):
            end = min(start + PIECE, last)
            n = end - start
            v, u = motion.w[1, b, start : end + 1], motion.r[1, b, start : end + 1]
            w, r = work.w[: n + 1], work.r[: n + 1]
            _add_rate(motion.w[0, b, start : end + 1], v, wires.stiffness_coefficient[b], w)
            _add_rate(motion.r[0, b, start : end + 1], u, wires.stiffness_coefficient[b], r)
            elements = ElementForces(
                forces.shear[1 : n + 1], forces.drag[1 : n + 1], forces.tilt[1 : n + 1], forces.bend[1 : n + 1]
            )
            # Four slices instead of one: the compiler must know that the entries of each lie side by side.
            stiffness = PieceStiffness(
                wires.stiffness[b, 0, start:end],
                wires.stiffness[b, 1, start:end],
                wires.stiffness[b, 2, start:end],
                wires.stiffness[b, 3, start:end],
            )
            _stiffness_forces(stiffness, w, r, elements)
            if wires.mass_coefficient[b] == 0.0:
                elements.drag[:] = 0.0
            else:
                mass, length = wires.damped_mass[b, start:end], wires.length[start:end]
                _add_antisymmetric_damping(mass, length, v, u, elements)
                _add_symmetric_damping(mass, length, v, u, elements)
            _add_reactions(forces.shear[: n + 1], forces.drag[: n + 1], motion.w[2, b, start:end])
            _add_reactions(forces.bend[: n + 1], forces.tilt[: n + 1], motion.r[2, b, start:end])
            for force in forces:
                force[0] = force[n]
        motion.w[2, b, last] = forces.shear[0] - forces.drag[0]
        motion.r[2, b, last] = forces.bend[0] - forces.tilt[0]
    for k in range(wires.lumped_run.size - 1):
        start = wires.lumped_run[k]
        first, end = active_run(wires.lumped_station[start : wires.lumped_run[k + 1]], window)
        for n in range(start + first, start + end):
            b, s = wires.lumped_row[n], wires.lumped_station[n]
            elastic, viscous = (
                wires.lumped_stiffness[n] * motion.w[0, b, s],
                wires.lumped_damping[n] * motion.w[1, b, s],
            )
            motion.w[2, b, s] -= elastic + viscous


@njit(cache=True)
def _add_rate(q: Array, v: Array, coefficient: float, damped: Array) -> None:
    """Displacement plus stiffness-proportional damping times velocity."""
    for s in range(damped.size):
        damped[s] = q[s] + coefficient * v[s]


@njit(cache=True)
def _stiffness_forces(stiffness: PieceStiffness, w: Array, r: Array, forces: ElementForces) -> None:
    """Forces of the stiffness under deflections w and slopes r; the drag is zero."""
    w0, w1, r0, r1 = w, w[1:], r, r[1:]
    shear, tilt, bend = forces.shear, forces.tilt, forces.bend
    k11, k12, k_tilt, k_bend = stiffness.shear, stiffness.coupling, stiffness.tilt, stiffness.bend
    for e in range(shear.size):
        difference, total = w0[e] - w1[e], r0[e] + r1[e]
        shear[e] = k11[e] * difference + k12[e] * total
        tilt[e] = k12[e] * difference + k_tilt[e] * total
    for e in range(shear.size):
        bend[e] = k_bend[e] * (r0[e] - r1[e])


@njit(cache=True)
def _add_antisymmetric_damping(mass: Array, length: Array, v: Array, u: Array, forces: ElementForces) -> None:
    """Damping of the consistent mass against deflection velocities v that differ and slope velocities u that add."""
    v0, v1, u0, u1 = v, v[1:], u, u[1:]
    shear, tilt = forces.shear, forces.tilt
    for e in range(shear.size):
        difference, total = v0[e] - v1[e], length[e] * (u0[e] + u1[e])
        shear[e] += mass[e] * (MASS_SHEAR * difference + MASS_SHEAR_TILT * total)
        tilt[e] += mass[e] * length[e] * (MASS_SHEAR_TILT * difference + MASS_TILT * total)


@njit(cache=True)
def _add_symmetric_damping(mass: Array, length: Array, v: Array, u: Array, forces: ElementForces) -> None:
    """Damping of the consistent mass against deflection velocities v that add and slope velocities u that differ."""
    v0, v1, u0, u1 = v, v[1:], u, u[1:]
    drag, bend = forces.drag, forces.bend
    for e in range(drag.size):
        total, difference = v0[e] + v1[e], length[e] * (u0[e] - u1[e])
        drag[e] = mass[e] * (MASS_DRAG * total + MASS_DRAG_BEND * difference)
        bend[e] += mass[e] * length[e] * (MASS_DRAG_BEND * total + MASS_BEND * difference)


@njit(cache=True)
def _add_reactions(antisymmetric: Array, symmetric: Array, force: Array) -> None:
    """Store the reactions of the elements before and after each station."""
    a0, a1, s0, s1 = antisymmetric, antisymmetric[1:], symmetric, symmetric[1:]
    for s in range(force.size):
        force[s] = (a0[s] - a1[s]) - (s0[s] + s1[s])

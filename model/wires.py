"""The wires' part of a time step: predictors, forces of stiffness and damping, correctors."""

import numpy as np
from numba import njit
from numpy.typing import NDArray
from pantocheck.model.state import PIECE, Line, Motion, Workspace

Array = NDArray[np.float64]


@njit(cache=True)
def predict_wires(dt: float, motion: Motion, first: int, last: int) -> None:
    """Turn displacement and velocity between two stations into Newmark's predictors, in place."""
    for now in (motion.w, motion.r):
        for b in range(now.shape[1]):
            q, v, a = now[0, b, first : last + 1], now[1, b, first : last + 1], now[2, b, first : last + 1]
            for s in range(q.size):
                q[s] += dt * v[s] + dt * dt / 4 * a[s]
            for s in range(q.size):
                v[s] += dt / 2 * a[s]


@njit(cache=True)
def correct_wires(dt: float, motion: Motion, first: int, last: int) -> None:
    """Turn the predictors back into displacement and velocity, with the accelerations that were found."""
    for now in (motion.w, motion.r):
        for b in range(now.shape[1]):
            q, v, a = now[0, b, first : last + 1], now[1, b, first : last + 1], now[2, b, first : last + 1]
            for s in range(q.size):
                q[s] += dt * dt / 4 * a[s]
            for s in range(q.size):
                v[s] += dt / 2 * a[s]


@njit(cache=True)
def wire_forces(line: Line, motion: Motion, work: Workspace, first: int, last: int) -> None:
    """Forces and moments that wires and lumped parts exert on the stations, in place of their accelerations.

    The loops are cut so that each fills one array from a few others, in which form they compile to vector instructions,
    and the line into pieces that stay in the fastest cache from loop to loop.
    """
    for b in range(motion.w.shape[1]):
        for now in (motion.w, motion.r):
            now[2, b, first : last + 1] = 0.0
        for start in range(first, last, PIECE):
            end = min(start + PIECE, last)
            k = line.stiffness_entries[b]
            q, v, f = motion.w[0, b, start : end + 1], motion.w[1, b, start : end + 1], motion.w[2, b, start : end + 1]
            t, u, m = motion.r[0, b, start : end + 1], motion.r[1, b, start : end + 1], motion.r[2, b, start : end + 1]
            c, seen_q, seen_t = line.stiffness_coefficient[b], work.seen[0, : q.size], work.seen[1, : q.size]
            for s in range(q.size):
                seen_q[s] = q[s] + c * v[s]
            for s in range(q.size):
                seen_t[s] = t[s] + c * u[s]
            shear = work.shear[: end - start]
            k11, k12, k22, k24 = k[0, start:end], k[1, start:end], k[2, start:end], k[3, start:end]
            _add_stiffness_forces(k11, k12, k22, k24, seen_q, seen_t, shear, f, m)
            c = line.mass_coefficient[b]
            if c != 0.0:
                _add_mass_damping(c, line.mass_scale[b, start:end], line.length[start:end], v, u, f, m)
        q, v, f = motion.w[0, b, first : last + 1], motion.w[1, b, first : last + 1], motion.w[2, b, first : last + 1]
        spring, damper = line.lumped_stiffness[b, first : last + 1], line.lumped_damping[b, first : last + 1]
        for s in range(f.size):
            f[s] -= spring[s] * q[s] + damper[s] * v[s]


@njit(cache=True)
def _add_stiffness_forces(
    k11: Array, k12: Array, k22: Array, k24: Array, p: Array, t: Array, shear: Array, w: Array, r: Array
) -> None:
    """Forces of beam elements in deflections p and slopes t."""
    p0, p1, t0, t1 = p[:-1], p[1:], t[:-1], t[1:]
    w0, w1, r0, r1 = w[:-1], w[1:], r[:-1], r[1:]
    for e in range(shear.size):
        shear[e] = k11[e] * (p0[e] - p1[e]) + k12[e] * (t0[e] + t1[e])
    for e in range(shear.size):
        w0[e] -= shear[e]
    for e in range(shear.size):
        w1[e] += shear[e]
    for e in range(shear.size):
        r0[e] -= k12[e] * (p0[e] - p1[e]) + k22[e] * t0[e] + k24[e] * t1[e]
    for e in range(shear.size):
        r1[e] -= k12[e] * (p0[e] - p1[e]) + k24[e] * t0[e] + k22[e] * t1[e]


@njit(cache=True)
def _add_mass_damping(c: float, scale: Array, length: Array, v: Array, u: Array, w: Array, r: Array) -> None:
    """Damping proportional to the consistent mass of beam elements, in velocities v and u of deflection and slope."""
    v0, v1, u0, u1 = v[:-1], v[1:], u[:-1], u[1:]
    w0, w1, r0, r1 = w[:-1], w[1:], r[:-1], r[1:]
    for e in range(scale.size):
        w0[e] -= c * scale[e] * (156 * v0[e] + 54 * v1[e] + length[e] * (22 * u0[e] - 13 * u1[e]))
    for e in range(scale.size):
        w1[e] -= c * scale[e] * (54 * v0[e] + 156 * v1[e] + length[e] * (13 * u0[e] - 22 * u1[e]))
    for e in range(scale.size):
        r0[e] -= c * scale[e] * length[e] * (22 * v0[e] + 13 * v1[e] + length[e] * (4 * u0[e] - 3 * u1[e]))
    for e in range(scale.size):
        r1[e] += c * scale[e] * length[e] * (13 * v0[e] + 22 * v1[e] + length[e] * (3 * u0[e] - 4 * u1[e]))

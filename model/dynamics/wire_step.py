"""The wires' part of a time step: predictors, forces of stiffness and damping, correctors."""

from numba import njit

from pantocheck.model.arrays import Array
from pantocheck.model.dynamics.state import PIECE, KernelArrays, Motion, Workspace


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
def wire_forces(line: KernelArrays, motion: Motion, work: Workspace, first: int, last: int) -> None:
    """Forces and moments that wires and lumped parts exert on the stations, in place of their accelerations.

    Each element pushes its ends alike (drag) and apart (shear), and turns them alike (tilt) and apart (bend). The line
    is cut into pieces that stay in the fastest cache, and every loop fills one or two arrays from a few others: in that
    form they compile to vector instructions. One station more on either side stands still and holds the moving part.
    """
    lo, hi = max(first - 1, 0), min(last + 1, line.position.size - 1)
    for b in range(motion.w.shape[1]):
        work.forces[:, 0] = 0.0  # there is no element before the first
        for start in range(lo, hi, PIECE):
            end = min(start + PIECE, hi)
            n = end - start
            v, u = motion.w[1, b, start : end + 1], motion.r[1, b, start : end + 1]
            seen_w, seen_r = work.seen[0, : n + 1], work.seen[1, : n + 1]
            shear, drag, tilt, bend = (
                work.forces[0, : n + 1],
                work.forces[1, : n + 1],
                work.forces[2, : n + 1],
                work.forces[3, : n + 1],
            )
            _add_rate(motion.w[0, b, start : end + 1], v, line.stiffness_coefficient[b], seen_w)
            _add_rate(motion.r[0, b, start : end + 1], u, line.stiffness_coefficient[b], seen_r)
            # Not cut from one slice of all four: their entries must be known to lie side by side.
            k11, k12 = line.stiffness_entries[b, 0, start:end], line.stiffness_entries[b, 1, start:end]
            alike, apart = line.stiffness_entries[b, 2, start:end], line.stiffness_entries[b, 3, start:end]
            _stiffness_forces(k11, k12, alike, apart, seen_w, seen_r, shear[1:], tilt[1:], bend[1:])
            if line.mass_coefficient[b] == 0.0:
                drag[1:] = 0.0
            else:
                mass, length = line.damping_mass[b, start:end], line.length[start:end]
                _add_apart(mass, length, v, u, shear[1:], tilt[1:])
                _add_alike(mass, length, v, u, drag[1:], bend[1:])
            _gather(shear, drag, motion.w[2, b, start:end])
            _gather(bend, tilt, motion.r[2, b, start:end])
            for i in range(4):
                work.forces[i, 0] = work.forces[i, n]
        motion.w[2, b, hi] = work.forces[0, 0] - work.forces[1, 0]
        motion.r[2, b, hi] = work.forces[3, 0] - work.forces[2, 0]
    for n in range(line.lumped_row.size):
        b, s = line.lumped_row[n], line.lumped_station[n]
        if first <= s <= last:
            held = line.lumped_stiffness[n] * motion.w[0, b, s] + line.lumped_damping[n] * motion.w[1, b, s]
            motion.w[2, b, s] -= held


@njit(cache=True)
def _add_rate(q: Array, v: Array, c: float, seen: Array) -> None:
    """What a stiffness with damping in proportion sees."""
    for s in range(seen.size):
        seen[s] = q[s] + c * v[s]


@njit(cache=True)
def _stiffness_forces(
    k11: Array, k12: Array, alike: Array, apart: Array, w: Array, r: Array, shear: Array, tilt: Array, bend: Array
) -> None:
    """Forces of beam elements in deflections w and slopes r."""
    w0, w1, r0, r1 = w[:-1], w[1:], r[:-1], r[1:]
    for e in range(shear.size):
        d, s = w0[e] - w1[e], r0[e] + r1[e]
        shear[e] = k11[e] * d + k12[e] * s
        tilt[e] = k12[e] * d + alike[e] * s
    for e in range(shear.size):
        bend[e] = apart[e] * (r0[e] - r1[e])


@njit(cache=True)
def _add_apart(mass: Array, length: Array, v: Array, u: Array, shear: Array, tilt: Array) -> None:
    """Damping by the consistent mass of elements whose ends move apart with velocities v and turn alike with u."""
    v0, v1, u0, u1 = v[:-1], v[1:], u[:-1], u[1:]
    for e in range(shear.size):
        d, s = v0[e] - v1[e], length[e] * (u0[e] + u1[e])
        shear[e] += mass[e] * (51.0 * d + 4.5 * s)
        tilt[e] += mass[e] * length[e] * (4.5 * d + 0.5 * s)


@njit(cache=True)
def _add_alike(mass: Array, length: Array, v: Array, u: Array, drag: Array, bend: Array) -> None:
    """The same of elements whose ends move alike and turn apart."""
    v0, v1, u0, u1 = v[:-1], v[1:], u[:-1], u[1:]
    for e in range(drag.size):
        s, d = v0[e] + v1[e], length[e] * (u0[e] - u1[e])
        drag[e] = mass[e] * (105.0 * s + 17.5 * d)
        bend[e] += mass[e] * length[e] * (17.5 * s + 3.5 * d)


@njit(cache=True)
def _gather(apart: Array, alike: Array, force: Array) -> None:
    """Forces on stations from those of the elements before and after them, which resist."""
    a0, a1, b0, b1 = apart[:-1], apart[1:], alike[:-1], alike[1:]
    for s in range(force.size):
        force[s] = (a0[s] - a1[s]) - (b0[s] + b1[s])

"""Contact force and pantographs in the time step of the second formulation."""

import numpy as np
from numba import njit

from verification.formulations.difference_line import Heads, Lines
from verification.formulations.difference_strands import Floats, Indices

JOINT_SWEEPS = 20
"""Sweeps over the joints of a pantograph in a step."""
HERTZ_ITERATIONS = 40
"""Iterations of the penetration by Hertz's law; each is nearer by the excess flexibility over that of the contact."""


@njit(cache=True)
def accelerate_pantograph(heads: Heads, k: int, dt: float) -> None:
    """Velocities of a pantograph at the end of a step under all forces but those of the contacts."""
    z, u, n = heads.height[k], heads.velocity[k].copy(), heads.mass.shape[1]
    for i in range(n):
        force = heads.load[k, i]
        for j in range(n):
            force -= heads.stiffness[k, i, j] * z[j] + heads.damping[k, i, j] * u[j]
        heads.velocity[k, i] += dt * force / heads.mass[k, i]


@njit(cache=True)
def hold_joints(heads: Heads, k: int, dt: float, force: Floats) -> None:
    """Velocities of a pantograph at the end of a step under the forces of its joints, too.

    A joint feels the velocities at the end of the step: below the speed of sliding, friction is stiffer than a step.
    """
    force[:] = 0.0
    for _ in range(JOINT_SWEEPS):
        for j in range(force.size):
            stiffness, damper, gap, lower, upper = heads.joint_law[k, j]
            closing, rate, mobility = -gap, 0.0, 0.0
            for i in range(heads.joint.shape[2]):
                direction = heads.joint[k, j, i]
                closing += direction * heads.height[k, i]
                rate += direction * heads.velocity[k, i]
                mobility += dt * direction**2 / heads.mass[k, i]
            free = stiffness * closing + damper * (rate + mobility * force[j])
            change = min(max(free / (1 + damper * mobility), lower), upper) - force[j]
            force[j] += change
            for i in range(heads.joint.shape[2]):
                heads.velocity[k, i] -= dt * heads.joint[k, j, i] * change / heads.mass[k, i]


@njit(cache=True)
def shape_strip(line: Lines, heads: Heads, k: int, strip: int, x: float, w: Floats) -> Floats:
    """Displacement of a strip per unknown, at the lateral position of the wire above it; x in spacings of points."""
    shape, power, y = np.zeros(heads.shape.shape[3]), 1.0, 0.0
    if line.lateral >= 0:
        i, s = line.first[line.lateral] + int(x), x - int(x)
        y = (1 - s) * (line.rest[i] + w[i]) + s * (line.rest[i + 1] + w[i + 1])
    for n in range(heads.shape.shape[2]):
        shape += power * heads.shape[k, strip, n]
        power *= y
    return shape


@njit(cache=True)
def push_wire(line: Lines, heads: Heads, k: int, strip: int, w: Floats, v: Floats) -> float:
    """Contact force of a strip, applied to strip and wire: a Catmull-Rom spline interpolates and distributes.

    Points are too flexible by their excess, so the penetration is the gap and this excess times the force. A constraint
    (infinite stiffness) lets strip and wire meet at the end of the step, at the strip's next position; the excess then
    remains as a penetration, which the spacing removes.
    """
    constrained = np.isinf(heads.contact_stiffness) and np.isinf(heads.hertz)
    x = (heads.position[k] + heads.offset[k, strip] + heads.speed * line.step * constrained) / line.spacing
    s, point = x - int(x), line.first[line.contact] + int(x) - 1
    shape = shape_strip(line, heads, k, strip, x, w)
    weights = (
        0.5 * (-s + 2 * s**2 - s**3),
        0.5 * (2 - 5 * s**2 + 3 * s**3),
        0.5 * (s + 4 * s**2 - 3 * s**3),
        0.5 * (-(s**2) + s**3),
    )
    slopes = (
        0.5 * (-1 + 4 * s - 3 * s**2),
        0.5 * (-10 * s + 9 * s**2),
        0.5 * (1 + 8 * s - 9 * s**2),
        s * (1.5 * s - 1),
    )
    height, excess, mobility, gap, closing, push = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(shape.size):
        mobility += line.step * shape[i] ** 2 / heads.mass[k, i]
        gap += shape[i] * heads.height[k, i]
        closing += shape[i] * heads.velocity[k, i]
    for j in range(4):
        mobility += line.gain[point + j] * weights[j] ** 2
        height += weights[j] * (w[point + j] + line.rest[point + j])
        closing -= weights[j] * v[point + j]
        for m in range(4):
            excess += weights[j] * line.excess[abs(j - m)] * weights[m]
    if constrained:
        push = max(0.0, ((gap - height) / line.step + closing) / mobility)
    elif not np.isinf(heads.hertz):
        for _ in range(HERTZ_ITERATIONS):
            push = heads.hertz * max(0.0, gap - height + excess * push) ** 1.5
    else:
        for j in range(4):
            closing -= heads.speed / line.spacing * slopes[j] * (w[point + j] + line.rest[point + j])
        law = heads.contact_stiffness * (gap - height) + heads.contact_damping * closing
        push = max(0.0, law / (1 - heads.contact_stiffness * excess))
    for j in range(4):
        v[point + j] += line.gain[point + j] * weights[j] * push
    for i in range(shape.size):
        heads.velocity[k, i] -= line.step * shape[i] * push / heads.mass[k, i]
    return push


# Time step of the second formulation: explicit central differences in time (leapfrog).
#
# v[n+1/2] = v[n-1/2] + dt M^-1 f(w[n], v[n-1/2]),    w[n+1] = w[n] + dt v[n+1/2]
#
# f takes the velocity half a step late, except for dampers to the ground and mass-proportional damping, which are
# centred. All masses are lumped at points. Arms are rigid along their length: the velocity of their clamps has no
# component in that direction.
@njit(cache=True, fastmath=True)
def _move(w: Floats, v: Floats, p: Floats, dt: float, delay: float, first: int, end: int) -> None:
    """Displacements w of the next time level, and p = w + delay v, with which wires are damped."""
    for i in range(first, end):
        w[i] += dt * v[i]
        p[i] = w[i] + delay * v[i]


@njit(cache=True, fastmath=True)
def _accelerate(
    v: Floats, p: Floats, keep: float, gain: float, string: float, bending: float, first: int, end: int
) -> None:
    """Velocities of the inner points of a strand from the second and fourth differences."""
    for i in range(first, end):
        second = p[i - 1] - 2 * p[i] + p[i + 1]
        fourth = p[i - 2] - 4 * p[i - 1] + 6 * p[i] - 4 * p[i + 1] + p[i + 2]
        v[i] = keep * v[i] + gain * (string * second - bending * fourth)


@njit(cache=True)
def _force_near_end(p: Floats, i: int, inward: int, string: float, bending: float) -> float:
    """Force on the point next to an end without moment; `inward` is +1 or -1."""
    curvature = p[i - inward] - 2 * p[i] + p[i + inward]
    following = p[i] - 2 * p[i + inward] + p[i + 2 * inward]
    return string * curvature - bending * (following - 2 * curvature)


@njit(cache=True)
def _force_at_end(p: Floats, i: int, inward: int, string: float, bending: float) -> float:
    """Force of a strand on its end point."""
    curvature = p[i] - 2 * p[i + inward] + p[i + 2 * inward]
    return string * (p[i + inward] - p[i]) - bending * curvature


@njit(cache=True)
def _stretch_bars(line: Lines, w: Floats, v: Floats, tension: Floats) -> None:
    """Change of the tension of every bar from the state of rest."""
    for b in range(tension.size):
        d, rate = 0.0, 0.0
        for j in range(line.bar_first[b], line.bar_first[b + 1]):
            d += line.bar_coefficient[j] * w[line.bar_point[j]]
            rate += line.bar_coefficient[j] * v[line.bar_point[j]]
        tension[b] = max(line.bar_stiffness[b] * d + line.bar_damping[b] * rate, -line.bar_preload[b])


@njit(cache=True)
def _move_strands(line: Lines, v: Floats, p: Floats, before: Floats) -> None:
    """Velocities of all points from the forces of the wires; points with other masses are computed again."""
    for j in range(line.special.size):
        before[j] = v[line.special[j]]
    for g in range(line.first.size):
        first, end = line.first[g], line.first[g] + line.count[g]
        keep, gain = line.strand_keep[g], line.strand_gain[g]
        _accelerate(v, p, keep, gain, line.string[g], line.bending[g], first + 2, end - 2)
    for j in range(line.special.size):
        i, g = line.special[j], line.special_strand[j]
        first, last = line.first[g], line.first[g] + line.count[g] - 1
        if i == first + 1 or i == last - 1:
            pull = _force_near_end(p, i, 1 if i == first + 1 else -1, line.string[g], line.bending[g])
        else:
            pull = (v[i] - line.strand_keep[g] * before[j]) / line.strand_gain[g]
        v[i] = line.keep[i] * before[j] + line.gain[i] * pull


@njit(cache=True)
def _apply_bars(line: Lines, v: Floats, p: Floats, tension: Floats) -> None:
    """Forces of the bars, and of the changed tension along the stretches between clamps."""
    for b in range(tension.size):
        for j in range(line.bar_first[b], line.bar_first[b + 1]):
            i = line.bar_point[j]
            v[i] -= line.gain[i] * line.bar_coefficient[j] * tension[b]
    for r in range(line.relief.shape[0]):
        for i in range(line.relief[r, 0], line.relief[r, 1]):
            pull = line.relief_string[r] * (p[i + 1] - p[i])
            v[i] += line.gain[i] * pull
            v[i + 1] -= line.gain[i + 1] * pull


@njit(cache=True)
def _join_parts(line: Lines, v: Floats, p: Floats) -> None:
    """Clamps: a stitch wire pulls the messenger and moves with it. Arms: no velocity along their length."""
    for c in range(line.tie.shape[0]):
        i, end, inward = line.tie[c]
        g = line.tie_strand[c]
        v[i] += line.gain[i] * _force_at_end(p, end, inward, line.string[g], line.bending[g])
        v[end] = v[i]
    for a in range(line.arm.shape[0]):
        y, z = line.arm[a]
        along = line.arm_direction[a, 0] * v[y] + line.arm_direction[a, 1] * v[z]
        v[y] -= line.arm_direction[a, 0] * along
        v[z] -= line.arm_direction[a, 1] * along


@njit(cache=True)
def march(
    line: Lines,
    heads: Heads,
    w: Floats,
    v: Floats,
    force: Floats,
    uplift: Floats,
    watched: Indices,
    every: int,
) -> None:
    """Advance line and pantographs by force.shape[2] steps.

    Args:
        line: Arrays of the line.
        heads: Pantographs; positions, heights and velocities are advanced in place.
        w, v: Displacement from the state of rest and velocity, advanced in place, (N,) [m, m/s].
        force: Filled with the contact force of every strip at the start of every step, (P, S, T) [N].
        uplift: Filled with the displacement of the watched points at every `every`-th step, (U, (T - 1) // every + 1)
            [m].
        watched: Watched points, (U,).
        every: Steps between two recorded displacements.
    """
    p, before, tension = w.copy(), np.zeros(line.special.size), np.zeros(line.bar_stiffness.size)
    rubbing = np.zeros(heads.joint.shape[1])
    for t in range(force.shape[2]):
        if t % every == 0:
            for j in range(watched.size):
                uplift[j, t // every] = w[watched[j]]
        _stretch_bars(line, w, v, tension)
        _move_strands(line, v, p, before)
        _apply_bars(line, v, p, tension)
        for k in range(force.shape[0]):
            accelerate_pantograph(heads, k, line.step)
            for strip in range(heads.offset.shape[1]):
                force[k, strip, t] = push_wire(line, heads, k, strip, w, v)
            hold_joints(heads, k, line.step, rubbing)
            heads.height[k] += line.step * heads.velocity[k]
            heads.position[k] += heads.speed * line.step
        _join_parts(line, v, p)
        for g in range(line.first.size):
            _move(w, v, p, line.step, line.delay[g], line.first[g], line.first[g] + line.count[g])

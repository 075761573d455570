"""Forces of the geometrically exact model: gravity, wires, bars and springs in their current directions."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from verification.formulations.exact_line import Array, Bars, ExactLine, Springs, Strings, Wires


class Scratch(NamedTuple):
    """Scratch arrays of `sum_forces`, (N,) each: axial force over length [N/m], and a force [N]."""

    share: Array
    part: Array


@njit(cache=True)
def allocate_scratch(points: int) -> Scratch:
    """Scratch arrays for a number of points."""
    return Scratch(np.zeros(points), np.zeros(points))


@njit(cache=True)
def sum_forces(line: ExactLine, position: Array, velocity: Array, force: Array, scratch: Scratch) -> None:
    """Fill `force`, (3, N), with all forces but the mass-proportional damping [N]."""
    for i in range(line.mass.size):
        force[0, i] = force[1, i] = 0.0
        force[2, i] = -line.mass[i] * line.gravity
    for w in range(line.wires.first.size):
        points = slice(line.wires.first[w], line.wires.last[w] + 1)
        share, part = scratch.share[points], scratch.part[points]
        x, y, z = position[0, points], position[1, points], position[2, points]
        _axial_shares(line.wires.axial_stiffness[w], line.unstretched[points], x, y, z, share)
        for k in range(3):
            r, v, f = position[k, points], velocity[k, points], force[k, points]
            _add_tension(line.wires, w, r, v, share, part, f)
            _add_bending(line.wires, w, r, v, part, f)
    _add_bars(line.bars, position, velocity, force)
    _add_springs(line.springs, position, velocity, force)
    _add_strings(line.strings, position, force)


@njit(cache=True)
def _axial_shares(axial_stiffness: float, unstretched: Array, x: Array, y: Array, z: Array, share: Array) -> None:
    """Axial force over length of every segment: EA (1 / unstretched length - 1 / length) [N/m]."""
    x1, y1, z1 = x[1:], y[1:], z[1:]
    for i in range(x1.size):
        length = math.sqrt((x1[i] - x[i]) ** 2 + (y1[i] - y[i]) ** 2 + (z1[i] - z[i]) ** 2)
        share[i] = axial_stiffness / unstretched[i] - axial_stiffness / length


@njit(cache=True)
def _add_tension(wires: Wires, w: int, r: Array, v: Array, share: Array, part: Array, force: Array) -> None:
    """Add one component of the axial forces of a wire, and the damping beta T / h of its tension."""
    damping = wires.stiffness_coefficient[w] * wires.tension[w] / wires.spacing[w]
    r1, v1, force1 = r[1:], v[1:], force[1:]
    for i in range(r1.size):
        part[i] = share[i] * (r1[i] - r[i]) + damping * (v1[i] - v[i])
    for i in range(r1.size):
        force[i] += part[i]
    for i in range(r1.size):
        force1[i] -= part[i]


@njit(cache=True)
def _add_bending(wires: Wires, w: int, r: Array, v: Array, part: Array, force: Array) -> None:
    """Add one component of the forces of the bending energy EI / 2 h^3 |r(i-1) - 2 r(i) + r(i+1)|^2, with its damping.

    No rotation of the wire changes this energy.
    """
    stiffness, beta = wires.bending_stiffness[w] / wires.spacing[w] ** 3, wires.stiffness_coefficient[w]
    r1, r2, v1, v2, force1, force2 = r[1:], r[2:], v[1:], v[2:], force[1:], force[2:]
    for i in range(r2.size):
        curvature, rate = r[i] - 2 * r1[i] + r2[i], v[i] - 2 * v1[i] + v2[i]
        part[i] = stiffness * (curvature + beta * rate)
    for i in range(r2.size):
        force[i] -= part[i]
    for i in range(r2.size):
        force1[i] += 2 * part[i]
    for i in range(r2.size):
        force2[i] -= part[i]


@njit(cache=True)
def _add_bars(bars: Bars, position: Array, velocity: Array, force: Array) -> None:
    """Add the forces of droppers and steady arms along their current directions, and the damping of their rotation."""
    for b in range(bars.stiffness.size):
        i, j = bars.ends[b, 0], bars.ends[b, 1]
        dx, dy, dz = position[0, j] - position[0, i], position[1, j] - position[1, i], position[2, j] - position[2, i]
        vx, vy, vz = velocity[0, j] - velocity[0, i], velocity[1, j] - velocity[1, i], velocity[2, j] - velocity[2, i]
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        ex, ey, ez = dx / length, dy / length, dz / length
        rate = ex * vx + ey * vy + ez * vz
        tension = bars.stiffness[b] * (length - bars.length[b]) + bars.axial_damping[b] * rate
        if bars.unilateral[b] and tension < 0.0:
            tension = 0.0
        c = bars.rotational_damping[b]
        for k, e, v in ((0, ex, vx), (1, ey, vy), (2, ez, vz)):
            f = tension * e + c * (v - rate * e)
            force[k, i] += f
            force[k, j] -= f


@njit(cache=True)
def _add_springs(springs: Springs, position: Array, velocity: Array, force: Array) -> None:
    for s in range(springs.point.size):
        i = springs.point[s]
        for k in range(3):
            elastic = springs.stiffness[k, s] * (springs.anchor[k, s] - position[k, i])
            force[k, i] += elastic - springs.damping[k, s] * velocity[k, i]


@njit(cache=True)
def string_elongations(strings: Strings, position: Array) -> Array:
    """Sum of the elongations of the segments of every group, (G,) [m]."""
    elongation = np.zeros(strings.group_stiffness.size)
    for n in range(strings.point.size):
        i = strings.point[n]
        for k in range(3):
            extent = position[k, i + 1] - position[k, i]
            linear, quadratic = strings.slope[k, n] * extent, strings.curvature[k, n] * extent * extent / 2
            elongation[strings.group[n]] += linear + quadratic
    return elongation


@njit(cache=True)
def _add_strings(strings: Strings, position: Array, force: Array) -> None:
    """Add the constant tension across the track, and the change of tension of each group along its elongation."""
    if strings.point.size == 0:
        return
    elongation = string_elongations(strings, position)
    for n in range(strings.point.size):
        i, g = strings.point[n], strings.group[n]
        h = strings.group_stiffness[g] * (elongation[g] - strings.group_length[g])
        for k in range(3):
            extent = position[k, i + 1] - position[k, i]
            f = strings.stiffness[k, n] * extent + h * (strings.slope[k, n] + strings.curvature[k, n] * extent)
            force[k, i] += f
            force[k, i + 1] -= f

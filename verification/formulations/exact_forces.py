"""Bars and springs of a line: droppers, steady arms and messenger supports with their static forces."""

import math
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numba import njit
from scipy.sparse.linalg import eigsh, splu

from pantocheck.model import DiscretisedLine
from pantocheck.model.description.catenary import Kind
from pantocheck.model.discretisation.connectors import RIGID, arm_direction
from verification.formulations.exact_line import Array, Bars, ExactLine, Indices, Springs, Strings, Wires, point_number


def build_bars(line: DiscretisedLine, position: Array) -> Bars:
    """Droppers, and steady arms if there is a lateral field."""
    droppers, state = line.catenary.droppers, line.state
    ends = [(point_number(line, d.lower, d.position), point_number(line, d.upper, d.position)) for d in droppers]
    stiffness = [d.taut_stiffness(float(rest)) for d, rest in zip(droppers, state.dropper_length, strict=True)]
    tension = list(state.dropper_tension)
    axial_damping = [line.catenary.rayleigh(Kind.DROPPER).stiffness_coefficient * k for k in stiffness]
    rotational_damping = [0.0] * len(droppers)
    if line.catenary.has_lateral_field:
        hinge = len(line.catenary.wires) * line.mesh.position.size
        for n, (arm, force) in enumerate(zip(line.catenary.steady_arms, state.arm_force, strict=True)):
            arm_tension = arm_direction(arm, force)[2]
            ends.append((point_number(line, arm.wire, arm.position), hinge + n))
            stiffness.append(RIGID)
            tension.append(arm_tension)
            axial_damping.append(0.0)
            beta = line.catenary.rayleigh(Kind.STEADY_ARM).stiffness_coefficient
            rotational_damping.append(beta * abs(arm.transverse_stiffness(arm_tension)))
    pairs = np.array(ends, dtype=np.int64).reshape(-1, 2)
    length = np.linalg.norm(position[:, pairs[:, 1]] - position[:, pairs[:, 0]], axis=0)
    return Bars(
        ends=pairs,
        stiffness=np.array(stiffness),
        length=length - np.array(tension) / np.array(stiffness),
        axial_damping=np.array(axial_damping),
        rotational_damping=np.array(rotational_damping),
        unilateral=np.arange(len(ends)) < len(droppers),
    )


def build_springs(line: DiscretisedLine, position: Array) -> Springs:
    """Messenger supports in y and z, and the vertical springs and dampers of steady arms."""
    points, stiffness, damping = [], [], []
    for support in line.catenary.messenger_supports:
        points.append(point_number(line, support.wire, support.position))
        stiffness.append((0.0, support.stiffness, support.stiffness))
        damping.append((0.0, support.damping, support.damping))
    for arm in line.catenary.steady_arms:
        k = arm.vertical_stiffness or 0.0
        points.append(point_number(line, arm.wire, arm.position))
        stiffness.append((0.0, 0.0, k))
        damping.append(
            (0.0, 0.0, arm.vertical_damper + line.catenary.rayleigh(Kind.STEADY_ARM).stiffness_coefficient * k)
        )
    point = np.array(points, dtype=np.int64)
    return Springs(point, np.array(stiffness).T.copy(), np.array(damping).T.copy(), position[:, point].copy())


# Pantograph of the geometrically exact model and its contact with the contact wire.
class ExactPantograph(NamedTuple):
    """Pantograph M z'' + C z' + K z = force - contact force on the head, under one contact wire."""

    inverse_mass: Array
    damping: Array
    stiffness: Array
    """Matrices, (n, n) [1/kg, N s/m, N/m]."""
    head: Array
    force: Array
    """Selects the head from the unknowns, (n,); constant forces [-, N]."""
    contact_stiffness: float
    """Stiffness of the penalty contact [N/m]; zero: no contact."""
    wire: int
    """Number of the contact wire."""


@njit(cache=True)
def add_contact(line: ExactLine, train: ExactPantograph, position: Array, z: Array, x: float, force: Array) -> float:
    """Add the contact force at x [m] to the contact wire, vertical and without friction, and return it [N]."""
    if train.contact_stiffness == 0.0:
        return 0.0
    wires, w = line.wires, train.wire
    i = wires.first[w] + int((x - position[0, wires.first[w]]) / wires.spacing[w])
    while position[0, i] > x:
        i -= 1
    while position[0, i + 1] <= x:
        i += 1
    shares = cubic_shares((x - position[0, i]) / (position[0, i + 1] - position[0, i]))
    closing = 0.0
    for n in range(z.size):
        closing += train.head[n] * z[n]
    for k in range(4):
        closing -= shares[k] * position[2, i - 1 + k]
    contact = max(0.0, train.contact_stiffness * closing)
    for k in range(4):
        force[2, i - 1 + k] += shares[k] * contact
    return contact


@njit(cache=True)
def cubic_shares(s: float) -> tuple[float, float, float, float]:
    """Shares of four neighbouring points in the cubic through them, at the share s of the middle segment [-]."""
    before, here, after = s + 1, s - 1, s - 2
    return -s * here * after / 6, before * here * after / 2, -before * s * after / 2, before * s * here / 6


@njit(cache=True)
def advance_pantograph(train: ExactPantograph, z: Array, v: Array, dt: float, drag: float, contact: float) -> None:
    """Advance the pantograph by one step under the contact force [N], in place; arguments as in `advance`."""
    n = z.size
    load = np.zeros(n)
    for i in range(n):
        load[i] = train.force[i] - contact * train.head[i]
        for j in range(n):
            load[i] -= train.stiffness[i, j] * z[j] + train.damping[i, j] * v[j]
    for i in range(n):
        acceleration = 0.0
        for j in range(n):
            acceleration += train.inverse_mass[i, j] * load[j]
        v[i] = ((1 - dt * drag / 2) * v[i] + dt * acceleration) / (1 + dt * drag / 2)
    for i in range(n):
        z[i] += dt * v[i]


# Forces of the geometrically exact model: gravity, wires, bars and springs in their current directions.
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


# Tangent stiffness of the geometrically exact model at rest: its natural frequencies and its elasticity.
STEP = 1e-5
"""Displacement of the numerical derivative [m]."""


def tangent_stiffness(line: ExactLine, position: Array) -> tuple[sp.csc_array, Indices]:
    """Negative derivative of the forces by the free displacements, by central differences.

    Args:
        line: Line.
        position: Positions at rest, (3, N) [m].

    Returns:
        Symmetric stiffness [N/m]; index of each free displacement among the 3 N.
    """
    free = np.flatnonzero(line.free.ravel())
    columns = [sp.csc_array(_derivative(line, position, int(i))[free, None]) for i in free]
    stiffness = -sp.hstack(columns, format="csc")
    return sp.csc_array((stiffness + stiffness.T) / 2), free


@njit(cache=True)
def _derivative(line: ExactLine, position: Array, unknown: int) -> Array:
    """Derivative of all forces by one displacement [N/m]."""
    scratch = allocate_scratch(line.mass.size)
    at_rest, forces = np.zeros_like(position), np.zeros((2, *position.shape))
    for side in range(2):
        moved = position.copy()
        moved[unknown // line.mass.size, unknown % line.mass.size] += STEP * (1 - 2 * side)
        sum_forces(line, moved, at_rest, forces[side], scratch)
    return (forces[0] - forces[1]).ravel() / (2 * STEP)


def natural_frequencies(line: ExactLine, position: Array, number: int, axes: tuple[int, ...] = (0, 1, 2)) -> Array:
    """Lowest natural frequencies of motions along some axes, ascending [Hz]."""
    stiffness, free = tangent_stiffness(line, position)
    points = line.mass.size
    kept = np.isin(free // points, axes)
    mass = sp.diags_array(line.mass[free[kept] % points], format="csc")
    square = eigsh(stiffness[kept][:, kept], number, mass, sigma=0.0, return_eigenvectors=False)
    return np.sqrt(np.sort(square)) / (2 * np.pi)


def point_elasticity(line: ExactLine, position: Array, points: Indices) -> Array:
    """Vertical displacement of points per vertical force there, for small forces [m/N]."""
    stiffness, free = tangent_stiffness(line, position)
    factor = splu(stiffness)
    loads = np.searchsorted(free, 2 * line.mass.size + points)
    unit = np.zeros((free.size, loads.size))
    unit[loads, np.arange(loads.size)] = 1.0
    return np.asarray(factor.solve(unit)[loads, np.arange(loads.size)])

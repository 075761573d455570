"""Tangent stiffness of the geometrically exact model at rest: its natural frequencies and its elasticity."""

import numpy as np
import scipy.sparse as sp
from numba import njit
from scipy.sparse.linalg import eigsh, splu

from verification.formulations.exact_forces import allocate_scratch, sum_forces
from verification.formulations.exact_line import Array, ExactLine, Indices

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

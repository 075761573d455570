"""The effective matrix of a Newmark step, factored once per run, and the local columns of its inverse.

The step solves A a = f for the accelerations of the rows of beams, A = M + dt/2 C + dt^2/4 K. Each row is block
tridiagonal with 2 x 2 blocks (w, r). Within one step a force is felt over a few times sqrt(T / m) dt / 2 only (0.1 m at
1 ms): the columns of the inverse are short, so that a connector or a contact is a correction of a few stations.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from pantocheck.model import beam
from pantocheck.model.beams import Beams

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# Where a column has fallen below this share of its peak, it is left out: an order below rounding.
NEGLIGIBLE = 1e-18


class Factor(NamedTuple):
    """Block factors of the rows: A = L D L', L having unit diagonal blocks and `lower` below them.

    Parameters
    ----------
    inverse : (B, S, 3) entries ww, wr, rr of the inverse of the diagonal block; zero for what cannot move
    lower : (B, S, 4) entries ww, wr, rw, rr of the block that links a station to the one before it
    """

    inverse: Array
    lower: Array


def effective_blocks(beams: Beams, time_step: float) -> tuple[Array, Array]:
    """Diagonal and below-diagonal blocks of A.

    Parameters
    ----------
    beams : the rows
    time_step : [s]

    Returns
    -------
    diagonal : (B, S, 2, 2)
    below : (B, S, 2, 2), entry s links station s to station s - 1
    """
    rows, stations = beams.lumped_mass.shape
    diagonal, below = np.zeros((rows, stations, 2, 2)), np.zeros((rows, stations, 2, 2))
    half, quarter = time_step / 2, time_step**2 / 4
    for row in range(rows):
        on_mass = 1 + half * beams.mass_coefficient[row]
        on_stiffness = quarter + half * beams.stiffness_coefficient[row]
        for e in np.flatnonzero(beams.mass_per_length[row]):
            h = beams.length[e]
            element = on_mass * beam.mass(h, beams.mass_per_length[row, e]) + on_stiffness * beam.stiffness(
                h, beams.tension[row, e], beams.bending_stiffness[row, e]
            )
            diagonal[row, e] += element[:2, :2]
            diagonal[row, e + 1] += element[2:, 2:]
            below[row, e + 1] = element[2:, :2]
    diagonal[:, :, 0, 0] += beams.lumped_mass + half * beams.lumped_damping + quarter * beams.lumped_stiffness
    fixed = ~beams.free
    for i in range(2):
        diagonal[fixed[:, :, i], i, :] = 0.0
        diagonal[fixed[:, :, i], :, i] = 0.0
        diagonal[fixed[:, :, i], i, i] = 1.0
        below[fixed[:, :, i], i, :] = 0.0
        below[:, 1:][fixed[:, :-1, i], :, i] = 0.0
    return diagonal, below


def factorise(beams: Beams, time_step: float) -> Factor:
    """Factor A.

    Parameters
    ----------
    beams : the rows
    time_step : [s]

    Returns
    -------
    its block factors
    """
    diagonal, below = effective_blocks(beams, time_step)
    rows, stations = diagonal.shape[:2]
    inverse, lower = np.zeros((rows, stations, 3)), np.zeros((rows, stations, 4))
    for row in range(rows):
        pivot_inverse = np.zeros((2, 2))
        for s in range(stations):
            link = below[row, s] @ pivot_inverse
            pivot_inverse = np.linalg.inv(diagonal[row, s] - link @ below[row, s].T)
            held = ~beams.free[row, s]
            kept = pivot_inverse.copy()
            kept[held, :] = 0.0
            kept[:, held] = 0.0
            inverse[row, s] = kept[0, 0], kept[0, 1], kept[1, 1]
            lower[row, s] = link.ravel()
    return Factor(inverse, lower)


@njit(cache=True)
def solve_row(factor: Factor, row: int, first: int, last: int, w: Array, r: Array) -> None:
    """Solve A x = f on one row between two stations, in place.

    Parameters
    ----------
    factor : Factor
    row : which row
    first, last : the forces are zero before `first`, and the solution is wanted (and not negligible) up to `last`
    w, r : (S,) on entry forces and moments, on return accelerations of deflection and slope
    """
    inverse, lower = factor.inverse[row], factor.lower[row]
    for s in range(first + 1, last + 1):
        a, b = w[s - 1], r[s - 1]
        w[s] -= lower[s, 0] * a + lower[s, 1] * b
        r[s] -= lower[s, 2] * a + lower[s, 3] * b
    x, y = 0.0, 0.0
    for s in range(last, first - 1, -1):
        f, g = w[s], r[s]
        u, v = inverse[s, 0] * f + inverse[s, 1] * g, inverse[s, 1] * f + inverse[s, 2] * g
        if s < last:
            u -= lower[s + 1, 0] * x + lower[s + 1, 2] * y
            v -= lower[s + 1, 1] * x + lower[s + 1, 3] * y
        w[s], r[s] = u, v
        x, y = u, v


@njit(cache=True)
def inverse_column(factor: Factor, row: int, station: int, slope: int, half_width: int, w: Array, r: Array) -> float:
    """One column of the inverse of A, `half_width` stations either side of the loaded one; returns its relative tail.

    Parameters
    ----------
    factor : Factor
    row, station : where the unit load acts
    slope : 0 for a unit force, 1 for a unit moment
    half_width : stations kept on either side
    w, r : (2 half_width + 1,) the column, centred on the station; zero beyond the ends of the line
    """
    inverse, lower = factor.inverse[row], factor.lower[row]
    stations = inverse.shape[0]
    w[:] = 0.0
    r[:] = 0.0
    shift = half_width - station
    last = min(stations - 1, station + half_width)
    if slope == 0:
        w[half_width] = 1.0
    else:
        r[half_width] = 1.0
    for s in range(station + 1, last + 1):
        a, b = w[s - 1 + shift], r[s - 1 + shift]
        w[s + shift] = -(lower[s, 0] * a + lower[s, 1] * b)
        r[s + shift] = -(lower[s, 2] * a + lower[s, 3] * b)
    x, y = 0.0, 0.0
    peak, tail = 0.0, 0.0
    for s in range(last, max(0, station - half_width) - 1, -1):
        f, g = w[s + shift], r[s + shift]
        u, v = inverse[s, 0] * f + inverse[s, 1] * g, inverse[s, 1] * f + inverse[s, 2] * g
        if s < last:
            u -= lower[s + 1, 0] * x + lower[s + 1, 2] * y
            v -= lower[s + 1, 1] * x + lower[s + 1, 3] * y
        w[s + shift], r[s + shift] = u, v
        x, y = u, v
        size = abs(u) + abs(v)
        peak = max(peak, size)
        if (s == station + half_width) or (s == station - half_width):
            tail = max(tail, size)
    return tail / peak if peak > 0 else 0.0


def half_width(factor: Factor, loads: list[tuple[int, int]]) -> int:
    """Stations either side after which every column asked for is negligible.

    Parameters
    ----------
    factor : the factors
    loads : (row, station) of the loads

    Returns
    -------
    stations on either side
    """
    stations = factor.inverse.shape[1]
    width = 8
    while width < stations:
        w, r = np.zeros(2 * width + 1), np.zeros(2 * width + 1)
        if all(
            inverse_column(factor, row, at, slope, width, w, r) < NEGLIGIBLE for row, at in loads for slope in (0, 1)
        ):
            break
        width *= 2
    return int(min(width, stations))


@njit(cache=True)
def inverse_columns(factor: Factor, rows: Indices, stations: Indices, slopes: Indices, half_width: int) -> Array:
    """Columns of the inverse for many loads.

    Parameters
    ----------
    factor : Factor
    rows, stations, slopes : (L,) where each unit load acts, and whether it is a moment
    half_width : stations kept on either side

    Returns
    -------
    (L, 2, 2 half_width + 1) deflection and slope around each load
    """
    columns = np.zeros((rows.size, 2, 2 * half_width + 1))
    for n in range(rows.size):
        inverse_column(factor, rows[n], stations[n], slopes[n], half_width, columns[n, 0], columns[n, 1])
    return columns

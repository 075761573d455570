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
NEGLIGIBLE = 1e-17


class Factor(NamedTuple):
    """Block factors of the rows, eliminated from both ends towards the middle station.

    Two eliminations that do not wait for each other keep the processor twice as busy as one from end to end.

    Parameters
    ----------
    inverse : (B, S, 3) entries ww, wr, rr of the inverse of the diagonal block; zero for what cannot move
    link : (B, S, 4) entries ww, wr, rw, rr of the block that takes a station's share to its inward neighbour
    """

    inverse: Array
    link: Array


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
    inverse, link = np.zeros((rows, stations, 3)), np.zeros((rows, stations, 4))
    for row in range(rows):
        _eliminate(diagonal[row], below[row], beams.free[row], inverse[row], link[row])
    return Factor(inverse, link)


@njit(cache=True)
def _eliminate(diagonal: Array, below: Array, free: NDArray[np.bool_], inverse: Array, link: Array) -> None:
    stations = diagonal.shape[0]
    middle = stations // 2
    for i in range(stations):
        # Left half forwards, right half backwards, the middle last.
        s = i if i < middle else stations - 1 - (i - middle)
        block = diagonal[s]
        determinant = block[0, 0] * block[1, 1] - block[0, 1] * block[1, 0]
        ww, wr, rr = block[1, 1] / determinant, -block[0, 1] / determinant, block[0, 0] / determinant
        if s != middle:
            inwards = s + 1 if s < middle else s - 1
            a = below[s + 1] if s < middle else below[s].T  # couples the inward neighbour to this station
            g = link[s].reshape(2, 2)
            for p in range(2):
                g[p, 0] = a[p, 0] * ww + a[p, 1] * wr
                g[p, 1] = a[p, 0] * wr + a[p, 1] * rr
            for p in range(2):
                for q in range(2):
                    diagonal[inwards, p, q] -= g[p, 0] * a[q, 0] + g[p, 1] * a[q, 1]
        inverse[s, 0] = ww if free[s, 0] else 0.0
        inverse[s, 1] = wr if free[s, 0] and free[s, 1] else 0.0
        inverse[s, 2] = rr if free[s, 1] else 0.0


@njit(cache=True)
def solve_row(factor: Factor, row: int, first: int, last: int, w: Array, r: Array) -> None:
    """Solve A x = f on one row between two stations, in place; f is zero and x negligible outside them.

    Parameters
    ----------
    factor : Factor
    row : which row
    first, last : stations that are solved for
    w, r : (last - first + 1,) on entry forces and moments, on return accelerations of deflection and slope
    """
    inverse, link = factor.inverse[row], factor.link[row]
    middle = min(max(inverse.shape[0] // 2, first), last)
    left, right = middle - first, last - middle
    for i in range(max(left, right)):
        if i < left:
            g, s = link[first + i], i
            a, b = w[s], r[s]
            w[s + 1] -= g[0] * a + g[1] * b
            r[s + 1] -= g[2] * a + g[3] * b
        if i < right:
            g, s = link[last - i], last - first - i
            a, b = w[s], r[s]
            w[s - 1] -= g[0] * a + g[1] * b
            r[s - 1] -= g[2] * a + g[3] * b
    d, f, m = inverse[middle], w[left], r[left]
    w[left], r[left] = d[0] * f + d[1] * m, d[1] * f + d[2] * m
    for i in range(1, max(left, right) + 1):
        if i <= left:
            s = left - i
            d, g, f, m, x, y = inverse[first + s], link[first + s], w[s], r[s], w[s + 1], r[s + 1]
            w[s] = d[0] * f + d[1] * m - g[0] * x - g[2] * y
            r[s] = d[1] * f + d[2] * m - g[1] * x - g[3] * y
        if i <= right:
            s = left + i
            d, g, f, m, x, y = inverse[first + s], link[first + s], w[s], r[s], w[s - 1], r[s - 1]
            w[s] = d[0] * f + d[1] * m - g[0] * x - g[2] * y
            r[s] = d[1] * f + d[2] * m - g[1] * x - g[3] * y


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
    w[:] = 0.0
    r[:] = 0.0
    if slope == 0:
        w[half_width] = 1.0
    else:
        r[half_width] = 1.0
    first = max(0, station - half_width)
    last = min(factor.inverse.shape[1] - 1, station + half_width)
    shift = half_width - station
    solve_row(factor, row, first, last, w[first + shift : last + shift + 1], r[first + shift : last + shift + 1])
    size = np.abs(w) + np.abs(r)
    tail = 0.0
    if first == station - half_width:
        tail = size[0]
    if last == station + half_width:
        tail = max(tail, size[-1])
    peak = size.max()
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
        if all(inverse_column(factor, row, s, slope, width, w, r) < NEGLIGIBLE for row, s in loads for slope in (0, 1)):
            break
        width += 4
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


@njit(cache=True)
def solve_rows(factor: Factor, force: Array) -> Array:
    """Solve A x = f on all rows for several right-hand sides.

    Parameters
    ----------
    factor : Factor
    force : (n, B, S, 2) forces and moments

    Returns
    -------
    (n, B, S, 2) accelerations
    """
    solved = np.empty_like(force)
    count, rows, stations = force.shape[:3]
    for n in range(count):
        for row in range(rows):
            w, r = force[n, row, :, 0].copy(), force[n, row, :, 1].copy()
            solve_row(factor, row, 0, stations - 1, w, r)
            solved[n, row, :, 0], solved[n, row, :, 1] = w, r
    return solved

"""The effective matrix of a Newmark step, factored once per run, and the local columns of its inverse.

The step solves A a = f for the accelerations of the rows of beams, A = M + dt/2 C + dt^2/4 K with the mass M of
`dispersion`. Each row is block tridiagonal with 2 x 2 blocks (w, r). Within one step a force is felt over a few times sqrt(T / m) dt / 2 only (0.1 m at
1 ms): the columns of the inverse are short, so that a connector or a contact is a correction of a few stations.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from pantocheck.model import beam
from pantocheck.model.beams import Beams, element_stiffness
from pantocheck.model.dispersion import compensation

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# Where a column has fallen below this share of its peak, it is left out: a hundredth of the tolerance of the forces.
NEGLIGIBLE = 1e-12


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
        element = on_mass * beam.mass(beams.length, beams.mass_per_length[row])
        element += on_stiffness * element_stiffness(beams, row) - compensation(beams, row, time_step)
        diagonal[row, :-1] += element[:, :2, :2]
        diagonal[row, 1:] += element[:, 2:, 2:]
        below[row, 1:] = element[:, 2:, :2]
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
            g = link[s]
            for p in range(2):
                g[2 * p] = a[p, 0] * ww + a[p, 1] * wr
                g[2 * p + 1] = a[p, 0] * wr + a[p, 1] * rr
            for p in range(2):
                for q in range(2):
                    diagonal[inwards, p, q] -= g[2 * p] * a[q, 0] + g[2 * p + 1] * a[q, 1]
        inverse[s, 0] = ww if free[s, 0] else 0.0
        inverse[s, 1] = wr if free[s, 0] and free[s, 1] else 0.0
        inverse[s, 2] = rr if free[s, 1] else 0.0


@njit(cache=True)
def solve(inverse: Array, link: Array, first: int, w: Array, r: Array) -> None:
    """Solve A x = f for a stretch of some rows, in place; f is zero and x negligible outside it.

    Parameters
    ----------
    inverse, link : (B, S, 3), (B, S, 4) of the factor
    first : station where the stretch begins
    w, r : (B, n) on entry forces and moments, on return accelerations of deflection and slope
    """
    n = w.shape[1]
    middle = min(max(inverse.shape[1] // 2 - first, 0), n - 1)
    for b in range(w.shape[0]):
        _solve_row(inverse[b, first : first + n], link[b, first : first + n], middle, w[b], r[b])


@njit(cache=True)
def _solve_row(inverse: Array, link: Array, middle: int, w: Array, r: Array) -> None:
    """Eliminate from both ends to the middle, and go back; two chains that do not wait for each other, in registers."""
    last = w.size - 1
    left, right = middle, last - middle
    together = max(min(left, right) - 1, 0)
    f, m = _inwards(link, 0, max(left - 1 - together, 0), 1, w, r)
    g, k = _inwards(link, last, max(right - 1 - together, 0), -1, w, r)
    s, t = max(left - 1 - together, 0), last - max(right - 1 - together, 0)
    for _ in range(together):
        p, q = _passed_on(link, s, f, m)
        u, v = _passed_on(link, t, g, k)
        s, t = s + 1, t - 1
        f, m = w[s] - p, r[s] - q
        g, k = w[t] - u, r[t] - v
        w[s], r[s] = f, m
        w[t], r[t] = g, k
    p, q, u, v = 0.0, 0.0, 0.0, 0.0
    if left > 0:
        p, q = _passed_on(link, s, f, m)
    if right > 0:
        u, v = _passed_on(link, t, g, k)
    x, y = _times(inverse, middle, w[middle] - p - u, r[middle] - q - v)
    w[middle], r[middle] = x, y
    u, v = x, y
    both = min(left, right)
    for i in range(1, both + 1):
        x, y = _back(inverse, link, middle - i, w, r, x, y)
        u, v = _back(inverse, link, middle + i, w, r, u, v)
    for i in range(both + 1, left + 1):
        x, y = _back(inverse, link, middle - i, w, r, x, y)
    for i in range(both + 1, right + 1):
        u, v = _back(inverse, link, middle + i, w, r, u, v)


@njit(cache=True)
def _inwards(link: Array, start: int, count: int, step: int, w: Array, r: Array) -> tuple[float, float]:
    """Eliminate `count` stations in a row; returns force and moment at the station that is reached."""
    f, m = w[start], r[start]
    s = start
    for _ in range(count):
        p, q = _passed_on(link, s, f, m)
        s += step
        f, m = w[s] - p, r[s] - q
        w[s], r[s] = f, m
    return f, m


@njit(cache=True)
def _passed_on(link: Array, s: int, f: float, m: float) -> tuple[float, float]:
    return link[s, 0] * f + link[s, 1] * m, link[s, 2] * f + link[s, 3] * m


@njit(cache=True)
def _times(inverse: Array, s: int, f: float, m: float) -> tuple[float, float]:
    return inverse[s, 0] * f + inverse[s, 1] * m, inverse[s, 1] * f + inverse[s, 2] * m


@njit(cache=True)
def _back(inverse: Array, link: Array, s: int, w: Array, r: Array, x: float, y: float) -> tuple[float, float]:
    """Solution at a station from the one at its inward neighbour."""
    p, q = _times(inverse, s, w[s], r[s])
    p -= link[s, 0] * x + link[s, 2] * y
    q -= link[s, 1] * x + link[s, 3] * y
    w[s], r[s] = p, q
    return p, q


@njit(cache=True)
def inverse_column(factor: Factor, row: int, station: int, slope: int, half_width: int, w: Array, r: Array) -> float:
    """One column of the inverse of A around the loaded station; returns its relative tail.

    Parameters
    ----------
    factor : Factor
    row, station : where the unit load acts
    slope : 0 for a unit force, 1 for a unit moment
    half_width : stations kept before the loaded one, and one less behind it
    w, r : (2 half_width,) the column, the loaded station at half_width; zero beyond the ends of the line
    """
    stations = factor.inverse.shape[1]
    w[:] = 0.0
    r[:] = 0.0
    if slope == 0:
        w[half_width] = 1.0
    else:
        r[half_width] = 1.0
    first, last = max(0, station - half_width), min(stations, station + half_width)
    there = slice(first + half_width - station, last + half_width - station)
    middle = min(max(stations // 2 - first, 0), last - first - 1)
    _solve_row(factor.inverse[row, first:last], factor.link[row, first:last], middle, w[there], r[there])
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
    width = 8
    while width < factor.inverse.shape[1]:
        w, r = np.zeros(2 * width), np.zeros(2 * width)
        if all(inverse_column(factor, row, s, slope, width, w, r) < NEGLIGIBLE for row, s in loads for slope in (0, 1)):
            break
        width += 8  # whole vector registers
    return width


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
    (L, 2, 2 half_width) deflection and slope around each load
    """
    columns = np.zeros((rows.size, 2, 2 * half_width))
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
    for n in range(force.shape[0]):
        w, r = force[n, :, :, 0].copy(), force[n, :, :, 1].copy()
        solve(factor.inverse, factor.link, 0, w, r)
        solved[n, :, :, 0], solved[n, :, :, 1] = w, r
    return solved

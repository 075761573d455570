"""The effective matrix of a Newmark step, factored once per run, and the local columns of its inverse.

The step solves A a = f for the accelerations of the rows of beams, A = M + dt/2 C + dt^2/4 K with the mass M of
`dispersion`. Each row is block tridiagonal with 2 x 2 blocks (w, r). Within one step a force is felt over a few times
sqrt(T / m) dt / 2 only (0.1 m at 1 ms): the columns of the inverse are short, so that a connector or a contact is a
correction of a few stations.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from pantocheck.model.arrays import Array, Indices
from pantocheck.model.dynamics.mass_correction import mass_correction
from pantocheck.model.fem import beam
from pantocheck.model.fem.beams import Beams, element_stiffness

# Where a column has fallen below this share of its peak, it is left out: a hundredth of the tolerance of the forces.
NEGLIGIBLE = 1e-12


class Factor(NamedTuple):
    """Block factors of the rows, eliminated from the left and from the right.

    Two eliminations that do not wait for each other, from the ends of a stretch towards its middle, keep the processor
    twice as busy as one from end to end; with both at hand they can meet at any station.

    Parameters
    ----------
    inverse : (2, B, S, 3) ndarray
        Entries ww, wr, rr of the inverse of the diagonal block; zero for what cannot move.
    link : (2, B, S, 4) ndarray
        Entries ww, wr, rw, rr of the block that takes a station's share on to its neighbour.
    meeting : (B, S, 3) ndarray
        Inverse of the diagonal block where both eliminations have arrived.
    """

    inverse: Array
    link: Array
    meeting: Array


def build_effective_blocks(beams: Beams, time_step: float) -> tuple[Array, Array]:
    """Diagonal and below-diagonal blocks of A.

    Parameters
    ----------
    beams : Beams
        The rows.
    time_step : float
        [s].

    Returns
    -------
    diagonal : (B, S, 2, 2) ndarray
    below : (B, S, 2, 2) ndarray
        Entry s links station s to station s - 1.
    """
    rows, stations = beams.lumped_mass.shape
    diagonal, below = np.zeros((rows, stations, 2, 2)), np.zeros((rows, stations, 2, 2))
    half, quarter = time_step / 2, time_step**2 / 4
    for row in range(rows):
        on_mass = 1 + half * beams.mass_coefficient[row]
        on_stiffness = quarter + half * beams.stiffness_coefficient[row]
        element = on_mass * beam.mass(beams.length, beams.mass_per_length[row])
        element += on_stiffness * element_stiffness(beams, row) - mass_correction(beams, row, time_step)
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
    beams : Beams
        The rows.
    time_step : float
        [s].

    Returns
    -------
    Factor
        Its block factors.
    """
    diagonal, below = build_effective_blocks(beams, time_step)
    rows, stations = diagonal.shape[:2]
    inverse, link = np.zeros((2, rows, stations, 3)), np.zeros((2, rows, stations, 4))
    meeting = np.zeros((rows, stations, 3))
    for row in range(rows):
        from_left, from_right = diagonal[row].copy(), diagonal[row, ::-1].copy()
        _eliminate(from_left, below[row, 1:], beams.free[row], inverse[0, row], link[0, row])
        coupling = below[row, :0:-1].transpose(0, 2, 1)
        _eliminate(from_right, coupling, beams.free[row, ::-1], inverse[1, row, ::-1], link[1, row, ::-1])
        _invert(from_left + from_right[::-1] - diagonal[row], beams.free[row], meeting[row])
    return Factor(inverse, link, meeting)


@njit(cache=True)
def _eliminate(diagonal: Array, coupling: Array, free: NDArray[np.bool_], inverse: Array, link: Array) -> None:
    """Eliminate station by station, coupling s leading on to s + 1; the diagonal blocks become those that are left."""
    _invert(diagonal[:1], free[:1], inverse[:1])
    for s in range(diagonal.shape[0] - 1):
        ww, wr, rr = inverse[s]
        a, g = coupling[s], link[s]
        for p in range(2):
            g[2 * p] = a[p, 0] * ww + a[p, 1] * wr
            g[2 * p + 1] = a[p, 0] * wr + a[p, 1] * rr
        for p in range(2):
            for q in range(2):
                diagonal[s + 1, p, q] -= g[2 * p] * a[q, 0] + g[2 * p + 1] * a[q, 1]
        _invert(diagonal[s + 1 : s + 2], free[s + 1 : s + 2], inverse[s + 1 : s + 2])


@njit(cache=True)
def _invert(blocks: Array, free: NDArray[np.bool_], inverse: Array) -> None:
    """Inverse of symmetric 2 x 2 blocks, zero for what cannot move: the blocks are the identity there."""
    for s in range(blocks.shape[0]):
        block = blocks[s]
        determinant = block[0, 0] * block[1, 1] - block[0, 1] * block[1, 0]
        inverse[s, 0] = block[1, 1] / determinant if free[s, 0] else 0.0
        inverse[s, 1] = -block[0, 1] / determinant if free[s, 0] and free[s, 1] else 0.0
        inverse[s, 2] = block[0, 0] / determinant if free[s, 1] else 0.0


@njit(cache=True)
def solve_line(factor: Factor, first: int, last: int, w: Array, r: Array) -> None:
    """Solve A x = f for a stretch of all rows, in place; f is zero and x negligible outside it.

    Parameters
    ----------
    factor : Factor
        Factor.
    first, last : int
        Stations where the stretch begins and ends.
    w, r : (B, S) ndarray
        On entry forces and moments, on return accelerations of deflection and slope.
    """
    for b in range(w.shape[0]):
        solve_row(factor, b, first, w[b, first : last + 1], r[b, first : last + 1])


@njit(cache=True)
def solve_row(factor: Factor, row: int, first: int, w: Array, r: Array) -> None:
    """As `solve` for one row: eliminate from both ends to the middle, and go back.

    Counting both halves from the ends inwards gives two chains in registers that do not wait for each other.
    """
    n = w.size
    middle = n // 2
    pairs, at = n - 1 - middle, slice(first, first + n)
    # An even number of stations leaves one more on the left; it goes first on the way in, and last on the way back.
    one_more = middle - pairs
    inverse, link = factor.inverse[0, row, at][one_more:middle], factor.link[0, row, at][one_more:middle]
    inverse_, link_ = factor.inverse[1, row, at][:middle:-1], factor.link[1, row, at][:middle:-1]
    w0, r0, w1, r1 = w[one_more:middle], r[one_more:middle], w[:middle:-1], r[:middle:-1]
    p, q, u, v = 0.0, 0.0, 0.0, 0.0
    if one_more > 0:
        p, q = _passed_on(factor.link[0, row, at], 0, w[0], r[0])
    for s in range(pairs):
        f, m = w0[s] - p, r0[s] - q
        g, k = w1[s] - u, r1[s] - v
        w0[s], r0[s] = f, m
        w1[s], r1[s] = g, k
        p, q = _passed_on(link, s, f, m)
        u, v = _passed_on(link_, s, g, k)
    x, y = _times(factor.meeting[row, at], middle, w[middle] - p - u, r[middle] - q - v)
    w[middle], r[middle] = x, y
    u, v = x, y
    for back in range(pairs):
        s = pairs - 1 - back
        x, y = _back(inverse, link, s, w0[s], r0[s], x, y)
        u, v = _back(inverse_, link_, s, w1[s], r1[s], u, v)
        w0[s], r0[s] = x, y
        w1[s], r1[s] = u, v
    if one_more > 0:
        w[0], r[0] = _back(factor.inverse[0, row, at], factor.link[0, row, at], 0, w[0], r[0], x, y)


@njit(cache=True)
def _passed_on(link: Array, s: int, f: float, m: float) -> tuple[float, float]:
    return link[s, 0] * f + link[s, 1] * m, link[s, 2] * f + link[s, 3] * m


@njit(cache=True)
def _times(inverse: Array, s: int, f: float, m: float) -> tuple[float, float]:
    return inverse[s, 0] * f + inverse[s, 1] * m, inverse[s, 1] * f + inverse[s, 2] * m


@njit(cache=True)
def _back(inverse: Array, link: Array, s: int, f: float, m: float, x: float, y: float) -> tuple[float, float]:
    """Solution at a station from what was left there and the solution at its inward neighbour."""
    p, q = _times(inverse, s, f, m)
    return p - (link[s, 0] * x + link[s, 2] * y), q - (link[s, 1] * x + link[s, 3] * y)


@njit(cache=True)
def inverse_column(factor: Factor, row: int, station: int, slope: int, half_width: int, w: Array, r: Array) -> float:
    """One column of the inverse of A around the loaded station; returns its relative tail.

    Parameters
    ----------
    factor : Factor
        Factor.
    row, station : int
        Where the unit load acts.
    slope : int
        0 for a unit force, 1 for a unit moment.
    half_width : int
        Stations kept before the loaded one, and one less behind it.
    w, r : (2 half_width,) ndarray
        The column, the loaded station at half_width; zero beyond the ends of the line.
    """
    stations = factor.meeting.shape[1]
    w[:] = 0.0
    r[:] = 0.0
    if slope == 0:
        w[half_width] = 1.0
    else:
        r[half_width] = 1.0
    first, last = max(0, station - half_width), min(stations, station + half_width)
    there = slice(first + half_width - station, last + half_width - station)
    solve_row(factor, row, first, w[there], r[there])
    size = np.abs(w) + np.abs(r)
    tail = 0.0
    if first == station - half_width:
        tail = size[0]
    if last == station + half_width:
        tail = max(tail, size[-1])
    peak = size.max()
    return tail / peak if peak > 0 else 0.0


def column_half_width(factor: Factor, loads: list[tuple[int, int]]) -> int:
    """Stations either side after which every column asked for is negligible.

    Parameters
    ----------
    factor : Factor
        The factors.
    loads : list[tuple[int, int]]
        (row, station) of the loads.

    Returns
    -------
    int
        Stations on either side.
    """
    width = 8
    while width < factor.meeting.shape[1]:
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
        Factor.
    rows, stations, slopes : (L,) int ndarray
        Where each unit load acts, and whether it is a moment.
    half_width : int
        Stations kept on either side.

    Returns
    -------
    (L, 2, 2 half_width) ndarray
        Deflection and slope around each load.
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
        Factor.
    force : (n, B, S, 2) ndarray
        Forces and moments.

    Returns
    -------
    (n, B, S, 2) ndarray
        Accelerations.
    """
    solved = np.empty_like(force)
    for n in range(force.shape[0]):
        w, r = force[n, :, :, 0].copy(), force[n, :, :, 1].copy()
        solve_line(factor, 0, w.shape[1] - 1, w, r)
        solved[n, :, :, 0], solved[n, :, :, 1] = w, r
    return solved

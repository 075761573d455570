"""Solver of the block tridiagonal effective matrix of each row of beams, with 2 x 2 blocks (w, r) per station.

With diagonal blocks A_s and sub-diagonal blocks B_s, block elimination from the left gives

    D_0 = A_0,    L_s = B_s D_(s-1)^-1,    D_s = A_s - L_s B_s'
    forward   g_s = f_s - L_s g_(s-1)
    back      x_s = D_s^-1 g_s - L_(s+1)' x_(s+1)

The same elimination runs from the right. Both meet at the middle station m of the part that is solved:

    0 -> 1 -> ... -> m <- ... <- S-2 <- S-1        (D_m^left + D_m^right - A_m) x_m = f_m - both contributions

The two eliminations are independent, so that the processor computes them at the same time. Both sets of factors are
stored for all stations: the eliminations can meet at any station, and any part of the line (`active_window`) is solved
with the same factors.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from pantocheck.model.arrays import Array

ForceMoment = tuple[float, float]


class Factor(NamedTuple):
    """Block factors of B rows with S stations, eliminated from the left (index 0) and from the right (index 1).

    Parameters
    ----------
    inverse : (2, B, S, 3) ndarray
        Entries ww, wr, rr of D_s^-1; zero for fixed unknowns.
    link : (2, B, S, 4) ndarray
        Entries ww, wr, rw, rr of the factor L, which transfers the force at station s to its inward neighbour.
    meeting : (B, S, 3) ndarray
        Inverse of the diagonal block where both eliminations meet.
    """

    inverse: Array
    link: Array
    meeting: Array


def factorise_blocks(diagonal: Array, below: Array, free: NDArray[np.bool_]) -> Factor:
    """Eliminate all rows from both ends.

    Parameters
    ----------
    diagonal : (B, S, 2, 2) ndarray
        Diagonal blocks A_s.
    below : (B, S, 2, 2) ndarray
        Sub-diagonal blocks; entry s couples station s to station s - 1.
    free : (B, S, 2) ndarray of bool
        Whether deflection and slope can move.

    Returns
    -------
    Factor
        Block factors.
    """
    rows, stations = diagonal.shape[:2]
    inverse, link = np.zeros((2, rows, stations, 3)), np.zeros((2, rows, stations, 4))
    meeting = np.zeros((rows, stations, 3))
    for row in range(rows):
        from_left, from_right = diagonal[row].copy(), diagonal[row, ::-1].copy()
        _eliminate(from_left, below[row, 1:], free[row], inverse[0, row], link[0, row])
        coupling = below[row, :0:-1].transpose(0, 2, 1)
        _eliminate(from_right, coupling, free[row, ::-1], inverse[1, row, ::-1], link[1, row, ::-1])
        _invert(from_left + from_right[::-1] - diagonal[row], free[row], meeting[row])
    return Factor(inverse, link, meeting)


@njit(cache=True)
def _eliminate(diagonal: Array, coupling: Array, free: NDArray[np.bool_], inverse: Array, link: Array) -> None:
    """Eliminate station by station; block s of `coupling` is B_(s+1), and the diagonal blocks A_s become D_s."""
    _invert(diagonal[:1], free[:1], inverse[:1])
    for s in range(diagonal.shape[0] - 1):
        ww, wr, rr = inverse[s]
        B, L = coupling[s], link[s]
        for i in range(2):
            L[2 * i] = B[i, 0] * ww + B[i, 1] * wr
            L[2 * i + 1] = B[i, 0] * wr + B[i, 1] * rr
        for i in range(2):
            for j in range(2):
                diagonal[s + 1, i, j] -= L[2 * i] * B[j, 0] + L[2 * i + 1] * B[j, 1]
        _invert(diagonal[s + 1 : s + 2], free[s + 1 : s + 2], inverse[s + 1 : s + 2])


@njit(cache=True)
def _invert(blocks: Array, free: NDArray[np.bool_], inverse: Array) -> None:
    """Inverse of symmetric 2 x 2 blocks, zero for fixed unknowns, where the blocks are the identity."""
    for s in range(blocks.shape[0]):
        block = blocks[s]
        determinant = block[0, 0] * block[1, 1] - block[0, 1] * block[1, 0]
        inverse[s, 0] = block[1, 1] / determinant if free[s, 0] else 0.0
        inverse[s, 1] = -block[0, 1] / determinant if free[s, 0] and free[s, 1] else 0.0
        inverse[s, 2] = block[0, 0] / determinant if free[s, 1] else 0.0


@njit(cache=True)
def solve_line(factor: Factor, first: int, last: int, w: Array, r: Array) -> None:
    """Solve A x = f in place for a range of stations of all rows; f is zero and x negligible outside.

    Parameters
    ----------
    factor : Factor
        Block factors of A.
    first, last : int
        First and last station.
    w, r : (B, S) ndarray
        On entry forces and moments [N, N m], on return accelerations of deflection and slope [m/s2, 1/s2].
    """
    for b in range(w.shape[0]):
        solve_row(factor, b, first, w[b, first : last + 1], r[b, first : last + 1])


@njit(cache=True)
def solve_row(factor: Factor, row: int, first: int, w: Array, r: Array) -> None:
    """Solve one row as in `solve_line`: eliminate from both ends to the middle, then substitute back.

    Parameters
    ----------
    factor : Factor
        Block factors of A.
    row : int
        Index of the row.
    first : int
        First station.
    w, r : (n,) ndarray
        Forces and moments at n stations, replaced by accelerations as in `solve_line`.
    """
    n = w.size
    middle = n // 2
    pairs, stations = n - 1 - middle, slice(first, first + n)
    # Both eliminations are counted from the ends inwards. An even number of stations leaves one more on the left, which
    # is eliminated first and substituted last.
    extra = middle - pairs
    left_inverse = factor.inverse[0, row, stations][extra:middle]
    left_link = factor.link[0, row, stations][extra:middle]
    right_inverse = factor.inverse[1, row, stations][:middle:-1]
    right_link = factor.link[1, row, stations][:middle:-1]
    w_left, r_left, w_right, r_right = w[extra:middle], r[extra:middle], w[:middle:-1], r[:middle:-1]
    # Force and moment that the two eliminations transfer to the next station.
    left_f, left_m, right_f, right_m = 0.0, 0.0, 0.0, 0.0
    if extra > 0:
        left_f, left_m = _transfer(factor.link[0, row, stations], 0, w[0], r[0])
    for s in range(pairs):
        f0, m0 = w_left[s] - left_f, r_left[s] - left_m
        f1, m1 = w_right[s] - right_f, r_right[s] - right_m
        w_left[s], r_left[s] = f0, m0
        w_right[s], r_right[s] = f1, m1
        left_f, left_m = _transfer(left_link, s, f0, m0)
        right_f, right_m = _transfer(right_link, s, f1, m1)
    middle_f, middle_m = w[middle] - left_f - right_f, r[middle] - left_m - right_m
    left = right = _multiply(factor.meeting[row, stations], middle, middle_f, middle_m)
    w[middle], r[middle] = left
    for back in range(pairs):
        s = pairs - 1 - back
        left = _substitute(left_inverse, left_link, s, (w_left[s], r_left[s]), left)
        right = _substitute(right_inverse, right_link, s, (w_right[s], r_right[s]), right)
        w_left[s], r_left[s] = left
        w_right[s], r_right[s] = right
    if extra > 0:
        inverse, link = factor.inverse[0, row, stations], factor.link[0, row, stations]
        w[0], r[0] = _substitute(inverse, link, 0, (w[0], r[0]), left)


@njit(cache=True)
def _transfer(link: Array, s: int, force: float, moment: float) -> ForceMoment:
    """Force and moment L g that a station transfers to its inward neighbour."""
    return link[s, 0] * force + link[s, 1] * moment, link[s, 2] * force + link[s, 3] * moment


@njit(cache=True)
def _multiply(inverse: Array, s: int, force: float, moment: float) -> ForceMoment:
    """Product of a symmetric inverse block with force and moment."""
    return inverse[s, 0] * force + inverse[s, 1] * moment, inverse[s, 1] * force + inverse[s, 2] * moment


@njit(cache=True)
def _substitute(inverse: Array, link: Array, s: int, force: ForceMoment, inward: ForceMoment) -> ForceMoment:
    """Solution (w, r) at a station from its reduced force and moment and the solution at its inward neighbour."""
    w, r = _multiply(inverse, s, force[0], force[1])
    return w - (link[s, 0] * inward[0] + link[s, 2] * inward[1]), r - (link[s, 1] * inward[0] + link[s, 3] * inward[1])


@njit(cache=True)
def solve_rows(factor: Factor, force: Array) -> Array:
    """Solve A x = f on all rows for several right-hand sides; forces and accelerations (n, B, S, 2)."""
    solution = np.empty_like(force)
    for n in range(force.shape[0]):
        w, r = force[n, :, :, 0].copy(), force[n, :, :, 1].copy()
        solve_line(factor, 0, w.shape[1] - 1, w, r)
        solution[n, :, :, 0], solution[n, :, :, 1] = w, r
    return solution

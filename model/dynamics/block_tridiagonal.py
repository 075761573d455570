"""Solver of the block tridiagonal effective matrix of each row of beams, with 2 x 2 blocks (w, r) per station.

With diagonal blocks A_s and sub-diagonal blocks B_s, block elimination from the left gives

    D_0 = A_0,    L_s = B_s D_(s-1)^-1,    D_s = A_s - L_s B_s'
    forward   g_s = f_s - L_s g_(s-1)
    back      x_s = D_s^-1 g_s - L_(s+1)' x_(s+1)

The same elimination runs from the right. Both meet at the middle station m of the part that is solved:

    0 -> 1 -> ... -> m <- ... <- S-2 <- S-1        (D_m^left + D_m^right - A_m) x_m = f_m - both contributions

The two eliminations are independent, so that the processor computes them at the same time. All wires meet at the middle
of the active window; a wire on one side of it is eliminated from its outer end only. Both sets of factors are
stored for all stations: the eliminations can meet at any station, and any part of the line (`active_window`) is solved
with the same factors.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from pantocheck.model.arrays import Array
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.extents import Extents, clip_extent

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
def solve_wires(factor: Factor, extents: Extents, window: Window, w: Array, r: Array) -> None:
    """Solve A x = f in place for the active stations of all wires; f is zero and x negligible outside.

    Parameters
    ----------
    factor : Factor
        Block factors of A.
    extents : Extents
        Extents of the wires.
    window : Window
        First and last active station.
    w, r : (B, S) ndarray
        On entry forces and moments [N, N m], on return accelerations of deflection and slope [m/s2, 1/s2].
    """
    middle = window.first + (window.last - window.first + 1) // 2
    for n in range(extents.row.size):
        row, (first, last) = extents.row[n], clip_extent(extents, n, window)
        if first <= last:
            solve_row(factor, row, first, middle - first, w[row, first : last + 1], r[row, first : last + 1])


@njit(cache=True)
def solve_row(factor: Factor, row: int, first: int, middle: int, w: Array, r: Array) -> None:
    """Solve some stations of one row as in `solve_wires`: eliminate towards the middle, then substitute back.

    Parameters
    ----------
    factor : Factor
        Block factors of A.
    row : int
        Index of the row.
    first : int
        First station.
    middle : int
        Station at which the eliminations meet, counted from the first; beyond the n stations there is one elimination.
    w, r : (n,) ndarray
        Forces and moments at n stations, replaced by accelerations as in `solve_wires`.
    """
    n = w.size
    left, right = min(max(middle, 0), n), min(max(n - 1 - middle, 0), n)
    pairs, stations = min(left, right), slice(first, first + n)
    # Both eliminations are counted from the ends inwards. The longer one begins and ends alone.
    alone_left, alone_right = left - pairs, right - pairs
    left_inverse, left_link = factor.inverse[0, row, stations][:left], factor.link[0, row, stations][:left]
    right_inverse = factor.inverse[1, row, stations][::-1][:right]
    right_link = factor.link[1, row, stations][::-1][:right]
    w_left, r_left, w_right, r_right = w[:left], r[:left], w[::-1][:right], r[::-1][:right]
    # Force and moment that the two eliminations transfer to the next station.
    left_f, left_m = _eliminate_side(left_link, w_left[:alone_left], r_left[:alone_left])
    right_f, right_m = _eliminate_side(right_link, w_right[:alone_right], r_right[:alone_right])
    w0, r0, link0 = w_left[alone_left:], r_left[alone_left:], left_link[alone_left:]
    w1, r1, link1 = w_right[alone_right:], r_right[alone_right:], right_link[alone_right:]
    for s in range(pairs):
        f0, m0 = w0[s] - left_f, r0[s] - left_m
        f1, m1 = w1[s] - right_f, r1[s] - right_m
        w0[s], r0[s] = f0, m0
        w1[s], r1[s] = f1, m1
        left_f, left_m = _transfer(link0, s, f0, m0)
        right_f, right_m = _transfer(link1, s, f1, m1)
    inward_left = inward_right = (0.0, 0.0)
    if left + right < n:
        middle_f, middle_m = w[middle] - left_f - right_f, r[middle] - left_m - right_m
        inward_left = inward_right = _multiply(factor.meeting[row, stations], middle, middle_f, middle_m)
        w[middle], r[middle] = inward_left
    inverse0, inverse1 = left_inverse[alone_left:], right_inverse[alone_right:]
    for back in range(pairs):
        s = pairs - 1 - back
        inward_left = _substitute(inverse0, link0, s, (w0[s], r0[s]), inward_left)
        inward_right = _substitute(inverse1, link1, s, (w1[s], r1[s]), inward_right)
        w0[s], r0[s] = inward_left
        w1[s], r1[s] = inward_right
    _substitute_side(left_inverse, left_link, w_left[:alone_left], r_left[:alone_left], inward_left)
    _substitute_side(right_inverse, right_link, w_right[:alone_right], r_right[:alone_right], inward_right)


@njit(cache=True)
def _eliminate_side(link: Array, w: Array, r: Array) -> ForceMoment:
    """Eliminate the outer stations of one side in place; return force and moment for the next station."""
    force, moment = 0.0, 0.0
    for s in range(w.size):
        w[s] -= force
        r[s] -= moment
        force, moment = _transfer(link, s, w[s], r[s])
    return force, moment


@njit(cache=True)
def _substitute_side(inverse: Array, link: Array, w: Array, r: Array, inward: ForceMoment) -> None:
    """Substitute back the outer stations of one side in place, from the solution at their inward neighbour."""
    for back in range(w.size):
        s = w.size - 1 - back
        inward = _substitute(inverse, link, s, (w[s], r[s]), inward)
        w[s], r[s] = inward


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
        for row in range(w.shape[0]):
            solve_row(factor, row, 0, w.shape[1] // 2, w[row], r[row])
        solution[n, :, :, 0], solution[n, :, :, 1] = w, r
    return solution

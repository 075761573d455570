"""Block factors of the effective matrix of each row of beams, which is block tridiagonal with 2 x 2 blocks (w, r).

With diagonal blocks A_s and sub-diagonal blocks B_s, block elimination from the left gives

    D_0 = A_0,    L_s = B_(s+1) D_s^-1,    D_(s+1) = A_(s+1) - L_s B_(s+1)'
    forward   g_s = f_s - L_(s-1) g_(s-1)
    back      x_s = D_s^-1 g_s - L_s' x_(s+1)

Products of the L_s decay along the row: within one step a force influences the line over a few stations only. A few
stations around a force are therefore solved alone, with the factors of the whole row (`solve_stations`). All stations
of the active window are solved by `panels`, the same recurrences with eight pieces of a row at a time.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pantocheck.model.description.arrays import Array
from pantocheck.model.dynamics.kernel_compilation import entry_kernel, kernel

ForceMoment = tuple[float, float]


class Factor(NamedTuple):
    """Block factors of B rows with S stations."""

    inverse: Array
    """Entries ww, wr, rr of D_s^-1, (B, S, 3); zero for fixed unknowns."""
    link: Array
    """Entries ww, wr, rw, rr of the factor L_s, which transfers the force at station s to the next one, (B, S, 4)."""


def factorise_blocks(diagonal: Array, below: Array, free: NDArray[np.bool_]) -> Factor:
    """Eliminate all rows.

    Args:
        diagonal: Diagonal blocks A_s, (B, S, 2, 2).
        below: Sub-diagonal blocks, (B, S, 2, 2); entry s couples station s to station s - 1.
        free: Whether deflection and slope can move, (B, S, 2).

    Returns:
        Block factors.
    """
    rows, stations = diagonal.shape[:2]
    factor = Factor(np.zeros((rows, stations, 3)), np.zeros((rows, stations, 4)))
    _eliminate(diagonal.copy(), below, free, factor)
    return factor


@entry_kernel
def _eliminate(diagonal: Array, below: Array, free: NDArray[np.bool_], factor: Factor) -> None:
    """Eliminate station by station; the diagonal blocks A_s become D_s."""
    inverse, link, stations = factor.inverse, factor.link, diagonal.shape[1]
    for b in range(diagonal.shape[0]):
        for s in range(stations):
            if s > 0:
                for i in range(2):
                    B0, B1 = below[b, s, i, 0], below[b, s, i, 1]
                    link[b, s - 1, 2 * i] = B0 * inverse[b, s - 1, 0] + B1 * inverse[b, s - 1, 1]
                    link[b, s - 1, 2 * i + 1] = B0 * inverse[b, s - 1, 1] + B1 * inverse[b, s - 1, 2]
                for i in range(2):
                    for j in range(2):
                        diagonal[b, s, i, j] -= (
                            link[b, s - 1, 2 * i] * below[b, s, j, 0] + link[b, s - 1, 2 * i + 1] * below[b, s, j, 1]
                        )
            ww, wr, rr = diagonal[b, s, 0, 0], diagonal[b, s, 0, 1], diagonal[b, s, 1, 1]
            determinant = ww * rr - wr * diagonal[b, s, 1, 0]
            # Zero for fixed unknowns, where the block is the identity.
            inverse[b, s, 0] = rr / determinant if free[b, s, 0] else 0.0
            inverse[b, s, 1] = -wr / determinant if free[b, s, 0] and free[b, s, 1] else 0.0
            inverse[b, s, 2] = ww / determinant if free[b, s, 1] else 0.0


@entry_kernel
def solve_stations(factor: Factor, row: int, first: int, last: int, w: Array, r: Array, shift: int) -> None:
    """Solve A x = f in place for some stations of one row; f is zero and x negligible at all others.

    Args:
        factor: Block factors of A.
        row: Index of the row.
        first, last: First and last of the stations.
        w, r: Forces and moments [N, N m], replaced by accelerations of deflection and slope [m/s2, 1/s2], (n,). Station
            s is at index s + shift.
        shift: Index of station 0.
    """
    inverse, link = factor.inverse, factor.link
    force, moment = 0.0, 0.0
    for s in range(first, last + 1):
        w[s + shift] -= force
        r[s + shift] -= moment
        force, moment = _transfer(link, row, s, w[s + shift], r[s + shift])
    x, y = 0.0, 0.0
    for s in range(last, first - 1, -1):
        f, m = w[s + shift], r[s + shift]
        x, y = (
            inverse[row, s, 0] * f + inverse[row, s, 1] * m - (link[row, s, 0] * x + link[row, s, 2] * y),
            inverse[row, s, 1] * f + inverse[row, s, 2] * m - (link[row, s, 1] * x + link[row, s, 3] * y),
        )
        w[s + shift], r[s + shift] = x, y


@kernel
def _transfer(link: Array, row: int, s: int, force: float, moment: float) -> ForceMoment:
    """Force and moment L g that a station transfers to the next one."""
    return (
        link[row, s, 0] * force + link[row, s, 1] * moment,
        link[row, s, 2] * force + link[row, s, 3] * moment,
    )

"""Local columns of the inverse of the effective matrix: the response of a row to a unit force within one step.

Within one step a force influences the line over a few times sqrt(T / m) dt / 2 only (0.1 m at 1 ms). The columns of the
inverse are therefore short. The matrix is symmetric: the column of a force at a station is also the share of every
force around in the acceleration of this station.
"""

import numpy as np
from numba import njit

from pantocheck.model.arrays import Array, Indices
from pantocheck.model.dynamics.block_tridiagonal import Factor, solve_stations

NEGLIGIBLE_SHARE = 1e-12
"""A column is cut where it has decayed below this share of its peak: a hundredth of the tolerance of the forces."""


@njit(cache=True)
def _column_tail(factor: Factor, row: int, station: int, slope: int, half_width: int) -> float:
    """Size of a column of the inverse at a cut on either side, relative to its peak.

    The column is that of a unit force (slope 0) or a unit moment (slope 1) at a station.
    """
    first, last = max(0, station - half_width), min(factor.link.shape[1], station + half_width) - 1
    column = np.zeros((2, last + 1 - first))
    column[slope, station - first] = 1.0
    solve_stations(factor, row, first, last, column[0], column[1], -first)
    size = np.abs(column[0]) + np.abs(column[1])
    tail = 0.0
    if first == station - half_width:
        tail = size[0]
    if last == station + half_width - 1:
        tail = max(tail, size[-1])
    peak = size.max()
    return tail / peak if peak > 0 else 0.0


def column_half_width(factor: Factor, loads: list[tuple[int, int]]) -> int:
    """Number of stations to keep on either side of a load: the rest of its column is negligible for every load.

    A load is a row and a station.
    """
    width = 8
    while width < factor.link.shape[1]:
        tails = (_column_tail(factor, row, s, slope, width) for row, s in loads for slope in (0, 1))
        if all(tail < NEGLIGIBLE_SHARE for tail in tails):
            break
        width += 8  # whole vectors
    return width


@njit(cache=True)
def inverse_columns(factor: Factor, rows: Indices, stations: Indices, starts: Indices, columns: Array) -> None:
    """Fill local columns of the inverse for L unit forces.

    Parameters
    ----------
    factor : Factor
        Block factors.
    rows, stations : (L,) int ndarray
        Places of the forces.
    starts : (L,) int ndarray
        Station of the first value of each column; it can lie before the line.
    columns : (L, 2, n) ndarray
        Deflection and slope at n stations, zero on entry; they stay zero beyond the ends of the line.
    """
    for k in range(rows.size):
        first, last = max(0, starts[k]), min(factor.link.shape[1], starts[k] + columns.shape[2]) - 1
        columns[k, 0, stations[k] - starts[k]] = 1.0
        solve_stations(factor, rows[k], first, last, columns[k, 0], columns[k, 1], -starts[k])

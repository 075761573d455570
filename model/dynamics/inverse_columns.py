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


def column_half_width(factor: Factor, loads: list[tuple[int, int]]) -> int:
    """Number of stations to keep on either side of a load: the rest of its column is negligible for every load.

    A load is a row and a station.
    """
    rows, stations = np.array(loads, dtype=np.int64).reshape(-1, 2).T.copy()
    width = 8
    while width < factor.link.shape[1] and _largest_tail(factor, rows, stations, width) >= NEGLIGIBLE_SHARE:
        width += 8  # whole vectors
    return width


@njit(cache=True)
def _largest_tail(factor: Factor, rows: Indices, stations: Indices, half_width: int) -> float:
    """Largest size of a column of the inverse at a cut on either side of its load, relative to its peak.

    The columns are those of a unit force and of a unit moment at every load.
    """
    column = np.zeros((2, 2 * half_width))
    largest = 0.0
    for k in range(rows.size):
        first, last = max(0, stations[k] - half_width), min(factor.link.shape[1], stations[k] + half_width) - 1
        shift = half_width - stations[k]
        for slope in range(2):
            column[:] = 0.0
            column[slope, half_width] = 1.0
            solve_stations(factor, rows[k], first, last, column[0], column[1], shift)
            peak = 0.0
            for i in range(2 * half_width):
                peak = max(peak, abs(column[0, i]) + abs(column[1, i]))
            # Zero beyond the ends of the line.
            tail = max(abs(column[0, 0]) + abs(column[1, 0]), abs(column[0, -1]) + abs(column[1, -1]))
            if peak > 0.0:
                largest = max(largest, tail / peak)
    return largest


@njit(cache=True)
def inverse_columns(factor: Factor, rows: Indices, stations: Indices, starts: Indices, columns: Array) -> None:
    """Fill local columns of the inverse for L unit forces.

    Args:
        factor: Block factors.
        rows, stations: Places of the forces, (L,).
        starts: Station of the first value of each column, (L,); it can lie before the line.
        columns: Deflection and slope at n stations, zero on entry, (L, 2, n); they stay zero beyond the ends of the
            line.
    """
    for k in range(rows.size):
        first, last = max(0, starts[k]), min(factor.link.shape[1], starts[k] + columns.shape[2]) - 1
        columns[k, 0, stations[k] - starts[k]] = 1.0
        solve_stations(factor, rows[k], first, last, columns[k, 0], columns[k, 1], -starts[k])

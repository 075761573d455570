"""Local columns of the inverse of the effective matrix: the response of a row to a unit force within one step.

Within one step a force influences the line over a few times sqrt(T / m) dt / 2 only (0.1 m at 1 ms). The columns of the
inverse are therefore short, and a connector or a contact is a correction of a few stations.
"""

import numpy as np
from numba import njit

from pantocheck.model.arrays import Array, Indices
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.block_tridiagonal import Factor, solve_row

NEGLIGIBLE_SHARE = 1e-12
"""A column is cut where it has decayed below this share of its peak: a hundredth of the tolerance of the forces."""


@njit(cache=True)
def _inverse_column(factor: Factor, row: int, station: int, slope: int, column: Array) -> float:
    """Compute one column of the inverse, for a unit force (slope 0) or a unit moment (slope 1) at a station.

    Fills `column`, (2, 2H), with deflection and slope: the loaded station is at index H, and both are zero beyond the
    ends of the line. Returns the size of the column at the cut relative to its peak.
    """
    half_width, stations = column.shape[1] // 2, factor.meeting.shape[1]
    column[:] = 0.0
    column[slope, half_width] = 1.0
    first, last = max(0, station - half_width), min(stations, station + half_width)
    inside = slice(first + half_width - station, last + half_width - station)
    solve_row(factor, row, first, (last - first) // 2, column[0, inside], column[1, inside])
    size = np.abs(column[0]) + np.abs(column[1])
    tail = 0.0
    if first == station - half_width:
        tail = size[0]
    if last == station + half_width:
        tail = max(tail, size[-1])
    peak = size.max()
    return tail / peak if peak > 0 else 0.0


def column_half_width(factor: Factor, loads: list[tuple[int, int]]) -> int:
    """Number of stations to keep on either side of a load: the rest of its column is negligible for every load.

    A load is a row and a station.
    """
    width = 8
    while width < factor.meeting.shape[1]:
        column = np.zeros((2, 2 * width))
        tails = (_inverse_column(factor, row, s, slope, column) for row, s in loads for slope in (0, 1))
        if all(tail < NEGLIGIBLE_SHARE for tail in tails):
            break
        width += 8  # whole vector registers
    return width


@njit(cache=True)
def inverse_columns(factor: Factor, rows: Indices, stations: Indices, slopes: Indices, half_width: int) -> Array:
    """Columns of the inverse for L unit forces (slope 0) or moments (slope 1), with H stations on either side.

    The shape is (L, 2, 2H): deflection and slope, with the loaded station at index H.
    """
    columns = np.zeros((rows.size, 2, 2 * half_width))
    for n in range(rows.size):
        _inverse_column(factor, rows[n], stations[n], slopes[n], columns[n])
    return columns


@njit(cache=True)
def add_column(w: Array, r: Array, column: Array, station: int, value: float, window: Window) -> None:
    """Add the response to a force to the accelerations of one row, within the active window.

    Parameters
    ----------
    w, r : (S,) ndarray
        Accelerations of deflection and slope [m/s2, 1/s2].
    column : (2, 2H) ndarray
        Local column of the inverse.
    station : int
        Loaded station.
    value : float
        Force or moment [N, N m].
    window : Window
        Active window.
    """
    half_width = column.shape[1] // 2
    first, last = max(window.first, station - half_width), min(window.last + 1, station + half_width)
    shift = half_width - station
    column_w, column_r = column[0, first + shift : last + shift], column[1, first + shift : last + shift]
    w, r = w[first:last], r[first:last]
    for i in range(w.size):
        w[i] += value * column_w[i]
        r[i] += value * column_r[i]

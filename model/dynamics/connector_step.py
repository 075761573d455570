"""Connectors in a time step: Gauss-Seidel sweeps over their tensions.

With the predicted elongation d and its rate d', the tension N at the end of a step of a connector with coefficients c
on the rows at its station is

    N = max(0, N0 + k d + c_d d' + g a),    a = sum of c times the row accelerations,    g = k dt^2/4 + c_d dt/2

A change of N changes a by -(compliance) N, through the local columns of the inverse (`inverse_columns`). With all other
forces held, N is solved exactly: N = (N0 + k d + c_d d' + g a + g_c N_old) / (1 + g_c), with g_c = g times compliance.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from pantocheck.model.arrays import Array, Indices
from pantocheck.model.dynamics.active_window import Window
from pantocheck.model.dynamics.block_tridiagonal import Factor
from pantocheck.model.dynamics.extents import active_run, find_runs
from pantocheck.model.dynamics.inverse_columns import add_column, inverse_columns
from pantocheck.model.dynamics.motion import Motion
from pantocheck.model.dynamics.sweeps import NEGLIGIBLE_FORCE, maximum
from pantocheck.model.fem.connectors import Connectors


class ConnectorArrays(NamedTuple):
    """Connectors of a line in a time step; N connectors in R runs with at most E ends, L ends in total.

    Parameters
    ----------
    run : (R + 1,) int ndarray
        First connector of each run (`find_runs`), and N.
    station : (N,) int ndarray
        Stations of the connectors.
    end_row, end_column : (N, E) int ndarray
        Row of each end, and its column in `columns`.
    end_coefficient : (N, E) ndarray
        Coefficient of each end in the elongation; zero for a missing end [-].
    columns : (L, 2, 2H) ndarray
        Columns of the inverse around the ends.
    stiffness, damping, preload : (N,) ndarray
        Coefficients and tension in the initial state [N/m, N s/m, N].
    tension_per_acceleration : (N,) ndarray
        Tension per acceleration of the elongation within a step, g [kg].
    self_compliance : (N,) ndarray
        g times the acceleration of the elongation per tension [-].
    unilateral : (N,) ndarray
        Whether the tension cannot be negative.
    """

    run: Indices
    station: Indices
    end_row: Indices
    end_column: Indices
    end_coefficient: Array
    columns: Array
    stiffness: Array
    damping: Array
    preload: Array
    tension_per_acceleration: Array
    self_compliance: Array
    unilateral: NDArray[np.bool_]


def connector_ends(connectors: Connectors) -> list[tuple[int, int]]:
    """Row and station of all ends, connector by connector."""
    number, row = np.nonzero(connectors.coefficient)
    return list(zip(row.tolist(), connectors.station[number].tolist(), strict=True))


def build_connector_arrays(
    connectors: Connectors, factor: Factor, time_step: float, half_width: int
) -> ConnectorArrays:
    """Build the arrays of the connectors for a time step [s]; `half_width` as in `inverse_columns`."""
    number, row = np.nonzero(connectors.coefficient)
    end = np.arange(number.size) - np.searchsorted(number, number)
    shape = (len(connectors.station), int(end.max(initial=-1)) + 1)
    end_row, end_column = (np.zeros(shape, dtype=np.int64) for _ in range(2))
    end_coefficient = np.zeros(shape)
    end_row[number, end], end_column[number, end] = row, np.arange(number.size)
    end_coefficient[number, end] = connectors.coefficient[number, row]
    columns = inverse_columns(factor, row, connectors.station[number], np.zeros_like(row), half_width)
    gain = time_step**2 / 4 * connectors.stiffness + time_step / 2 * connectors.damping
    return ConnectorArrays(
        run=find_runs(connectors.station),
        station=connectors.station,
        end_row=end_row,
        end_column=end_column,
        end_coefficient=end_coefficient,
        columns=columns,
        stiffness=connectors.stiffness,
        damping=connectors.damping,
        preload=connectors.preload,
        tension_per_acceleration=gain,
        self_compliance=gain * (end_coefficient**2 * columns[end_column, 0, half_width]).sum(axis=1),
        unilateral=connectors.unilateral,
    )


@njit(cache=True)
def predict_connectors(connectors: ConnectorArrays, motion: Motion, predicted: Array, window: Window) -> None:
    """Fill the predicted tensions, and load the rows with the tensions of the last step as a first guess."""
    for k in range(connectors.run.size - 1):
        first, end = active_run(connectors.station[connectors.run[k] : connectors.run[k + 1]], window)
        for n in range(connectors.run[k] + first, connectors.run[k] + end):
            s = connectors.station[n]
            change = motion.tension[n] - connectors.preload[n]
            elongation, rate = 0.0, 0.0
            for e in range(connectors.end_row.shape[1]):
                row, c = connectors.end_row[n, e], connectors.end_coefficient[n, e]
                elongation += c * motion.w[0, row, s]
                rate += c * motion.w[1, row, s]
                motion.w[2, row, s] -= c * change
            predicted[n] = connectors.preload[n] + connectors.stiffness[n] * elongation + connectors.damping[n] * rate


@njit(cache=True)
def sweep_connectors(connectors: ConnectorArrays, motion: Motion, predicted: Array, window: Window) -> float:
    """Solve every active connector once, all other forces held; return the largest change of a tension [N]."""
    w, r = motion.w[2], motion.r[2]
    largest = 0.0
    for k in range(connectors.run.size - 1):
        first, end = active_run(connectors.station[connectors.run[k] : connectors.run[k + 1]], window)
        for n in range(connectors.run[k] + first, connectors.run[k] + end):
            s, acceleration = connectors.station[n], 0.0
            for e in range(connectors.end_row.shape[1]):
                acceleration += connectors.end_coefficient[n, e] * w[connectors.end_row[n, e], s]
            linear = predicted[n] + connectors.tension_per_acceleration[n] * acceleration
            compliance = connectors.self_compliance[n]
            tension = (linear + compliance * motion.tension[n]) / (1 + compliance)
            if connectors.unilateral[n] and tension < 0.0:
                tension = 0.0
            change = tension - motion.tension[n]
            if abs(change) > NEGLIGIBLE_FORCE:
                motion.tension[n] = tension
                for e in range(connectors.end_row.shape[1]):
                    row, c = connectors.end_row[n, e], connectors.end_coefficient[n, e]
                    if c != 0.0:
                        column = connectors.columns[connectors.end_column[n, e]]
                        add_column(w[row], r[row], column, s, -c * change, window)
            largest = maximum(largest, abs(change))
    return largest

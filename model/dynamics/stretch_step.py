"""Held stretches in a time step: Gauss-Seidel sweeps over their additional tensions.

With the predicted elongation e of a stretch and its vector a of elongations per unknown, the additional tension at the
end of a step is h = k (e + dt^2/4 a'q''). A change of h changes a'q'' by -(compliance) h, compliance = a' A^-1 a, so
that h is solved exactly with all other forces held:

    h = (k (e + dt^2/4 a'q'') + g h_old) / (1 + g),    g = k dt^2/4 compliance

Within a step a stretch accelerates its own wire only, a few stations beyond its ends included.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from pantocheck.model.arrays import Array, Indices
from pantocheck.model.dynamics.block_tridiagonal import Factor, solve_rows
from pantocheck.model.dynamics.motion import Motion
from pantocheck.model.dynamics.sweeps import NEGLIGIBLE_FORCE, inner_product, maximum
from pantocheck.model.fem.held_stretches import HeldStretches


class StretchArrays(NamedTuple):
    """Held stretches in a time step; K stretches over at most W stations with their margins, F fields.

    Parameters
    ----------
    first, last : (K,) int ndarray
        First station, and one after the last, margins included.
    row : (K, F) int ndarray
        Rows of the wire.
    stiffness, stiffness_of_step : (K,) ndarray
        Additional tension per elongation [N/m], and per acceleration of the elongation within a step, k dt^2/4 [kg].
    self_compliance : (K,) ndarray
        Change of the additional tension within a step per additional tension, g [-].
    coefficient : (K, F, 2, W) ndarray
        Elongation per deflection and slope [-, m].
    response : (K, F, 2, W) ndarray
        Acceleration of deflection and slope per force along the elongation [1/kg, 1/(kg m)].
    """

    first: Indices
    last: Indices
    row: Indices
    stiffness: Array
    stiffness_of_step: Array
    self_compliance: Array
    coefficient: Array
    response: Array


def build_stretch_arrays(stretches: HeldStretches, factor: Factor, time_step: float, half_width: int) -> StretchArrays:
    """Build the arrays of the held stretches for a time step [s].

    The margin `half_width` beyond the ends of a stretch [stations] is that of `inverse_columns`: farther away the
    response to a force is negligible.
    """
    rows, stations = factor.meeting.shape[:2]
    number, fields, width = stretches.coefficient.shape[:3]
    first = np.maximum(0, stretches.first - half_width)
    last = np.minimum(stations, stretches.first + width + half_width)
    coefficient, response = (np.zeros((number, fields, 2, int((last - first).max(initial=0)))) for _ in range(2))
    for k in range(number):
        whole = np.zeros((1, rows, stations, 2))
        inside = slice(stretches.first[k], min(stations, stretches.first[k] + width))
        whole[0, stretches.row[k], inside] = stretches.coefficient[k, :, : inside.stop - inside.start]
        solution, place = solve_rows(factor, whole), slice(first[k], last[k])
        for field, row in enumerate(stretches.row[k]):
            coefficient[k, field, :, : last[k] - first[k]] = whole[0, row, place].T
            response[k, field, :, : last[k] - first[k]] = solution[0, row, place].T
    stiffness_of_step = time_step**2 / 4 * stretches.stiffness
    compliance = np.einsum("kfiw,kfiw->k", coefficient, response)
    return StretchArrays(
        first, last, stretches.row, stretches.stiffness, stiffness_of_step, stiffness_of_step * compliance,
        coefficient, response,
    )  # fmt: skip


@njit(cache=True)
def predict_stretches(stretches: StretchArrays, motion: Motion, elongation: Array) -> None:
    """Fill the predicted elongations, and load the rows with the additional tensions of the last step."""
    for k in range(stretches.stiffness.size):
        elongation[k] = _elongation(stretches, k, motion.w[0], motion.r[0])
        _add_shape(stretches, stretches.coefficient, k, -motion.additional_tension[k], motion.w[2], motion.r[2])


@njit(cache=True)
def sweep_stretches(stretches: StretchArrays, motion: Motion, elongation: Array) -> float:
    """Solve every additional tension once, all other forces held; return the largest change [N]."""
    w, r = motion.w[2], motion.r[2]
    largest = 0.0
    for k in range(stretches.stiffness.size):
        acceleration, old = _elongation(stretches, k, w, r), motion.additional_tension[k]
        linear = stretches.stiffness[k] * elongation[k] + stretches.stiffness_of_step[k] * acceleration
        compliance = stretches.self_compliance[k]
        change = (linear + compliance * old) / (1 + compliance) - old
        if abs(change) > NEGLIGIBLE_FORCE:
            motion.additional_tension[k] = old + change
            _add_shape(stretches, stretches.response, k, -change, w, r)
        largest = maximum(largest, abs(change))
    return largest


@njit(cache=True)
def _elongation(stretches: StretchArrays, k: int, w: Array, r: Array) -> float:
    """Elongation of a stretch, or its rate, from deflections and slopes of all rows."""
    total, first, last = 0.0, stretches.first[k], stretches.last[k]
    for f in range(stretches.row.shape[1]):
        row, coefficient = stretches.row[k, f], stretches.coefficient[k, f]
        total += inner_product(coefficient[0], w[row, first:last]) + inner_product(coefficient[1], r[row, first:last])
    return total


@njit(cache=True)
def _add_shape(stretches: StretchArrays, shape: Array, k: int, value: float, w: Array, r: Array) -> None:
    """Add `value` times the coefficients or the response of a stretch to deflections and slopes of its rows."""
    first, last = stretches.first[k], stretches.last[k]
    for f in range(stretches.row.shape[1]):
        row, shape_w, shape_r = stretches.row[k, f], shape[k, f, 0], shape[k, f, 1]
        row_w, row_r = w[row, first:last], r[row, first:last]
        for s in range(row_w.size):
            row_w[s] += value * shape_w[s]
            row_r[s] += value * shape_r[s]

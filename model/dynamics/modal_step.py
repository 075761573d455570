"""Modal damping in a time step: Gauss-Seidel sweeps over the damping forces of single modes.

Mode j with weight W = M phi, velocity eta' = W' q' and damping coefficient d has the force F = -d eta' along W. Within
a step eta' changes by the compliance dt/2 W' A^-1 W per force, so F is solved exactly with all other forces held. The
full damping matrix, sum of d W W', is never formed.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from pantocheck.model.arrays import Array
from pantocheck.model.dynamics.block_tridiagonal import Factor, solve_rows
from pantocheck.model.dynamics.motion import Motion
from pantocheck.model.dynamics.sweeps import NEGLIGIBLE_FORCE, inner_product, maximum
from pantocheck.model.modal.modal_damping import ModalTerms


class ModalArrays(NamedTuple):
    """Modal damping in a time step; J modes, B rows, S stations.

    Parameters
    ----------
    time_step : float
        Time step [s].
    damping : (J,) ndarray
        Damping coefficients of the modes [1/s].
    weight : (J, 2, B, S) ndarray
        M phi of the modes, deflections and slopes [kg^1/2].
    response : (J, 2, B, S) ndarray
        Inverse of the effective matrix applied to the weight [kg^-1/2].
    compliance : (J,) ndarray
        Weight times response [-].
    """

    time_step: float
    damping: Array
    weight: Array
    response: Array
    compliance: Array


def build_modal_arrays(terms: ModalTerms, factor: Factor, time_step: float) -> ModalArrays:
    """Modal damping in a time step [s], from the low-rank terms of the damping matrix."""
    response = solve_rows(factor, terms.weight)
    return ModalArrays(
        time_step=time_step,
        damping=terms.damping,
        weight=_fields_first(terms.weight),
        response=_fields_first(response),
        compliance=np.einsum("jbsi,jbsi->j", terms.weight, response),
    )


def _fields_first(shapes: Array) -> Array:
    """Reorder (n, rows, stations, 2) to (n, 2, rows, stations), contiguous along the stations."""
    return np.ascontiguousarray(np.moveaxis(shapes, -1, 1))


@njit(cache=True)
def predict_modes(modes: ModalArrays, motion: Motion, velocity: Array) -> None:
    """Fill the predicted modal velocities, and load the rows with the forces of the last step as a first guess."""
    for j in range(modes.damping.size):
        velocity[j] = _participation(modes.weight[j], motion.w[1], motion.r[1])
        _add_shape(motion.w[2], motion.r[2], modes.weight[j], motion.modal[j])


@njit(cache=True)
def sweep_modes(modes: ModalArrays, motion: Motion, predicted: Array) -> float:
    """Solve the damping force of every mode once, all other forces held; return the largest change."""
    half = modes.time_step / 2
    w, r = motion.w[2], motion.r[2]
    largest = 0.0
    for j in range(modes.damping.size):
        velocity = predicted[j] + half * _participation(modes.weight[j], w, r)
        compliance = half * modes.compliance[j]
        velocity -= compliance * motion.modal[j]
        force = -modes.damping[j] * velocity / (1 + modes.damping[j] * compliance)
        change = force - motion.modal[j]
        if abs(change) > NEGLIGIBLE_FORCE:
            motion.modal[j] = force
            _add_shape(w, r, modes.response[j], change)
        largest = maximum(largest, abs(change))
    return largest


@njit(cache=True)
def _participation(weight: Array, w: Array, r: Array) -> float:
    """Participation of a mode in a field of deflections and slopes."""
    total = 0.0
    for b in range(w.shape[0]):
        total += inner_product(weight[0, b], w[b]) + inner_product(weight[1, b], r[b])
    return total


@njit(cache=True)
def _add_shape(w: Array, r: Array, shape: Array, value: float) -> None:
    """Add `value` times a shape to deflections and slopes."""
    for b in range(w.shape[0]):
        shape_w, shape_r, row_w, row_r = shape[0, b], shape[1, b], w[b], r[b]
        for s in range(row_w.size):
            row_w[s] += value * shape_w[s]
            row_r[s] += value * shape_r[s]

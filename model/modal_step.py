"""Damping forces on single modes within a time step, each solved exactly in turn; no full matrix is formed."""

import numpy as np
from numba import njit
from numpy.typing import NDArray
from pantocheck.model.connector_step import NEGLIGIBLE_FORCE, larger
from pantocheck.model.state import Line, Motion

Array = NDArray[np.float64]


@njit(cache=True)
def add_mode(w: Array, r: Array, shape: Array, value: float) -> None:
    for b in range(w.shape[0]):
        for s in range(w.shape[1]):
            w[b, s] += value * shape[b, s, 0]
            r[b, s] += value * shape[b, s, 1]


@njit(cache=True)
def turn_modes(line: Line, motion: Motion, w: Array, r: Array) -> float:
    """Solve the damping force on every mode of its own damping once, the others held; returns the largest change."""
    dt = line.time_step
    largest = 0.0
    for j in range(line.modal_damping.size):
        weight, velocity = line.modal_weight[j], 0.0
        for b in range(w.shape[0]):
            for s in range(w.shape[1]):
                velocity += weight[b, s, 0] * (motion.w[1, b, s] + dt / 2 * w[b, s])
                velocity += weight[b, s, 1] * (motion.r[1, b, s] + dt / 2 * r[b, s])
        compliance = dt / 2 * line.modal_compliance[j]
        velocity -= compliance * motion.modal[j]
        force = -line.modal_damping[j] * velocity / (1 + line.modal_damping[j] * compliance)
        change = force - motion.modal[j]
        if abs(change) > NEGLIGIBLE_FORCE:
            motion.modal[j] = force
            add_mode(w, r, line.modal_response[j], change)
        largest = larger(largest, abs(change))
    return largest

"""Damping forces on single modes within a time step, each solved exactly in turn; no full matrix is formed."""

from numba import njit

from pantocheck.model.arrays import Array
from pantocheck.model.dynamics.connector_step import NEGLIGIBLE_FORCE, larger
from pantocheck.model.dynamics.state import KernelArrays, Motion, Workspace


@njit(cache=True)
def predict_modes(line: KernelArrays, motion: Motion, work: Workspace) -> None:
    """Predicted velocities of the modes; they are damped with the forces of the last step to begin with."""
    for j in range(line.modal_damping.size):
        work.modal_velocity[j] = _share(line.modal_weight[j], motion.w[1], motion.r[1])
        _add(motion.w[2], motion.r[2], line.modal_weight[j], motion.modal[j])


@njit(cache=True)
def sweep_modes(line: KernelArrays, motion: Motion, work: Workspace, w: Array, r: Array) -> float:
    """Solve the damping force on every mode of its own damping once, the others held; returns the largest change."""
    dt = line.time_step
    largest = 0.0
    for j in range(line.modal_damping.size):
        velocity = work.modal_velocity[j] + dt / 2 * _share(line.modal_weight[j], w, r)
        compliance = dt / 2 * line.modal_compliance[j]
        velocity -= compliance * motion.modal[j]
        force = -line.modal_damping[j] * velocity / (1 + line.modal_damping[j] * compliance)
        change = force - motion.modal[j]
        if abs(change) > NEGLIGIBLE_FORCE:
            motion.modal[j] = force
            _add(w, r, line.modal_response[j], change)
        largest = larger(largest, abs(change))
    return largest


@njit(cache=True)
def _share(weight: Array, w: Array, r: Array) -> float:
    """A mode's share in a field of deflections and slopes."""
    total = 0.0
    for b in range(w.shape[0]):
        total += _product(weight[0, b], w[b]) + _product(weight[1, b], r[b])
    return total


# Left free to add up in any order, the sum compiles to vector instructions.
@njit(cache=True, fastmath={"reassoc"})
def _product(a: Array, b: Array) -> float:
    total = 0.0
    for s in range(a.size):
        total += a[s] * b[s]
    return total


@njit(cache=True)
def _add(w: Array, r: Array, shape: Array, value: float) -> None:
    for b in range(w.shape[0]):
        of_w, of_r, w_, r_ = shape[0, b], shape[1, b], w[b], r[b]
        for s in range(w_.size):
            w_[s] += value * of_w[s]
            r_[s] += value * of_r[s]

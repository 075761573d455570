"""The pantographs' part of a time step: predictors, and every contact force solved exactly in turn."""

import numpy as np
from numba import njit

from pantocheck.model.arrays import Array
from pantocheck.model.dynamics.connector_step import NEGLIGIBLE_FORCE, add_column, larger
from pantocheck.model.dynamics.state import KernelArrays, Motion, Train, Workspace
from pantocheck.model.fem.residual_flexibility import local_flexibility


@njit(cache=True)
def predict_train(line: KernelArrays, motion: Motion, train: Train, work: Workspace) -> None:
    """Move the pantographs on, predict them, and press with the contact forces of the last step to begin with."""
    dt = line.time_step
    unknowns = train.z.shape[2]
    train.elapsed[0] += dt
    for p in range(train.position.size):
        train.position[p] += dt * train.speed[0]
        for i in range(unknowns):
            train.z[0, p, i] += dt * train.z[1, p, i] + dt * dt / 4 * train.z[2, p, i]
            train.z[1, p, i] += dt / 2 * train.z[2, p, i]
        pressing = 0.0
        for k in range(train.contact.shape[1]):
            pressing += train.contact[p, k]
        head, compliance = 0.0, 0.0
        for i in range(unknowns):
            a = 0.0
            for j in range(unknowns):
                f = train.force[p, j] - train.head[p, j] * pressing
                for m in range(unknowns):
                    f -= train.damping[p, j, m] * train.z[1, p, m] + train.stiffness[p, j, m] * train.z[0, p, m]
                a += train.inverse[p, i, j] * f
                compliance += train.head[p, i] * train.inverse[p, i, j] * train.head[p, j]
            train.z[2, p, i] = a
            head += train.head[p, i] * train.z[0, p, i]
        for k in range(train.contact.shape[1]):
            _predict_contact(line, motion, train, work, p, k, head, compliance)


@njit(cache=True)
def _predict_contact(
    line: KernelArrays,
    motion: Motion,
    train: Train,
    work: Workspace,
    p: int,
    k: int,
    head: float,
    head_compliance: float,
) -> None:
    """Where a head touches a wire, how far it has closed on it, and what a newton between them would do."""
    half = line.columns.shape[2] // 2
    x, row, n = train.position[p], line.contact_row[k], work.shape[p, k]
    e = min(max(np.searchsorted(line.position, x) - 1, 0), line.position.size - 2)
    h = line.position[e + 1] - line.position[e]
    s = (x - line.position[e]) / h
    n[0], n[1] = (1 + 2 * s) * (1 - s) ** 2, h * s * (1 - s) ** 2
    n[2], n[3] = s * s * (3 - 2 * s), h * s * s * (s - 1)
    wire, compliance = 0.0, head_compliance
    for i in range(2):
        wire += n[2 * i] * (line.rest[k, e + i, 0] + motion.w[0, row, e + i])
        wire += n[2 * i + 1] * (line.rest[k, e + i, 1] + motion.r[0, row, e + i])
        motion.w[2, row, e + i] += n[2 * i] * train.contact[p, k]
        motion.r[2, row, e + i] += n[2 * i + 1] * train.contact[p, k]
        for j in range(2):
            for m in range(2):
                column = line.contact_columns[k, e + j, m]
                at = half + i - j
                compliance += n[2 * j + m] * (n[2 * i] * column[0, at] + n[2 * i + 1] * column[1, at])
    work.element[p] = e
    work.stiffness[p, k] = 1 / (1 / train.contact_stiffness[p] + local_flexibility(line.bubble[k, e], s))
    work.closing[p, k] = head - wire
    work.compliance[p, k] = compliance


@njit(cache=True)
def sweep_contacts(
    line: KernelArrays, train: Train, work: Workspace, w: Array, r: Array, first: int, last: int
) -> float:
    """Solve every contact once, the other forces held; returns the largest change of a contact force [N]."""
    dt = line.time_step
    largest = 0.0
    for p in range(train.position.size):
        e = work.element[p]
        for m in range(train.contact.shape[1]):
            row, n, k = line.contact_row[m], work.shape[p, m], work.stiffness[p, m]
            approach = 0.0
            for i in range(train.z.shape[2]):
                approach += train.head[p, i] * train.z[2, p, i]
            approach -= n[0] * w[row, e] + n[1] * r[row, e] + n[2] * w[row, e + 1] + n[3] * r[row, e + 1]
            gain = k * dt * dt / 4
            stiff = gain * work.compliance[p, m]
            force = (k * work.closing[p, m] + gain * approach + stiff * train.contact[p, m]) / (1 + stiff)
            force = max(force, 0.0)
            change = force - train.contact[p, m]
            if abs(change) > NEGLIGIBLE_FORCE:
                train.contact[p, m] = force
                for i in range(2):
                    for j in range(2):
                        column, value = line.contact_columns[m, e + i, j], n[2 * i + j] * change
                        add_column(w[row], r[row], column, e + i, value, (first, last))
                for i in range(train.z.shape[2]):
                    for j in range(train.z.shape[2]):
                        train.z[2, p, i] -= train.inverse[p, i, j] * train.head[p, j] * change
            largest = larger(largest, abs(change))
    return largest


@njit(cache=True)
def correct_train(dt: float, train: Train) -> None:
    """Turn the predictors back into displacement and velocity, with the accelerations that were found."""
    for p in range(train.position.size):
        for i in range(train.z.shape[2]):
            train.z[0, p, i] += dt * dt / 4 * train.z[2, p, i]
            train.z[1, p, i] += dt / 2 * train.z[2, p, i]

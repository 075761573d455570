"""Pantograph of the geometrically exact model and its contact with the contact wire."""

from typing import NamedTuple

import numpy as np
from numba import njit

from verification.formulations.exact_line import Array, ExactLine


class ExactPantograph(NamedTuple):
    """Pantograph M z'' + C z' + K z = force - contact force on the head, under one contact wire."""

    inverse_mass: Array
    damping: Array
    stiffness: Array
    """Matrices, (n, n) [1/kg, N s/m, N/m]."""
    head: Array
    force: Array
    """Selects the head from the unknowns, (n,); constant forces [-, N]."""
    contact_stiffness: float
    """Stiffness of the penalty contact [N/m]; zero: no contact."""
    wire: int
    """Number of the contact wire."""


@njit(cache=True)
def add_contact(line: ExactLine, train: ExactPantograph, position: Array, z: Array, x: float, force: Array) -> float:
    """Add the contact force at x [m] to the contact wire, vertical and without friction, and return it [N]."""
    if train.contact_stiffness == 0.0:
        return 0.0
    wires, w = line.wires, train.wire
    i = wires.first[w] + int((x - position[0, wires.first[w]]) / wires.spacing[w])
    while position[0, i] > x:
        i -= 1
    while position[0, i + 1] <= x:
        i += 1
    shares = cubic_shares((x - position[0, i]) / (position[0, i + 1] - position[0, i]))
    closing = 0.0
    for n in range(z.size):
        closing += train.head[n] * z[n]
    for k in range(4):
        closing -= shares[k] * position[2, i - 1 + k]
    contact = max(0.0, train.contact_stiffness * closing)
    for k in range(4):
        force[2, i - 1 + k] += shares[k] * contact
    return contact


@njit(cache=True)
def cubic_shares(s: float) -> tuple[float, float, float, float]:
    """Shares of four neighbouring points in the cubic through them, at the share s of the middle segment [-]."""
    before, here, after = s + 1, s - 1, s - 2
    return -s * here * after / 6, before * here * after / 2, -before * s * after / 2, before * s * here / 6


@njit(cache=True)
def advance_pantograph(train: ExactPantograph, z: Array, v: Array, dt: float, drag: float, contact: float) -> None:
    """Advance the pantograph by one step under the contact force [N], in place; arguments as in `advance`."""
    n = z.size
    load = np.zeros(n)
    for i in range(n):
        load[i] = train.force[i] - contact * train.head[i]
        for j in range(n):
            load[i] -= train.stiffness[i, j] * z[j] + train.damping[i, j] * v[j]
    for i in range(n):
        acceleration = 0.0
        for j in range(n):
            acceleration += train.inverse_mass[i, j] * load[j]
        v[i] = ((1 - dt * drag / 2) * v[i] + dt * acceleration) / (1 + dt * drag / 2)
    for i in range(n):
        z[i] += dt * v[i]

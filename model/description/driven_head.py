"""Motion of a pantograph under given contact forces, with friction, stops, and strips that depend on the wire's place.

M z'' + C z' + K z  =  f - sum of s_c(y_c) F_c - sum of d_j X_j,        X_j = k (e - gap) + c e' within its bounds

Trapezoidal rule: within a step the forces of the joints are linear between their bounds, and sweeps solve for them.
"""

from collections.abc import Sequence

import numpy as np

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.pantograph import ContactStrip, Pantograph

MOST_SWEEPS, REMAINDER_N = 200, 1e-9
"""Largest number of sweeps over the joints in a step, and change of a force that ends them [N]."""


def drive_head(pantograph: Pantograph, force: Array, lateral: Array, step: float) -> Array:
    """Displacement of the head, mean of its strips; at the start springs balance the first forces, below the axis.

    Args:
        pantograph: Model with masses.
        force: Contact force of each strip, (strips, T) [N].
        lateral: Lateral position of the wire above each strip, (strips, T) [m].
        step: Time between two forces [s].
    """
    n, joints = pantograph.head.size, pantograph.joints
    shapes = [_shapes_at(strip, y) for strip, y in zip(pantograph.strips, lateral, strict=True)]
    load = pantograph.force - sum(part[:, None] * shape for part, shape in zip(force, shapes, strict=True))
    inverse = np.linalg.inv(pantograph.mass)
    matrix = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ pantograph.stiffness, -inverse @ pantograph.damping]])
    implicit = np.linalg.inv(np.eye(2 * n) - step / 2 * matrix)
    advance, drive = implicit @ (np.eye(2 * n) + step / 2 * matrix), implicit[:, n:] @ (step / 2 * inverse)
    rows = np.array([np.append(j.stiffness * j.direction, j.damping * j.direction) for j in joints]).reshape(-1, 2 * n)
    push = -drive @ np.array([joint.direction for joint in joints]).reshape(-1, n).T
    offset = np.array([-joint.stiffness * joint.gap for joint in joints])
    bounds, own = [(joint.lower, joint.upper) for joint in joints], (rows @ push).tolist()
    at_rest = pantograph.force - force[:, 0] @ pantograph.strip_shapes
    state = np.append(np.linalg.lstsq(pantograph.stiffness, at_rest, rcond=None)[0], np.zeros(n))
    driven, held = (load[:-1] + load[1:]) @ drive.T, np.zeros(len(joints))
    states = [state]
    for part in driven:
        state = advance @ state + part + push @ held
        held = np.array(_solve_joints((rows @ state + offset).tolist(), own, bounds, held.tolist()))
        state = state + push @ held
        states.append(state)
    moved = np.array(states)[:, :n]
    return np.asarray(sum((moved * shape).sum(axis=1) for shape in shapes) / len(shapes))


def _shapes_at(strip: ContactStrip, lateral: Array) -> Array:
    """Displacement of a strip per unknown at lateral positions of the wire, (T, n) [-]."""
    return np.asarray(np.vander(lateral, len(strip.shape), increasing=True) @ strip.shape)


def _solve_joints(
    predicted: Sequence[float],
    compliance: Sequence[Sequence[float]],
    bounds: Sequence[tuple[float, float]],
    start: Sequence[float],
) -> list[float]:
    """Forces X = bounded(predicted + compliance X), from those of the last step [N]."""
    found = list(start)
    for _ in range(MOST_SWEEPS):
        change = 0.0
        for j, (lower, upper) in enumerate(bounds):
            others = sum(compliance[j][i] * found[i] for i in range(len(found)) if i != j)
            value = min(max((predicted[j] + others) / (1 - compliance[j][j]), lower), upper)
            change, found[j] = max(change, abs(value - found[j])), value
        if change <= REMAINDER_N:
            break
    return found

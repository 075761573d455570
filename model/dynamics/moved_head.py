"""Force that a linear pantograph exerts while its head is moved: the inverse of its step.

    z = q h + N y,   head . q = 1,   head N = 0:   the height h of the head is given, y are the other unknowns

    N' (M z'' + C z' + K z - force) = 0   gives y, by average acceleration
    F = q' (force - M z'' - C z' - K z)   is the contact force

Velocity and acceleration of the head are central differences, of second order. Each force is therefore one sample late.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space

from pantocheck.model.description.pantograph import Pantograph, equilibrium


class MovedHead:
    """Linear pantograph with one strip, whose head is moved from rest.

    Args:
        pantograph: Linear model.
        height: Height of the head at the start [m].
        time_step: Time between two samples [s].
    """

    def __init__(self, pantograph: Pantograph, height: float, time_step: float) -> None:
        head = pantograph.strip_shapes[0]
        self._dt, self._force = time_step, pantograph.force
        basis: NDArray[np.float64] = null_space(head[None])
        self._basis, self._reach = basis, head / (head @ head)
        self._matrices = (pantograph.stiffness, pantograph.damping, pantograph.mass)
        factors = (time_step**2 / 4, time_step / 2, 1.0)
        pairs = zip(factors, self._matrices, strict=True)
        self._inverse = np.linalg.inv(sum(factor * basis.T @ matrix @ basis for factor, matrix in pairs))
        rest = equilibrium(pantograph, height)[0]
        self._heights = [height, height]
        # Displacement, velocity and acceleration of the other unknowns.
        self._inner = [basis.T @ rest, np.zeros(basis.shape[1]), np.zeros(basis.shape[1])]

    def follow(self, height: float) -> float:
        """Contact force at the sample before, when the head has reached a height [m]."""
        before, last = self._heights
        dt, (x, v, a) = self._dt, self._inner
        motion = (last, (height - before) / (2 * dt), (height - 2 * last + before) / dt**2)
        predicted = (x + dt * v + dt**2 / 4 * a, v + dt / 2 * a)
        load = self._force - sum(K @ self._reach * h for K, h in zip(self._matrices, motion, strict=True))
        inner = self._matrices[0] @ self._basis @ predicted[0] + self._matrices[1] @ self._basis @ predicted[1]
        a = self._inverse @ (self._basis.T @ (load - inner))
        self._inner = [predicted[0] + dt**2 / 4 * a, predicted[1] + dt / 2 * a, a]
        self._heights = [last, height]
        own = sum(K @ self._basis @ y for K, y in zip(self._matrices, self._inner, strict=True))
        return float(self._reach @ (load - own))

"""Receptance of the head of a pantograph: its motion under a harmonic contact force."""

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.simulation.pantograph_model import build_pantograph


def head_receptance(file: PantographFile, omega: RealArray) -> NDArray[np.complex128]:
    """Displacement of the head over a force on the head, e_h (K + i w C - w^2 M)^-1 e_h.

    Args:
        file: Pantograph of the case.
        omega: Angular frequencies, (n,) [rad/s].

    Returns:
        Receptance, (n,) [m/N].
    """
    model, w = build_pantograph(file, 0.0, 0.0), omega[:, None, None]
    dynamic = model.stiffness + 1j * w * model.damping - w**2 * model.mass
    motion = np.linalg.solve(dynamic, model.head.astype(complex)[:, None])[..., 0]
    return np.asarray(motion @ model.head, dtype=np.complex128)

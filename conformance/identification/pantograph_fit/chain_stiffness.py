"""Dynamic stiffness of a chain of lumped masses at its head, and its derivatives, by recursion from the base.

        | D_n
      [m_n]
        | element B_n = k_n + s c_n
       ...
      [m_1]
        | element B_1            A_i = s^2 m_i + (B_i in series with A_{i-1}),   A_0 rigid,   D = A_n,   s = i omega
      ------ base

With the motions v_i under a unit motion of the head, the change of D by any parameter is v^T dZ v, with dZ the change
of the dynamic stiffness matrix.
"""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import ComplexArray, RealArray


@dataclass(frozen=True)
class ChainResponse:
    """Response of a chain at m frequencies."""

    stiffness: ComplexArray
    """Dynamic stiffness at the head, (m,) [N/m]."""
    motion: ComplexArray
    """Motion of each mass under a unit motion of the head, (n, m) [-]."""


def chain_response(values: RealArray, s: ComplexArray) -> ChainResponse:
    """Response of a chain.

    Args:
        values: Masses [kg], stiffnesses [N/m] and dampings [N s/m], base to head, (3, n).
        s: Frequencies i omega, (m,) [rad/s].

    Returns:
        Dynamic stiffness and motions.
    """
    n = values.shape[1]
    elements = values[1][:, None] + s * values[2][:, None]
    inertia = s**2 * values[0][:, None]
    ratio = np.empty((n, s.size), dtype=np.complex128)  # motion of the lower end of each element over the upper one
    ratio[0] = 0.0
    total = elements[0] + inertia[0]
    for i in range(1, n):
        ratio[i] = elements[i] / (elements[i] + total)
        total = inertia[i] + ratio[i] * total
    motion = np.ones((n, s.size), dtype=np.complex128)
    for i in range(n - 1, 0, -1):
        motion[i - 1] = ratio[i] * motion[i]
    return ChainResponse(np.asarray(total), motion)


def logarithmic_derivatives(response: ChainResponse, s: ComplexArray) -> ComplexArray:
    """Derivatives of ln D by the masses, stiffnesses and dampings.

    Args:
        response: Response of the chain.
        s: Frequencies i omega, (m,) [rad/s].

    Returns:
        Derivatives, in the order of `values` of `chain_response`, (3, n, m).
    """
    stretch = np.diff(response.motion, axis=0, prepend=0.0)
    by_stiffness = stretch**2 / response.stiffness
    return np.stack([s**2 * response.motion**2 / response.stiffness, by_stiffness, s * by_stiffness])

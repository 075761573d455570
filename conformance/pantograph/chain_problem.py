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
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import ComplexArray, RealArray


@dataclass(frozen=True)
class ChainResponse:
    """Response of a chain at m frequencies."""

    stiffness: ComplexArray
    """Dynamic stiffness at the head, (m,) [N/m]."""
    motion: ComplexArray
    """Motion of each mass under a unit motion of the head, (n, m) [-]."""


def chain_response(values: RealArray, s: ComplexArray) -> ChainResponse:
    """Response of a chain at frequencies s = i omega, (m,) [rad/s].

    The values are masses [kg], stiffnesses [N/m] and dampings [N s/m], base to head, (3, n).
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
    """Derivatives of ln D by the values of `chain_response`, in their order, (3, n, m); `s` as there."""
    stretch = np.diff(response.motion, axis=0, prepend=0.0)
    by_stiffness = stretch**2 / response.stiffness
    return np.stack([s**2 * response.motion**2 / response.stiffness, by_stiffness, s * by_stiffness])


# Least-squares problem of a chain: weighted residuals of the logarithm of the dynamic stiffness, and free parameters.
#
# Masses and stiffnesses enter by their logarithm, because their sizes are unknown; dampings are linear, because they
# may be zero.
SMALLEST_VALUES = (1e-3, 1e-3, 0.0)
"""Smallest mass [kg], stiffness [N/m] and damping [N s/m] of a fit."""

LARGEST_VALUES = (1e3, 1e8, 1e6)
"""Largest mass [kg], stiffness [N/m] and damping [N s/m] of a fit: more than any pantograph has."""


@dataclass(frozen=True)
class MeasuredStiffness:
    """Measured dynamic stiffness, of one or several responses one behind the other."""

    frequency: RealArray
    """Frequencies, (m,) [Hz]."""
    stiffness: ComplexArray
    """Dynamic stiffness, (m,) [N/m]."""
    weight: RealArray
    """Inverse standard deviations of the logarithm of the modulus and of the phase, (2, m) [1/rad]."""

    @property
    def s(self) -> ComplexArray:
        """Frequencies i omega [rad/s]."""
        return np.asarray(2j * np.pi * self.frequency, dtype=np.complex128)

    def select_rows(self, rows: NDArray[np.int64]) -> "MeasuredStiffness":
        """Part of the rows."""
        return MeasuredStiffness(self.frequency[rows], self.stiffness[rows], self.weight[:, rows])


@dataclass(frozen=True)
class ChainProblem:
    """Fit of a chain of n masses with some parameters fixed."""

    data: MeasuredStiffness
    """Measured responses."""
    fixed: RealArray
    """Fixed masses [kg], stiffnesses [N/m] and dampings [N s/m], (3, n); NaN: free."""

    @property
    def free(self) -> NDArray[np.bool_]:
        """Mask of the free parameters, (3, n)."""
        return np.isnan(self.fixed)

    @property
    def bounds(self) -> tuple[RealArray, RealArray]:
        """Lower and upper bounds of the free parameters, as the solver takes them."""
        shape = self.fixed.shape
        lower, upper = (np.broadcast_to(np.array(v)[:, None], shape) for v in (SMALLEST_VALUES, LARGEST_VALUES))
        return self.pack(lower), self.pack(upper)

    def pack(self, values: RealArray) -> RealArray:
        """Free parameters of the solver from the values of a chain, (3, n)."""
        packed = np.array(values, dtype=float)
        packed[:2] = np.log(packed[:2])
        return np.asarray(packed[self.free])

    def unpack(self, parameters: RealArray) -> RealArray:
        """Values of the chain, (3, n), from the free parameters of the solver."""
        values = np.zeros(self.fixed.shape)
        values[self.free] = parameters
        values[:2] = np.exp(values[:2])
        return np.where(self.free, values, self.fixed)

    def residuals(self, parameters: RealArray) -> RealArray:
        """Weighted residuals of the moduli, then of the phases."""
        deviation = np.log(chain_response(self.unpack(parameters), self.data.s).stiffness / self.data.stiffness)
        return np.concatenate([self.data.weight[0] * deviation.real, self.data.weight[1] * deviation.imag])

    def value_jacobian(self, values: RealArray) -> RealArray:
        """Derivatives of the residuals by the values of the free parameters, in their own units."""
        s = self.data.s
        derivatives = logarithmic_derivatives(chain_response(values, s), s)[self.free]
        return np.concatenate(
            [self.data.weight[0] * derivatives.real, self.data.weight[1] * derivatives.imag], axis=1
        ).T

    def jacobian(self, parameters: RealArray) -> RealArray:
        """Derivatives of the residuals by the free parameters of the solver."""
        values = self.unpack(parameters)
        scale = np.vstack([values[:2], np.ones(values.shape[1])])
        return self.value_jacobian(values) * scale[self.free]

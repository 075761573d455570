"""Equal columns for each channel of a block whose channels have correlated noise."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.drops.decay_kernel import stack_real_imaginary


@dataclass(frozen=True)
class ChannelColumns:
    """Columns that each of c channels has, in units of the noise.

    Column j of channel a has the number j c + a; rows are real, then imaginary parts of each line and channel. The
    products take a c-th of the time of those with the expanded array, and less storage.
    """

    columns: RealArray
    """Columns of a channel: real, then imaginary parts at the lines, (2 k, p)."""
    whitening: ComplexArray
    """Inverse of the triangular factor of the covariance of the channels at each line, (k, c, c)."""

    @cached_property
    def values(self) -> ComplexArray:
        """Columns of a channel at the lines, (k, p)."""
        k = self.whitening.shape[0]
        return np.asarray(self.columns[:k] + 1j * self.columns[k:])

    @cached_property
    def adjoint(self) -> ComplexArray:
        """Adjoint of the whitening, (k, c, c)."""
        return np.ascontiguousarray(self.whitening.conj().transpose(0, 2, 1))

    def expand(self) -> RealArray:
        """The columns as an array, (2 k c, p c)."""
        k, c = self.whitening.shape[:2]
        values = self.whitening[:, :, None, :] * self.values[:, None, :, None]
        return stack_real_imaginary(values).reshape(2 * k * c, -1)

    def multiply(self) -> RealArray:
        """Gram matrix, (p c, p c): C' diag(S_ab) C for the channels a and b, with the inverse S of the covariance."""
        (rows, p), c = self.columns.shape, self.whitening.shape[1]
        first, second = np.triu_indices(c)
        weight = (self.adjoint @ self.whitening)[:, first, second]
        weighted = stack_real_imaginary(weight[:, :, None] * self.values[:, None]).reshape(rows, -1)
        products = (self.columns.T @ weighted).reshape(p, first.size, p)
        gram = np.empty((p, c, p, c))
        gram[:, second, :, first] = products.transpose(1, 2, 0)
        gram[:, first, :, second] = products.transpose(1, 0, 2)
        return gram.reshape(p * c, p * c)

    def correlate(self, x: RealArray) -> RealArray:
        """Products of the columns with signals, (2 k c, v): (p c, v)."""
        k, c = self.whitening.shape[:2]
        parts = x.reshape(2, k, c, -1)
        unweighted = stack_real_imaginary(self.adjoint @ (parts[0] + 1j * parts[1]))
        return np.asarray((self.columns.T @ unweighted.reshape(2 * k, -1)).reshape(-1, x.shape[1]))

    def combine(self, coefficients: RealArray) -> RealArray:
        """Sums of the columns with coefficients, (p c, v): (2 k c, v)."""
        (k, c), v = self.whitening.shape[:2], coefficients.shape[1]
        parts = (self.columns @ coefficients.reshape(-1, c * v)).reshape(2, k, c, v)
        return stack_real_imaginary(self.whitening @ (parts[0] + 1j * parts[1])).reshape(2 * k * c, v)

    def spread(self, covariance: RealArray) -> ComplexArray:
        """Covariance of the channels at each line, (k, c, c), for that of the coefficients, (p c, p c)."""
        p, (k, c) = self.columns.shape[1], self.whitening.shape[:2]
        first, second = np.triu_indices(c)
        pairs = covariance.reshape(p, c, p, c)[:, first, :, second].transpose(1, 0, 2)
        parts = (self.columns @ pairs.reshape(p, -1)).reshape(2, k, first.size, p)
        own = np.einsum("ksp,kp->ks", parts[0] + 1j * parts[1], self.values.conj())
        spread = np.empty((k, c, c), dtype=np.complex128)
        spread[:, second, first], spread[:, first, second] = own.conj(), own
        return np.asarray(self.whitening @ spread @ self.adjoint)

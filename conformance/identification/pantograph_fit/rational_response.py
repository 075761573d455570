"""Rational function of s = i omega through a measured dynamic stiffness, by iterated linear least squares.

The dynamic stiffness of a chain of n masses is Q(s) / P(s), with the degrees 2 n and 2 n - 2. Each iteration solves
D P - Q = 0 with weights 1 / |D P| of the last one (Sanathanan and Koerner, 1963), which tends to the relative error.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import NDArray

from pantocheck.conformance.array_types import ComplexArray, RealArray

RATIONAL_ITERATIONS = 30
"""Iterations of the weights; they converge within ten."""


@dataclass(frozen=True)
class RationalResponse:
    """Rational dynamic stiffness Q(s) / P(s) in s over a reference frequency."""

    numerator: RealArray
    """Coefficients of Q, ascending, (2 n + 1,)."""
    denominator: RealArray
    """Coefficients of P, ascending, (2 n - 1,); the last one is 1."""
    reference: float
    """Reference angular frequency [rad/s]."""

    @property
    def free_head(self) -> RealArray:
        """Squared natural frequencies with a free head, over that of reference, ascending, (n,) ndarray."""
        return _squared_frequencies(self.numerator)

    @property
    def fixed_head(self) -> RealArray:
        """Squared natural frequencies with a fixed head, over that of reference, ascending, (n - 1,) ndarray."""
        return _squared_frequencies(self.denominator)


def fit_rational_response(frequency: RealArray, stiffness: ComplexArray, n: int) -> RationalResponse:
    """Fit the rational function of a chain of n masses.

    Args:
        frequency: Frequencies, (m,) [Hz].
        stiffness: Measured dynamic stiffness, (m,) [N/m].
        n: Number of masses.
    """
    reference = 2 * np.pi * float(np.sqrt(frequency.min() * frequency.max()))
    powers = (2j * np.pi * frequency / reference)[:, None] ** np.arange(2 * n + 1)
    unknown = np.hstack([powers, -stiffness[:, None] * powers[:, : 2 * n - 2]])
    known = stiffness * powers[:, 2 * n - 2]
    poles = np.ones(frequency.size, dtype=np.complex128)
    for _ in range(RATIONAL_ITERATIONS):
        weight = 1 / np.abs(stiffness * poles)
        coefficients = _solve_real(unknown * weight[:, None], known * weight)
        denominator = np.append(coefficients[2 * n + 1 :], 1.0)
        poles = powers[:, : 2 * n - 1] @ denominator
    return RationalResponse(coefficients[: 2 * n + 1], denominator, reference)


def _solve_real(matrix: NDArray[Any], right: NDArray[Any]) -> RealArray:
    """Real least-squares solution of a complex system, with columns of unit size."""
    rows = np.vstack([matrix.real, matrix.imag])
    scale = np.linalg.norm(rows, axis=0)
    return np.asarray(np.linalg.lstsq(rows / scale, np.concatenate([right.real, right.imag]))[0] / scale)


def _squared_frequencies(coefficients: RealArray) -> RealArray:
    """Products of the roots of a polynomial in pairs: conjugate ones, or neighbouring real ones."""
    sizes = np.sort(np.abs(polynomial.polyroots(coefficients)))
    return np.asarray(sizes[0::2] * sizes[1::2])

"""Elimination of the coefficients of many columns from a least-squares problem, and factors of the columns.

The Cholesky factor of the Gram matrix is the triangular factor R of columns = Q R. It takes a fraction of the time of
Householder's method, because it consists of matrix products. A second pass makes Q orthogonal to rounding, and two
refinements make a solution accurate to rounding, as long as the columns are not nearly dependent. Such columns are
left to Householder's method.

References:
    [1] Y. Yamamoto, Y. Nakatsukasa, Y. Yanagisawa, T. Fukaya, Roundoff error analysis of the CholeskyQR2 algorithm,
        Electronic Transactions on Numerical Analysis 44 (2015) 306-326.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
from scipy.linalg.blas import dtrsm
from scipy.linalg.lapack import dpotrs

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.drops.channel_columns import ChannelColumns

LEAST_DIAGONAL = 1e-5
"""Smallest diagonal entry of the factor of columns of unit length for which the Gram matrix is used [-].

The method holds up to a condition number of 1e8. The diagonal overestimates the smallest singular value, of columns
with a whitening twentyfold.
"""

REFINEMENTS = 2
"""Largest number of refinements of a solution; each reduces its error by 1e-16 times the squared condition number."""
LAST_CORRECTION = 1e-8
"""Correction over the solution, below which the next refinement would change rounding only [-]."""


@dataclass(frozen=True)
class StoredColumns:
    """Columns in an array, (n, m)."""

    columns: RealArray

    def expand(self) -> RealArray:
        """The columns as an array."""
        return self.columns

    def multiply(self) -> RealArray:
        """Gram matrix, (m, m)."""
        return np.asarray(self.columns.T @ self.columns)

    def correlate(self, x: RealArray) -> RealArray:
        """Products of the columns with signals, (n, c): (m, c)."""
        return np.asarray(self.columns.T @ x)

    def combine(self, coefficients: RealArray) -> RealArray:
        """Sums of the columns with coefficients, (m, c): (n, c)."""
        return np.asarray(self.columns @ coefficients)


Columns = StoredColumns | ChannelColumns
"""Columns of a least-squares problem, (n, m)."""


@dataclass(frozen=True)
class GramFactor:
    """Columns, (n, m), their lengths, (m,), and the upper factor of the Gram matrix of columns of unit length."""

    columns: Columns
    length: RealArray
    unit_upper: RealArray

    @property
    def upper(self) -> RealArray:
        """Upper triangular factor R of the columns, (m, m)."""
        return self.unit_upper * self.length

    @cached_property
    def inverse(self) -> RealArray:
        """Inverse of the Gram matrix, (m, m)."""
        inverse = dpotrs(self.unit_upper, np.eye(self.length.size))[0]
        return np.asarray(inverse / self.length / self.length[:, None])

    @property
    def log_determinant(self) -> float:
        """Logarithm of the determinant of the Gram matrix."""
        return float(2 * np.sum(np.log(self.unit_upper.diagonal() * self.length)))

    def solve(self, x: RealArray, passes: int) -> tuple[RealArray, RealArray]:
        """Coefficients, (m, c), and residual, (n, c), of signals; every pass after the first refines.

        After one pass, the error of the residual lies in the span of the columns, so that products of residuals have
        the square of its relative error. After 1 + `REFINEMENTS`, both are accurate to rounding.
        """
        length = self.length[:, None]
        residual, scaled = x, np.zeros((self.length.size, x.shape[1]))
        for _ in range(passes):
            correction = dpotrs(self.unit_upper, self.columns.correlate(residual) / length)[0]
            scaled += correction
            residual = x - self.columns.combine(scaled / length)
            if np.abs(correction).max(initial=0.0) < LAST_CORRECTION * np.abs(scaled).max(initial=0.0):
                break
        return scaled / length, residual


@dataclass(frozen=True)
class OrthogonalFactor:
    """Orthonormal basis, (n, m), and upper triangular factor, (m, m), of columns."""

    basis: RealArray
    upper: RealArray

    @cached_property
    def inverse(self) -> RealArray:
        """See `GramFactor`."""
        root = solve_factor(self.upper, np.eye(self.upper.shape[0]))
        return np.asarray(root @ root.T)

    @property
    def log_determinant(self) -> float:
        """See `GramFactor`."""
        return float(2 * np.sum(np.log(np.abs(self.upper.diagonal()))))

    def solve(self, x: RealArray, passes: int) -> tuple[RealArray, RealArray]:
        """See `GramFactor`; one pass is accurate, and coefficients of dependent columns have the smallest norm."""
        del passes
        projected = self.basis.T @ x
        return solve_factor(self.upper, projected), x - self.basis @ projected


Elimination = GramFactor | OrthogonalFactor
"""Factor of columns, (n, m) with n >= m, from which coefficients follow."""


def prepare_elimination(columns: Columns) -> Elimination:
    """Factor columns, by their Gram matrix unless they are nearly dependent."""
    try:
        return _factor_gram_matrix(columns)
    except np.linalg.LinAlgError:
        return OrthogonalFactor(*_factor_by_householder(columns.expand()))


def solve_least_squares(columns: RealArray, x: RealArray) -> tuple[RealArray, RealArray]:
    """Solve columns c = x, (n, m) and (n, c), by least squares: coefficients, (m, c), and residual, (n, c)."""
    return prepare_elimination(StoredColumns(columns)).solve(x, 1 + REFINEMENTS)


def factor_columns(columns: RealArray) -> tuple[RealArray, RealArray]:
    """Factor n >= m columns into an orthonormal basis Q, (n, m), and an upper triangular R, (m, m): columns = Q R."""
    try:
        first = _factor_gram_matrix(StoredColumns(columns))
        basis = _orthogonalise(columns, first.upper)
        second = _factor_gram_matrix(StoredColumns(basis))
    except np.linalg.LinAlgError:
        return _factor_by_householder(columns)
    return _orthogonalise(basis, second.upper), second.upper @ first.upper


def solve_factor(r: RealArray, projected: RealArray) -> RealArray:
    """Solve R c = b, (m, m) and (m, c), for an upper triangular factor; of dependent columns the smallest solution."""
    length = np.sqrt(np.einsum("ij,ij->j", r, r))
    if np.all(np.abs(r.diagonal()) > LEAST_DIAGONAL * length):
        return np.asarray(dtrsm(1.0, r, projected))
    return np.asarray(np.linalg.lstsq(r, projected, rcond=1e-13)[0])


def _factor_gram_matrix(columns: Columns) -> GramFactor:
    """Cholesky factor of the Gram matrix of columns; LinAlgError if they are nearly dependent or zero."""
    gram = columns.multiply()
    length = np.sqrt(gram.diagonal())
    if not np.all(length > 0):
        raise np.linalg.LinAlgError
    upper = np.linalg.cholesky(gram / length / length[:, None]).T
    if not np.all(upper.diagonal() > LEAST_DIAGONAL):
        raise np.linalg.LinAlgError
    return GramFactor(columns, np.asarray(length), np.asarray(upper))


def _orthogonalise(columns: RealArray, upper: RealArray) -> RealArray:
    """Basis of columns, (n, m): orthonormal up to rounding times the squared condition number."""
    return np.asarray(dtrsm(1.0, upper, columns.T, trans_a=1).T)


def _factor_by_householder(columns: RealArray) -> tuple[RealArray, RealArray]:
    q, r = scipy.linalg.qr(columns, mode="economic", check_finite=False)
    return q, r

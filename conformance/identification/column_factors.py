"""Factors of the columns of a least-squares problem, from their Gram matrix.

The Cholesky factor of the Gram matrix is the triangular factor R of columns = Q R. It takes a fraction of the time of
Householder's method, because it consists of matrix products. A second pass makes Q orthogonal to rounding, and two
refinements make a solution accurate to rounding, as long as the columns are not nearly dependent. Such columns are left
to Householder's method.

References:
    [1] Y. Yamamoto, Y. Nakatsukasa, Y. Yanagisawa, T. Fukaya, Roundoff error analysis of the CholeskyQR2 algorithm,
        Electronic Transactions on Numerical Analysis 44 (2015) 306-326.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from scipy.linalg.blas import dtrsm
from scipy.linalg.lapack import dpotrs

from pantocheck.conformance.array_types import RealArray

LEAST_DIAGONAL = 1e-6
"""Smallest diagonal entry of the factor of columns of unit length for which the Gram matrix is used [-].

The method holds up to a condition number of 1e8; the diagonal may overestimate the smallest singular value.
"""

REFINEMENTS = 2
"""Number of refinements of a solution; each reduces its error by 1e-16 times the squared condition number."""


@dataclass(frozen=True)
class Elimination:
    """Signals without their part in the span of columns."""

    coefficients: RealArray
    """Coefficients of the columns in x, (m, c); of dependent columns those with the smallest norm."""
    residual: RealArray
    """Residual of x, (n, c)."""
    remainder: RealArray
    """Residual of the other signals, (n, d)."""


def eliminate_columns(columns: RealArray, x: RealArray, others: RealArray) -> Elimination:
    """Subtract from signals their part in the span of columns.

    Args:
        columns: Columns, n >= m, (n, m).
        x: Signals whose coefficients and residual are accurate to rounding, (n, c).
        others: Signals whose coefficients are not needed, (n, d). Their solution is not refined: the error of the
            remainder lies in the span of the columns, so that products of remainders have the square of its relative
            error.

    Returns:
        Coefficients and residual of x, and remainder of the other signals.
    """
    try:
        factor = _factor_gram_matrix(columns)
    except np.linalg.LinAlgError:
        q, r = _factor_by_householder(columns)
        projected = q.T @ x
        return Elimination(solve_factor(r, projected), x - q @ projected, others - q @ (q.T @ others))
    coefficients, residual = factor.solve(x, 1 + REFINEMENTS)
    return Elimination(coefficients, residual, factor.solve(others, 1)[1])


def solve_least_squares(columns: RealArray, x: RealArray) -> tuple[RealArray, RealArray]:
    """Solve columns c = x by least squares.

    Args:
        columns: Columns, n >= m, (n, m).
        x: Right-hand sides, (n, c).

    Returns:
        Coefficients, (m, c); of dependent columns those with the smallest norm.
        Residual, (n, c).
    """
    solved = eliminate_columns(columns, x, np.zeros((x.shape[0], 0)))
    return solved.coefficients, solved.residual


def factor_columns(columns: RealArray) -> tuple[RealArray, RealArray]:
    """Factor columns into an orthonormal basis and a triangular matrix, columns = Q R.

    Args:
        columns: Columns, n >= m, (n, m).

    Returns:
        Orthonormal basis Q, (n, m).
        Upper triangular factor R, (m, m).
    """
    try:
        first = _factor_gram_matrix(columns)
        second = _factor_gram_matrix(first.orthogonalise())
    except np.linalg.LinAlgError:
        return _factor_by_householder(columns)
    return second.orthogonalise(), second.upper @ first.upper


def solve_factor(r: RealArray, projected: RealArray) -> RealArray:
    """Solve R c = b, (m, m) and (m, c), for an upper triangular factor; of dependent columns the smallest solution."""
    length = np.sqrt(np.einsum("ij,ij->j", r, r))
    if np.all(np.abs(r.diagonal()) > LEAST_DIAGONAL * length):
        return np.asarray(dtrsm(1.0, r, projected))
    return np.asarray(np.linalg.lstsq(r, projected, rcond=1e-13)[0])


@dataclass(frozen=True)
class _GramFactor:
    """Columns, (n, m), their lengths, (m,), and the upper factor of the Gram matrix of columns of unit length."""

    columns: RealArray
    length: RealArray
    unit_upper: RealArray

    @property
    def upper(self) -> RealArray:
        """Upper triangular factor R of the columns, (m, m)."""
        return self.unit_upper * self.length

    def orthogonalise(self) -> RealArray:
        """Basis of the columns, (n, m): orthonormal up to rounding times the squared condition number."""
        return np.asarray(dtrsm(1.0, self.upper, self.columns.T, trans_a=1).T)

    def solve(self, x: RealArray, passes: int) -> tuple[RealArray, RealArray]:
        """Coefficients, (m, c), and residual, (n, c), of right-hand sides x; every pass after the first refines."""
        length = self.length[:, None]
        residual, solution = x, np.zeros((self.columns.shape[1], x.shape[1]))
        for _ in range(passes):
            solution += dpotrs(self.unit_upper, self.columns.T @ residual / length)[0] / length
            residual = x - self.columns @ solution
        return solution, residual


def _factor_gram_matrix(columns: RealArray) -> _GramFactor:
    """Cholesky factor of the Gram matrix of columns; LinAlgError if they are nearly dependent or zero."""
    gram = columns.T @ columns
    length = np.sqrt(gram.diagonal())
    if not np.all(length > 0):
        raise np.linalg.LinAlgError
    upper = np.linalg.cholesky(gram / length / length[:, None]).T
    if not np.all(upper.diagonal() > LEAST_DIAGONAL):
        raise np.linalg.LinAlgError
    return _GramFactor(columns, np.asarray(length), np.asarray(upper))


def _factor_by_householder(columns: RealArray) -> tuple[RealArray, RealArray]:
    q, r = scipy.linalg.qr(columns, mode="economic", check_finite=False)
    return q, r

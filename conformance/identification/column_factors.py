"""Factors of the columns of a least-squares problem, from their Gram matrix.

The Cholesky factor of the Gram matrix is the triangular factor R of columns = Q R. It takes a fraction of the time of
Householder's method, because it consists of matrix products. A second pass makes Q orthogonal to rounding, and two
refinements make a solution accurate to rounding, as long as the columns are not nearly dependent. Such columns are left
to Householder's method.

References
----------
.. [1] Y. Yamamoto, Y. Nakatsukasa, Y. Yanagisawa, T. Fukaya, Roundoff error analysis of the CholeskyQR2 algorithm,
   Electronic Transactions on Numerical Analysis 44 (2015) 306-326.
"""

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


def factor_columns(columns: RealArray) -> tuple[RealArray, RealArray]:
    """Factor columns into an orthonormal basis and a triangular matrix, columns = Q R.

    Parameters
    ----------
    columns : (n, m) ndarray
        Columns, n >= m.

    Returns
    -------
    (n, m) ndarray
        Orthonormal basis Q.
    (m, m) ndarray
        Upper triangular factor R.
    """
    try:
        scaled, length = _scale(columns)
        first = _factor_gram_matrix(scaled)
        q = dtrsm(1.0, first.T, scaled.T, trans_a=1).T
        second = _factor_gram_matrix(q)
    except np.linalg.LinAlgError:
        q, r = scipy.linalg.qr(columns, mode="economic", check_finite=False)
        return q, r
    return dtrsm(1.0, second.T, q.T, trans_a=1).T, second.T @ first.T * length


def solve_factor(r: RealArray, projected: RealArray) -> RealArray:
    """Solve R c = b, (m, m) and (m, c), for an upper triangular factor; of dependent columns the smallest solution."""
    length = np.sqrt(np.einsum("ij,ij->j", r, r))
    if np.all(np.abs(r.diagonal()) > LEAST_DIAGONAL * length):
        return np.asarray(dtrsm(1.0, r, projected))
    return np.asarray(np.linalg.lstsq(r, projected, rcond=1e-13)[0])


def solve_least_squares(columns: RealArray, x: RealArray) -> RealArray:
    """Solve columns c = x by least squares.

    Parameters
    ----------
    columns : (n, m) ndarray
        Columns, n >= m.
    x : (n, c) ndarray
        Right-hand sides.

    Returns
    -------
    (m, c) ndarray
        Coefficients; of dependent columns those with the smallest norm.
    """
    try:
        scaled, length = _scale(columns)
        lower = _factor_gram_matrix(scaled)
    except np.linalg.LinAlgError:
        q, r = scipy.linalg.qr(columns, mode="economic", check_finite=False)
        return solve_factor(r, q.T @ x)
    solution = np.zeros((columns.shape[1], x.shape[1]))
    for _ in range(1 + REFINEMENTS):
        solution += dpotrs(lower.T, scaled.T @ (x - scaled @ solution))[0]
    return np.asarray(solution / length[:, None])


def _scale(columns: RealArray) -> tuple[RealArray, RealArray]:
    """Columns of unit length, and their lengths; LinAlgError if a column is zero."""
    length = np.sqrt(np.einsum("ij,ij->j", columns, columns))
    if not np.all(length > 0):
        raise np.linalg.LinAlgError
    return columns / length, length


def _factor_gram_matrix(columns: RealArray) -> RealArray:
    """Lower Cholesky factor of the Gram matrix of columns; LinAlgError if they are nearly dependent."""
    lower = np.linalg.cholesky(columns.T @ columns)
    if not np.all(lower.diagonal() > LEAST_DIAGONAL):
        raise np.linalg.LinAlgError
    return np.asarray(lower)

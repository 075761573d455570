"""Linear statics with prescribed displacements, on rows of beams that connectors couple at their stations."""

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.linalg import solveh_banded

from pantocheck.model.arrays import Array


def solve_with_prescribed_displacements(
    stiffness: sp.csr_array, load: Array, free: NDArray[np.bool_], prescribed: Array
) -> Array:
    """Solve K q = f for the free unknowns; a free unknown without stiffness stays at zero.

    The unknowns are solved station by station, all rows together: in this order the matrix is a narrow band.

    Args:
        stiffness: Stiffness matrix K, positive definite for the free unknowns, (n, n); n = 2 B S.
        load: Forces and moments f, (n,) [N, N m].
        free: Whether an unknown of B rows with S stations is free, (B, S, 2).
        prescribed: Values of the other unknowns, (n,) [m, -].

    Returns:
        All unknowns q, (n,) [m, -].
    """
    order = np.arange(free.size).reshape(free.shape).transpose(1, 0, 2).ravel()
    solution: Array = np.where(free.ravel(), 0.0, prescribed)
    active = order[(free.ravel() & (stiffness.diagonal() != 0))[order]]
    place = np.full(free.size, -1)
    place[active] = np.arange(active.size)
    entries = stiffness.tocoo()
    row, column = place[entries.row], place[entries.col]
    lower = (column >= 0) & (row >= column)
    distance, column = (row - column)[lower], column[lower]
    band = np.zeros((int(distance.max(initial=0)) + 1, active.size))
    np.add.at(band, (distance, column), entries.data[lower])
    solution[active] = solveh_banded(band, (load - stiffness @ solution)[active], lower=True, check_finite=False)
    return solution

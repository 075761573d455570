"""Linear statics with prescribed displacements."""

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from pantocheck.model.arrays import Array


def solve_with_prescribed_displacements(
    stiffness: sp.csr_array, load: Array, free: NDArray[np.bool_], prescribed: Array
) -> Array:
    """Solve K q = f for the free unknowns; a free unknown without stiffness stays at zero.

    Parameters
    ----------
    stiffness : (n, n) sparse array
        Stiffness matrix K.
    load : (n,) ndarray
        Forces and moments f [N, N m].
    free : (n,) ndarray of bool
        Whether an unknown is free.
    prescribed : (n,) ndarray
        Values of the other unknowns [m, -].

    Returns
    -------
    (n,) ndarray
        All unknowns q [m, -].
    """
    active = np.flatnonzero(free & (stiffness.diagonal() != 0))
    solution: Array = np.where(free, 0.0, prescribed)
    inner = sp.csc_array(stiffness[active][:, active])
    solution[active] = splu(inner).solve((load - stiffness @ solution)[active])
    return solution

"""Linear statics with some unknowns held at given values."""

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from pantocheck.model.arrays import Array


def solve_with_prescribed_displacements(
    stiffness: sp.csr_array, load: Array, free: NDArray[np.bool_], held: Array
) -> Array:
    """Solve K q = f for the free unknowns, the others held.

    Parameters
    ----------
    stiffness : sp.csr_array
        (n, n); an unknown without stiffness stays at zero.
    load : ndarray
        (n,).
    free : (n,) ndarray
        Which unknowns can move.
    held : (n,) ndarray
        Values of the others.

    Returns
    -------
    (n,) ndarray
        All unknowns.
    """
    active = np.flatnonzero(free & (stiffness.diagonal() != 0))
    solution: Array = np.where(free, 0.0, held)
    inner = sp.csc_array(stiffness[active][:, active])
    solution[active] = splu(inner).solve((load - stiffness @ solution)[active])
    return solution

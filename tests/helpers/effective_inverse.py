"""Inverse of the effective matrix from assembled sparse matrices."""

import numpy as np
from scipy.sparse.linalg import splu

from helpers.lines import Array
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.reference_kernel import remove_connectors
from pantocheck.model.statics.assembly import assemble_matrices, bandwidth_order, correct_mass


def inverse_of_assembled(line: DiscretisedLine, time_step: float) -> Array:
    """Inverse of M + dt/2 C + dt^2/4 K of the rows, indexed by (rows, stations, 2) twice; zero for fixed unknowns."""
    matrices = assemble_matrices(remove_connectors(line))
    effective = correct_mass(line, time_step) + time_step / 2 * matrices.damping + time_step**2 / 4 * matrices.stiffness
    order = bandwidth_order(line)[matrices.free]
    inverse = np.zeros((line.beams.free.size,) * 2)
    inverse[np.ix_(order, order)] = splu(effective.tocsc()).solve(np.eye(order.size))
    return inverse.reshape(line.beams.free.shape * 2)

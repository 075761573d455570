"""Effective matrix of a Newmark step: A = M + dt/2 C + dt^2/4 K, with the corrected mass of `mass_correction`."""

import numpy as np

from pantocheck.model.description.arrays import Array
from pantocheck.model.dynamics.block_tridiagonal import Factor, factorise_blocks
from pantocheck.model.fem import beam
from pantocheck.model.fem.beams import Beams, element_stiffness
from pantocheck.model.fem.mass_correction import mass_correction


def factorise(beams: Beams, time_step: float) -> Factor:
    """Block factors of A for all rows of beams and a time step [s]."""
    return factorise_blocks(*_effective_blocks(beams, time_step), beams.free)


def _effective_blocks(beams: Beams, time_step: float) -> tuple[Array, Array]:
    """Diagonal and sub-diagonal blocks of A, (B, S, 2, 2) each; fixed unknowns have the identity on the diagonal.

    Entry s of the sub-diagonal blocks couples station s to station s - 1.
    """
    rows, stations = beams.lumped_mass.shape
    diagonal, below = np.zeros((rows, stations, 2, 2)), np.zeros((rows, stations, 2, 2))
    half, quarter = time_step / 2, time_step**2 / 4
    for row in range(rows):
        mass_factor = 1 + half * beams.mass_coefficient[row]
        stiffness_factor = quarter + half * beams.stiffness_coefficient[row]
        element = mass_factor * beam.mass(beams.length, beams.mass_per_length[row])
        element += stiffness_factor * element_stiffness(beams, row) - mass_correction(beams, row, time_step)
        diagonal[row, :-1] += element[:, :2, :2]
        diagonal[row, 1:] += element[:, 2:, 2:]
        below[row, 1:] = element[:, 2:, :2]
    diagonal[:, :, 0, 0] += beams.lumped_mass + half * beams.lumped_damping + quarter * beams.lumped_stiffness
    fixed = ~beams.free
    for i in range(2):
        diagonal[fixed[:, :, i], i, :] = 0.0
        diagonal[fixed[:, :, i], :, i] = 0.0
        diagonal[fixed[:, :, i], i, i] = 1.0
        below[fixed[:, :, i], i, :] = 0.0
        below[:, 1:][fixed[:, :-1, i], :, i] = 0.0
    return diagonal, below

"""The mass that a time step works with, so that waves on the wires do not run late.

Average acceleration slows an oscillation of circular frequency w down by the share (w dt)^2 / 12: waves of 20 Hz and
more come back from droppers and supports late, and the smallest contact force, which they make, suffers first. The
step takes w for (2 / dt) tan(w dt / 2), whose square is w^2 (1 + (w dt)^2 / 6 + ...), so that M - dt^2/6 K in place of
M leaves an error of fourth order. Taken is only the string's share of K, with linear shape functions: bending matters
to waves too short to matter, and the mass must stay positive definite, for then the method is stable at any time step.
"""

import numpy as np

from pantocheck.model.arrays import Array
from pantocheck.model.fem import beam
from pantocheck.model.fem.beams import Beams

# An element's consistent mass less a multiple of its string stiffness is positive definite up to this times m h^2 / T:
# ends moving apart by one each feel at least a tenth of the element's mass, and 4 T / h of stiffness.
STABLE_SHARE = 1 / 40


def mass_correction(beams: Beams, row: int, time_step: float) -> Array:
    """What a time step takes off the mass of every element of one row.

    Parameters
    ----------
    beams : Beams
        The rows.
    row : int
        Which one.
    time_step : float
        [s].

    Returns
    -------
    (S-1, 4, 4) ndarray
        Matrices [kg]; less than dt^2/6 K where an element is shorter than 2.6 times the way of a wave in a step.
    """
    h, tension, mass_per_length = beams.length, beams.tension[row], beams.mass_per_length[row]
    # An element without a wire has neither tension nor mass.
    return beam.springs(np.minimum(time_step**2 / 6 * tension / h, STABLE_SHARE * mass_per_length * h))

"""Mass correction that removes the leading period error of the average-acceleration method.

Average acceleration replaces a circular frequency w by (2 / dt) tan(w dt / 2), so that waves of 20 Hz and more return
late from droppers and supports, by the share (w dt)^2 / 12. The mass M - dt^2/6 K in place of M turns the recurrence in
the displacements q of an undamped system into

    M (q+ - 2 q + q-) / dt^2 + K (q+ + 10 q + q-) / 12 = f

This is Newmark's method with gamma = 1/2, beta = 1/12, the Fox-Goodwin method, with a period error of fourth order. It
is stable for w dt < sqrt(6), as long as M - dt^2/6 K is positive definite (Hughes, The Finite Element Method, 1987).

Only the string part of K is corrected (linear shape functions): bending affects only waves too short to be of interest.
Where an element is too short for the stability bound, the correction is limited and the method stays stable.
"""

import numpy as np

from pantocheck.model.description.arrays import Array
from pantocheck.model.fem import beam
from pantocheck.model.fem.beams import Beams

STABLE_SHARE = 1 / 40
"""Largest correction as a share of m h^2 / T, for which the corrected mass of an element is positive definite.

For ends displaced by +1 and -1, the quadratic form of the mass is at least m h / 10, that of the string 4 T / h.
"""


def mass_correction(beams: Beams, row: int, time_step: float) -> Array:
    """Matrices that a time step [s] subtracts from the mass of the elements of one row, (S-1, 4, 4) [kg].

    dt^2/6 K of a string; less where an element is shorter than 2.6 times the path of a wave in one step.
    """
    h, tension, mass_per_length = beams.length, beams.tension[row], beams.mass_per_length[row]
    # An element without a wire has neither tension nor mass.
    return beam.springs(np.minimum(time_step**2 / 6 * tension / h, STABLE_SHARE * mass_per_length * h))

"""Motion of the line about its initial state."""

from typing import NamedTuple

import numpy as np

from pantocheck.model.arrays import Array
from pantocheck.model.statics.static_solver import Deflection


class Motion(NamedTuple):
    """State of the line; B rows, S stations, N connectors, J modes with modal damping, K held stretches.

    Parameters
    ----------
    w, r : (3, B, S) ndarray
        Deflection and slope: displacement, velocity, acceleration [m, -; per s; per s2].
    tension : (N,) ndarray
        Total tension of the connectors [N].
    modal : (J,) ndarray
        Damping forces on the modes with modal damping [N kg^-1/2].
    load : (1,) ndarray
        External load, upwards [N].
    additional_tension : (K,) ndarray
        Tensions of the held stretches less their tensions at rest [N].
    """

    w: Array
    r: Array
    tension: Array
    modal: Array
    load: Array
    additional_tension: Array


def motion_at_rest(deflection: Deflection, modes: int = 0, stretches: int = 0) -> Motion:
    """State of a line at rest in a static deflection.

    The first step determines the additional tensions; zero is a first guess.

    Parameters
    ----------
    deflection : Deflection
        Static deflection.
    modes, stretches : int
        Numbers of modes with modal damping and of held stretches.
    """
    w, r = (np.zeros((3, *deflection.displacement.shape[:2])) for _ in range(2))
    # Far from the loads the deflection decays to denormal numbers, which processors handle a hundred times slower.
    displacement = np.where(np.abs(deflection.displacement) < 1e-30, 0.0, deflection.displacement)
    w[0], r[0] = displacement[..., 0], displacement[..., 1]
    return Motion(w, r, deflection.tension.copy(), np.zeros(modes), np.zeros(1), np.zeros(stretches))

"""Cubic spline of an irregularity: its height has no kink, so that it excites no short waves of its own."""

import numpy as np

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.cubic_spline import evaluate_polynomials, fit_polynomials
from pantocheck.model.description.irregularity import Irregularity

NO_IRREGULARITY = Irregularity((0.0, 1.0), (0.0, 0.0))
"""Irregularity of a wire without one; adding its height changes no bit."""


def spline_polynomials(irregularity: Irregularity) -> Array:
    """Coefficients of the spline between neighbouring points, highest power of the distance first, (points - 1, 4)."""
    return fit_polynomials(np.array(irregularity.position), np.array(irregularity.height), "horizontal")


def irregularity_height(irregularity: Irregularity, position: Array) -> Array:
    """Compute the additional heights of a wire.

    Args:
        irregularity: Points of the irregularity.
        position: Positions along the track, (n,) [m].

    Returns:
        Heights, (n,) [m].
    """
    inside = np.clip(position, irregularity.position[0], irregularity.position[-1])
    return evaluate_polynomials(np.array(irregularity.position), spline_polynomials(irregularity), inside)

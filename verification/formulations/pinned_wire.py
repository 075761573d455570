"""Closed form of the natural frequencies of a wire."""

import numpy as np

from pantocheck.model.description.arrays import Array


def pinned_frequencies(
    n: int, length: float, tension: float, bending_stiffness: float, mass_per_length: float
) -> Array:
    """Natural frequencies of a pinned tensioned beam in closed form.

    Args:
        n: Number of modes.
        length: Length [m].
        tension: Tension T [N].
        bending_stiffness: Bending stiffness EI [N m2].
        mass_per_length: Mass per length [kg/m].

    Returns:
        Frequencies of the modes 1 to n, (n,) [Hz].
    """
    k = np.arange(1, n + 1) * np.pi / length
    return np.asarray(np.sqrt((tension * k**2 + bending_stiffness * k**4) / mass_per_length) / (2 * np.pi))

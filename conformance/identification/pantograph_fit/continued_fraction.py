"""Undamped chain from its natural frequencies with free and with fixed head, by a continued fraction.

With z = s^2, the dynamic stiffness of an undamped chain at mass i is

    A_i = m_i z + k_i - k_i^2 / (k_i + A_{i-1}),

so that a division of polynomials gives m_i and k_i, and its remainder A_{i-1} (Stieltjes).
"""

import numpy as np
from numpy.polynomial import polynomial

from pantocheck.conformance.array_types import RealArray


def expand_chain(head_mass: float, free_head: RealArray, fixed_head: RealArray) -> tuple[RealArray, RealArray]:
    """Masses and stiffnesses of an undamped chain.

    Args:
        head_mass: Mass of the head [kg].
        free_head: Squared angular frequencies with a free head, (n,) [rad2/s2].
        fixed_head: Squared angular frequencies with a fixed head, (n - 1,) [rad2/s2].

    Returns:
        Masses [kg] and stiffnesses [N/m], base to head, each (n,). They are positive if the frequencies alternate, and
        NaN if a frequency of one list is in the other.
    """
    numerator = head_mass * polynomial.polyfromroots(-free_head)
    denominator = polynomial.polyfromroots(-fixed_head)
    masses, stiffnesses = [], []
    with np.errstate(divide="ignore", invalid="ignore"):
        for _ in free_head:
            mass = numerator[-1] / denominator[-1]
            rest = numerator[:-1] - mass * np.append(0.0, denominator[:-1])
            stiffness = rest[-1] / denominator[-1]
            remainder = (rest - stiffness * denominator)[:-1]
            masses.append(mass)
            stiffnesses.append(stiffness)
            numerator = -stiffness * (stiffness * denominator + np.append(remainder, 0.0))
            denominator = remainder
    return np.array(masses[::-1]), np.array(stiffnesses[::-1])

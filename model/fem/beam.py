"""Tensioned Euler-Bernoulli beam: element matrices and closed forms.

      w1, r1                          w2, r2
        o-------------------------------o      w [m] deflection, r = dw/dx [-] slope
        |<------------- h ------------->|

The unknowns of an element are (w1, r1, w2, r2); cubic Hermite shape functions make w and dw/dx continuous.
"""

import numpy as np

from pantocheck.model.description.arrays import Array


def stiffness(h: float | Array, tension: float | Array, bending_stiffness: float | Array) -> Array:
    """Stiffness of elements, the integral of EI w''^2 + T w'^2.

    Args:
        h: Length of each element, (...) [m].
        tension: Tension T, (...) [N].
        bending_stiffness: Bending stiffness EI, (...) [N m2].

    Returns:
        Symmetric matrices, (..., 4, 4) [N/m, N, N m].
    """
    h = np.asarray(h, dtype=np.float64)
    bending = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]])
    string = np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]])
    return _element_matrices(bending_stiffness / h**3, bending, h) + _element_matrices(tension / (30 * h), string, h)


def mass(h: float | Array, mass_per_length: float | Array) -> Array:
    """Consistent mass of elements of length h [m], (..., 4, 4) [kg, kg m, kg m2]; mass per length in [kg/m]."""
    shares = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]])
    return _element_matrices(mass_per_length * h / 420, shares, h)


def _element_matrices(factor: float | Array, shares: Array, h: float | Array) -> Array:
    """Matrices `factor` times `shares`, in which every slope counts times the length h of the element."""
    h = np.asarray(h, dtype=np.float64)
    powers = np.stack((np.ones_like(h), h, h * h), axis=-1)[..., np.add.outer([0, 1, 0, 1], [0, 1, 0, 1])]
    return np.asarray(np.asarray(factor)[..., None, None] * (shares * powers))


def springs(stiffness: Array) -> Array:
    """Stiffness of springs, or linear strings, that join the ends of n elements, (n, 4, 4) [N/m]."""
    elongation = np.array([1.0, 0.0, -1.0, 0.0])
    return np.asarray(stiffness[:, None, None] * np.outer(elongation, elongation))


def uniform_load(h: Array, load_per_length: Array) -> Array:
    """Nodal forces (..., 4) of loads per length [N/m], consistent with the shape functions [N, N m]."""
    lever = np.stack([np.full_like(h, 6.0), h, np.full_like(h, 6.0), -h], axis=-1)
    return np.asarray((load_per_length * h / 12)[..., None] * lever)


def shape(s: float | Array, h: float | Array) -> Array:
    """Hermite shape functions: the deflection at a point is their product with (w1, r1, w2, r2).

    Args:
        s: Position within the element as a share of its length, 0 to 1, or n of them [-].
        h: Length of the element, or of each of n elements [m].

    Returns:
        Values of the four functions, (4,) or (4, n) [-, m, -, m].
    """
    return np.array([(1 + 2 * s) * (1 - s) ** 2, h * s * (1 - s) ** 2, s**2 * (3 - 2 * s), h * s**2 * (s - 1)])


def wave_speed(tension: float, mass_per_length: float) -> float:
    """Speed sqrt(T / m) of transverse waves on a wire without bending stiffness [m/s].

    Args:
        tension: Tension T [N].
        mass_per_length: Mass per length m [kg/m].
    """
    return float(np.sqrt(tension / mass_per_length))

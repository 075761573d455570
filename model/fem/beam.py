"""Tensioned Euler-Bernoulli beam: element matrices and closed forms.

      w1, r1                          w2, r2
        o-------------------------------o      w [m] deflection, r = dw/dx [-] slope
        |<------------- h ------------->|

The unknowns of an element are (w1, r1, w2, r2); cubic Hermite shape functions make w and dw/dx continuous.
"""

import numpy as np

from pantocheck.model.arrays import Array


def stiffness(h: float | Array, tension: float | Array, bending_stiffness: float | Array) -> Array:
    """Stiffness of elements, the integral of EI w''^2 + T w'^2.

    Parameters
    ----------
    h : float or ndarray
        Length of each element, (...) [m].
    tension : float or ndarray
        Tension T, (...) [N].
    bending_stiffness : float or ndarray
        Bending stiffness EI, (...) [N m2].

    Returns
    -------
    (..., 4, 4) ndarray
        Symmetric matrices [N/m, N, N m].
    """
    h = np.asarray(h, dtype=np.float64)
    one = np.ones_like(h)
    bending = np.array(
        [
            [12 * one, 6 * h, -12 * one, 6 * h],
            [6 * h, 4 * h**2, -6 * h, 2 * h**2],
            [-12 * one, -6 * h, 12 * one, -6 * h],
            [6 * h, 2 * h**2, -6 * h, 4 * h**2],
        ]
    )
    string = np.array(
        [
            [36 * one, 3 * h, -36 * one, 3 * h],
            [3 * h, 4 * h**2, -3 * h, -(h**2)],
            [-36 * one, -3 * h, 36 * one, -3 * h],
            [3 * h, -(h**2), -3 * h, 4 * h**2],
        ]
    )
    return _by_element(bending_stiffness / h**3 * bending + tension / (30 * h) * string)


def mass(h: float | Array, mass_per_length: float | Array) -> Array:
    """Consistent mass of elements.

    Parameters
    ----------
    h : float or ndarray
        Length of each element, (...) [m].
    mass_per_length : float or ndarray
        Mass per length, (...) [kg/m].

    Returns
    -------
    (..., 4, 4) ndarray
        Symmetric matrices [kg, kg m, kg m2].
    """
    h = np.asarray(h, dtype=np.float64)
    one = np.ones_like(h)
    shares = np.array(
        [
            [156 * one, 22 * h, 54 * one, -13 * h],
            [22 * h, 4 * h**2, 13 * h, -3 * h**2],
            [54 * one, 13 * h, 156 * one, -22 * h],
            [-13 * h, -3 * h**2, -22 * h, 4 * h**2],
        ]
    )
    return _by_element(mass_per_length * h / 420 * shares)


def springs(stiffness: Array) -> Array:
    """Stiffness of springs between the ends of the elements, as of strings with linear shape functions.

    Parameters
    ----------
    stiffness : (n,) ndarray
        Stiffness of each spring, T / h for a string [N/m].

    Returns
    -------
    (n, 4, 4) ndarray
        Symmetric matrices, zero for the slopes [N/m].
    """
    elongation = np.array([1.0, 0.0, -1.0, 0.0])
    return np.asarray(stiffness[:, None, None] * np.outer(elongation, elongation))


def _by_element(matrices: Array) -> Array:
    """Move the indices of the matrix to the end."""
    return np.moveaxis(matrices, (0, 1), (-2, -1))


def uniform_load(h: float, load_per_length: float) -> Array:
    """Nodal forces of a uniform load, consistent with the shape functions.

    Parameters
    ----------
    h : float
        Length of the element [m].
    load_per_length : float
        Load per length [N/m].

    Returns
    -------
    (4,) ndarray
        Forces and moments [N, N m].
    """
    return load_per_length * h / 12 * np.array([6, h, 6, -h])


def shape(s: float, h: float) -> Array:
    """Hermite shape functions: the deflection at a point is their product with (w1, r1, w2, r2).

    Parameters
    ----------
    s : float
        Position within the element as a share of its length, 0 to 1 [-].
    h : float
        Length of the element [m].

    Returns
    -------
    (4,) ndarray
        Values of the four functions [-, m, -, m].
    """
    return np.array([(1 + 2 * s) * (1 - s) ** 2, h * s * (1 - s) ** 2, s**2 * (3 - 2 * s), h * s**2 * (s - 1)])


def pinned_frequencies(
    n: int, length: float, tension: float, bending_stiffness: float, mass_per_length: float
) -> Array:
    """Natural frequencies of a pinned tensioned beam, modes 1 to n (closed form).

    Parameters
    ----------
    n : int
        Number of modes.
    length : float
        Length of the beam [m].
    tension : float
        Tension T [N].
    bending_stiffness : float
        Bending stiffness EI [N m2].
    mass_per_length : float
        Mass per length m [kg/m].

    Returns
    -------
    (n,) ndarray
        Frequencies [Hz].
    """
    k = np.arange(1, n + 1) * np.pi / length
    return np.asarray(np.sqrt((tension * k**2 + bending_stiffness * k**4) / mass_per_length) / (2 * np.pi))


def wave_speed(tension: float, mass_per_length: float) -> float:
    """Speed of transverse waves on a wire without bending stiffness: sqrt(T / m).

    Parameters
    ----------
    tension : float
        Tension T [N].
    mass_per_length : float
        Mass per length m [kg/m].

    Returns
    -------
    float
        Wave speed [m/s].
    """
    return float(np.sqrt(tension / mass_per_length))

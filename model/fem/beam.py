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
        (...) length of each element [m].
    tension : float or ndarray
        (...) axial tension T [N].
    bending_stiffness : float or ndarray
        (...) EI [N m2].

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
        (...) length of each element [m].
    mass_per_length : float or ndarray
        (...) [kg/m].

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
    """Elements that only pull their ends together, as strings with linear shape functions do; slopes are free.

    Parameters
    ----------
    stiffness : (n,) ndarray
        Of each element, T / h for a string [N/m].

    Returns
    -------
    (n, 4, 4) ndarray
        Symmetric matrices [N/m].
    """
    apart = np.array([1.0, 0.0, -1.0, 0.0])
    return np.asarray(stiffness[:, None, None] * np.outer(apart, apart))


def _by_element(matrices: Array) -> Array:
    """The indices of the matrix last."""
    return np.moveaxis(matrices, (0, 1), (-2, -1))


def uniform_load(h: float, load_per_length: float) -> Array:
    """Nodal forces of a uniform load, consistent with the shape functions.

    Parameters
    ----------
    h : float
        Length of the element [m].
    load_per_length : float
        [N/m].

    Returns
    -------
    (4,) ndarray
        [N, N m].
    """
    return load_per_length * h / 12 * np.array([6, h, 6, -h])


def shape(s: float, h: float) -> Array:
    """Hermite shape functions: the deflection at a point is their product with (w1, r1, w2, r2).

    Parameters
    ----------
    s : float
        Place within the element as a share of its length, 0 to 1 [-].
    h : float
        Length of the element [m].

    Returns
    -------
    (4,) ndarray
        [-, m, -, m].
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
        [m].
    tension : float
        T [N].
    bending_stiffness : float
        EI [N m2].
    mass_per_length : float
        [kg/m].

    Returns
    -------
    (n,) ndarray
        [Hz].
    """
    k = np.arange(1, n + 1) * np.pi / length
    return np.asarray(np.sqrt((tension * k**2 + bending_stiffness * k**4) / mass_per_length) / (2 * np.pi))


def wave_speed(tension: float, mass_per_length: float) -> float:
    """Speed of transverse waves on the wire, bending left out: sqrt(T / m).

    Parameters
    ----------
    tension : float
        T [N].
    mass_per_length : float
        [kg/m].

    Returns
    -------
    float
        [m/s].
    """
    return float(np.sqrt(tension / mass_per_length))

"""Residual flexibility of an element under a point force, which cubic shape functions cannot represent.

A wire bends sharply under a pantograph; a cubic polynomial per element does not. The difference is static at all
frequencies of interest and acts in series with the contact stiffness. It is the deflection of an element with both ends
clamped under a unit force, by Ritz's method with three bubble functions s^2 (1 - s)^2 (2 s - 1)^i, i = 0, 1, 2, which
are condensed statically. Without it the contact is too stiff, mostly at mid-element, and the force between 20 and 50 Hz
converges slowly with the element length. The coupling of bubble and cubic functions through the tension is neglected:
it vanishes with the square of the element length.
"""

import numpy as np
from numba import njit
from numpy.polynomial import Polynomial

from pantocheck.model.arrays import Array
from pantocheck.model.fem.beams import Beams

FUNCTIONS = 3


def condensed_bubbles(h: float, tension: float, bending_stiffness: float) -> Array:
    """Flexibility of the bubble functions of one element, (6,): inverse of their stiffness [m/N].

    The entries are (i, j) = 00, 01, 02, 11, 12, 22; parameters as in `beam.stiffness`.
    """
    if bending_stiffness == 0.0:
        return np.zeros(6)  # a string has a kink under a force, which no smooth function represents
    s = Polynomial([0, 1])
    functions = [s**2 * (1 - s) ** 2 * (2 * s - 1) ** i for i in range(FUNCTIONS)]
    stiffness = np.array(
        [
            [
                bending_stiffness / h**3 * _integral(a.deriv(2) * b.deriv(2))
                + tension / h * _integral(a.deriv() * b.deriv())
                for b in functions
            ]
            for a in functions
        ]
    )
    return np.asarray(np.linalg.inv(stiffness)[np.triu_indices(FUNCTIONS)])


def element_bubbles(beams: Beams, row: int) -> Array:
    """Flexibilities of all elements of one row, (S-1, 6); equal elements are computed once [m/N]."""
    known: dict[tuple[float, float, float], Array] = {}
    bubbles = np.zeros((beams.length.size, 6))
    for e in np.flatnonzero(beams.mass_per_length[row]):
        data = (float(beams.length[e]), float(beams.tension[row, e]), float(beams.bending_stiffness[row, e]))
        key = (round(data[0], 9), *data[1:])
        if key not in known:
            known[key] = condensed_bubbles(*data)
        bubbles[e] = known[key]
    return bubbles


def _integral(polynomial: Polynomial) -> float:
    """Integral of a polynomial from 0 to 1."""
    antiderivative = polynomial.integ()
    return float(antiderivative(1.0) - antiderivative(0.0))


@njit(cache=True)
def local_flexibility(bubble: Array, s: float) -> float:
    """Deflection per force at the share s of the length of an element with clamped ends [m/N].

    `bubble` is the flexibility of its bubble functions, from `condensed_bubbles`.
    """
    f = s * s * (1 - s) * (1 - s)
    t = 2 * s - 1
    g, h = f * t, f * t * t
    squares = bubble[0] * f * f + bubble[3] * g * g + bubble[5] * h * h
    return float(squares + 2 * (bubble[1] * f * g + bubble[2] * f * h + bubble[4] * g * h))

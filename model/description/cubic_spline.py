"""Cubic splines through points, as arrays of polynomials.

`scipy.interpolate` has the same functions, but its import takes longer than the splines of a run. A test compares both.
"""

from typing import Literal

import numpy as np
import scipy

from pantocheck.model.description.arrays import Array

Ends = Literal["not a knot", "horizontal"]
"""not a knot: the two polynomials next to an end are one; horizontal: slope zero at both ends."""


def fit_polynomials(x: Array, y: Array, ends: Ends) -> Array:
    """Polynomials of a cubic spline between neighbouring points.

    Args:
        x: Places in increasing order, (n,); at least four, or two with horizontal ends.
        y: Values, (n,).
        ends: Condition at both ends.

    Returns:
        Coefficients of the powers 3, 2, 1 and 0 of the distance from the left point, (n - 1, 4).
    """
    step = np.diff(x)
    slope = np.diff(y) / step
    # Continuous second derivatives: equations for the slopes at the points (de Boor 1978, chapter IV).
    banded, right = np.zeros((3, x.size)), np.zeros(x.size)
    banded[1, 1:-1] = 2 * (step[:-1] + step[1:])
    banded[0, 2:], banded[2, :-2] = step[:-1], step[1:]
    right[1:-1] = 3 * (step[1:] * slope[:-1] + step[:-1] * slope[1:])
    if ends == "horizontal":
        banded[1, 0] = banded[1, -1] = 1.0
    else:
        for end, inner, near, far, side in ((0, 1, 0, 1, 0), (-1, -2, -1, -2, 2)):
            length = step[near] + step[far]
            banded[1, end], banded[side, inner] = step[far], length
            weighted = (step[near] + 2 * length) * step[far] * slope[near] + step[near] ** 2 * slope[far]
            right[end] = weighted / length
    slopes = scipy.linalg.solve_banded((1, 1), banded, right)
    bend = (slopes[:-1] + slopes[1:] - 2 * slope) / step
    return np.column_stack([bend / step, (slope - slopes[:-1]) / step - bend, slopes[:-1], y[:-1]])


def evaluate_polynomials(x: Array, polynomials: Array, places: Array) -> Array:
    """Values of a spline; beyond the ends, of the polynomials there.

    Args:
        x: Places of the points, (n,).
        polynomials: Result of `fit_polynomials`.
        places: Places of the values, (k,).

    Returns:
        Values, (k,).
    """
    piece = np.clip(np.searchsorted(x, places, side="right") - 1, 0, x.size - 2)
    distance = places - x[piece]
    cubic, square, linear, constant = polynomials[piece].T
    return np.asarray(((cubic * distance + square) * distance + linear) * distance + constant)

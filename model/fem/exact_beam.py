"""Tensioned Euler-Bernoulli beam: exact static stiffness, with the unknowns (w1, r1, w2, r2) of `beam`.

Without load between its ends the beam has the deflection w = a + b x + c cosh(kx) + d sinh(kx), k^2 = T / EI.
"""

import numpy as np

from pantocheck.model.arrays import Array
from pantocheck.model.fem import beam

SHORT = 0.05
"""Length k h [-] below which cubic functions replace the closed form.

Their relative error there is 3e-9, and the closed form loses digits.
"""


def exact_stiffness(h: Array, tension: Array, bending_stiffness: Array) -> Array:
    """Exact static stiffness of tensioned beams.

    A string has no stiffness against slopes; a unit stiffness there keeps matrices regular and carries no force.

    Args:
        h: Lengths, (...) [m].
        tension: Tension T, (...) [N].
        bending_stiffness: Bending stiffness EI, (...) [N m2].

    Returns:
        Symmetric matrices, (..., 4, 4) [N/m, N, N m].
    """
    string = np.zeros((*h.shape, 4, 4))
    string[..., 1, 1] = string[..., 3, 3] = 1.0
    string[..., 0, 0] = string[..., 2, 2] = tension / h
    string[..., 0, 2] = string[..., 2, 0] = -tension / h
    stiff = np.where(bending_stiffness > 0, bending_stiffness, 1.0)
    k = np.sqrt(tension / stiff)
    z = k * h
    # Numerators and denominator are divided by cosh z, which overflows.
    tanh, sech = np.tanh(z), 1 / np.cosh(np.minimum(z, 300.0))
    denominator = 2 * (sech - 1) + z * tanh
    with np.errstate(divide="ignore", invalid="ignore"):
        force = stiff * k**3 * tanh / denominator
        mixed = stiff * k**2 * (1 - sech) / denominator
        near = stiff * k * (z - tanh) / denominator
        far = stiff * k * (tanh - z * sech) / denominator
    rows = [
        [force, mixed, -force, mixed],
        [mixed, near, -mixed, far],
        [-force, -mixed, force, -mixed],
        [mixed, far, -mixed, near],
    ]
    exact = np.moveaxis(np.array(rows), (0, 1), (-2, -1))
    short = (z < SHORT)[..., None, None]
    exact = np.where(short, beam.stiffness(h, tension, bending_stiffness), exact)
    return np.where((bending_stiffness > 0)[..., None, None], exact, string)

"""Static checks of a line: elasticity, working height, wave propagation."""

import numpy as np

from pantocheck.model.arrays import Array
from pantocheck.model.discretised_line import DiscretisedLine
from pantocheck.model.fem.assembly import point_load
from pantocheck.model.statics.static_solver import StaticSolver


def static_uplift(line: DiscretisedLine, position: Array, force: float) -> Array:
    """Uplift of the contact wire under a static force at each place in turn, droppers slackening as they do.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.
    position : (n,) ndarray
        [m].
    force : float
        Upwards, shared by the contact wires [N].

    Returns
    -------
    (n,) ndarray
        Uplift where the force acts, the mean over the contact wires [m].
    """
    statics = StaticSolver(line)
    rows = line.contact_rows
    uplift = np.empty(len(position))
    for i, x in enumerate(position):
        at = [point_load(line, row, float(x)) for row in rows]
        displacement = statics.deflection(force / len(rows) * np.sum(at, axis=0)).displacement
        flat = displacement.transpose(1, 0, 2).ravel()
        uplift[i] = np.mean([share @ flat for share in at])
    return uplift


def non_uniformity(elasticity: Array) -> float:
    """Non-uniformity of the elasticity along a span: (max - min) / (max + min).

    Parameters
    ----------
    elasticity : (n,) ndarray
        Along a span, in any unit.

    Returns
    -------
    float
        [-].
    """
    return float((elasticity.max() - elasticity.min()) / (elasticity.max() + elasticity.min()))

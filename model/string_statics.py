"""String statics: the line at rest with the bending of its wires left out, as dropper tables are computed by hand.

A string element carries no moment; its nodal deflections under uniform and nodal loads are exact whatever its length,
so that the stations at the connectors are enough.
"""

import math
from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from pantocheck.model.beams import Beams, build_beams
from pantocheck.model.catenary import Catenary
from pantocheck.model.initial_state import InitialState, initial_state
from pantocheck.model.mesh import build_mesh

Array = NDArray[np.float64]


def string_state(catenary: Catenary) -> InitialState:
    """The line at rest, its wires strings, in the vertical plane.

    Parameters
    ----------
    catenary : the line; staggers are left out

    Returns
    -------
    its state at the places of its connectors

    Raises
    ------
    NoInitialState : the prescribed geometry has no equilibrium
    """
    vertical = in_vertical_plane(catenary)
    mesh = build_mesh(vertical, math.inf)
    return initial_state(vertical, mesh, build_beams(vertical, mesh), string_stiffness)


def in_vertical_plane(catenary: Catenary) -> Catenary:
    """The same line without staggers."""
    return replace(catenary, wires=tuple(replace(wire, stagger=None) for wire in catenary.wires))


def string_stiffness(beams: Beams, row: int) -> sp.csr_array:
    """Stiffness of the wires of one row as strings; the slopes have none.

    Parameters
    ----------
    beams : the rows
    row : which one

    Returns
    -------
    (2 S, 2 S) with unknowns (w, r) by station [N/m]
    """
    present = np.flatnonzero(beams.mass_per_length[row])
    k = beams.tension[row, present] / beams.length[present]
    left, right = 2 * present, 2 * present + 2
    values = np.concatenate([k, k, -k, -k])
    place = (np.concatenate([left, right, left, right]), np.concatenate([left, right, right, left]))
    size = 2 * beams.free.shape[1]
    return sp.csr_array((values, place), shape=(size, size))

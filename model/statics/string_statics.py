"""String statics: the line at rest with the bending of its wires left out, as dropper tables are computed by hand.

A string element carries no moment; its nodal deflections under uniform and nodal loads are exact whatever its length,
so that the stations at the connectors are enough.
"""

import math
from dataclasses import replace

import scipy.sparse as sp

from pantocheck.model.catenary import Catenary
from pantocheck.model.fem import beam
from pantocheck.model.fem.beams import Beams, build_beams, by_station
from pantocheck.model.fem.mesh import build_mesh
from pantocheck.model.statics.initial_state import InitialState, compute_initial_state


def string_state(catenary: Catenary) -> InitialState:
    """The line at rest, its wires strings, in the vertical plane.

    Parameters
    ----------
    catenary : Catenary
        The line; staggers are left out.

    Returns
    -------
    InitialState
        Its state at the places of its connectors.

    Raises
    ------
    NoInitialState
        The prescribed geometry has no equilibrium.
    """
    vertical = in_vertical_plane(catenary)
    mesh = build_mesh(vertical, math.inf)
    return compute_initial_state(vertical, mesh, build_beams(vertical, mesh), string_stiffness)


def in_vertical_plane(catenary: Catenary) -> Catenary:
    """The same line without staggers."""
    return replace(catenary, wires=tuple(replace(wire, stagger=None) for wire in catenary.wires))


def string_stiffness(beams: Beams, row: int) -> sp.csr_array:
    """Stiffness of the wires of one row as strings; the slopes have none.

    Parameters
    ----------
    beams : Beams
        The rows.
    row : int
        Which one.

    Returns
    -------
    sp.csr_array
        (2 S, 2 S) with unknowns (w, r) by station [N/m].
    """
    return by_station(beam.springs(beams.tension[row] / beams.length))

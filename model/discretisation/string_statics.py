"""String statics: the line at rest without bending stiffness, as dropper tables are computed by hand.

A string element carries no moment. Its nodal deflections under uniform and nodal loads are exact for any length, so
that stations at the connectors are sufficient.
"""

import math
from dataclasses import replace

import scipy  # loads its parts when they are used

from pantocheck.model.description.catenary import Catenary
from pantocheck.model.discretisation.initial_state import InitialState, compute_initial_state
from pantocheck.model.fem import beam
from pantocheck.model.fem.beams import Beams, assemble_row, build_beams
from pantocheck.model.fem.mesh import build_mesh


def compute_string_state(catenary: Catenary) -> InitialState:
    """Compute the line at rest with its wires as strings, in the vertical plane.

    Args:
        catenary: Line; its staggers are ignored.

    Returns:
        State at the positions of the connectors.

    Raises:
        NoInitialState: The prescribed geometry has no equilibrium.
    """
    vertical = remove_staggers(catenary)
    mesh = build_mesh(vertical, math.inf)
    return compute_initial_state(vertical, mesh, build_beams(vertical, mesh), _string_stiffness)


def remove_staggers(catenary: Catenary) -> Catenary:
    """Remove the staggers of a line."""
    return replace(catenary, wires=tuple(replace(wire, stagger=None) for wire in catenary.wires))


def _string_stiffness(beams: Beams, row: int) -> "scipy.sparse.csr_array":
    """Stiffness of the wires of one row as strings; the slopes have no stiffness."""
    return assemble_row(beam.springs(beams.tension[row] / beams.length))

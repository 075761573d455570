"""From the description of a line to finite elements at rest."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from pantocheck.model.catenary import Catenary, Kind, Rayleigh
from pantocheck.model.fem.beams import Beams, build_beams
from pantocheck.model.fem.connectors import Connectors, add_lumped, build_connectors
from pantocheck.model.fem.mesh import Mesh, build_mesh
from pantocheck.model.statics.initial_state import InitialState, compute_initial_state


@dataclass(frozen=True)
class DiscretisedLine:
    """A line in finite elements, at rest.

    Parameters
    ----------
    catenary : Catenary
        What it was made from.
    mesh : Mesh
        Stations and rows.
    beams : Beams
        Rows of beams with everything lumped onto them.
    connectors : Connectors
        Droppers and clamps.
    state : InitialState
        Initial state.
    """

    catenary: Catenary
    mesh: Mesh
    beams: Beams
    connectors: Connectors
    state: InitialState

    @property
    def contact_rows(self) -> list[int]:
        """Rows of the contact wires' vertical field."""
        return [self.mesh.row_of[wire.name, "z"] for wire in self.catenary.contact_wires]


def discretise(catenary: Catenary, element_length: float, places: tuple[float, ...] = ()) -> DiscretisedLine:
    """Finite elements and initial state of a line.

    Parameters
    ----------
    catenary : Catenary
        The line.
    element_length : float
        Longest element [m].
    places : tuple[float, ...]
        Where stations are wanted besides those the line itself needs, as for loads and sensors [m].

    Returns
    -------
    DiscretisedLine
        The discretised line.

    Raises
    ------
    NoInitialState
        The prescribed geometry has no equilibrium.
    """
    mesh = build_mesh(catenary, element_length, places)
    beams = build_beams(catenary, mesh)
    state = compute_initial_state(catenary, mesh, beams)
    add_lumped(catenary, mesh, beams)
    return DiscretisedLine(catenary, mesh, beams, build_connectors(catenary, mesh, state), state)


def with_damping(line: DiscretisedLine, damping: Mapping[Kind, Rayleigh]) -> DiscretisedLine:
    """The same line with other damping; its initial state does not depend on it.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.
    damping : Mapping[Kind, Rayleigh]
        By kind of component.

    Returns
    -------
    DiscretisedLine
        The line with that damping.
    """
    catenary = replace(line.catenary, damping=dict(damping))
    beams = build_beams(catenary, line.mesh)
    add_lumped(catenary, line.mesh, beams)
    return replace(line, catenary=catenary, beams=beams, connectors=build_connectors(catenary, line.mesh, line.state))


def never_slack(line: DiscretisedLine) -> DiscretisedLine:
    """The same line with droppers that push as well as they pull: wrong, and a measure of what slackening does."""
    connectors = line.connectors._replace(unilateral=np.zeros_like(line.connectors.unilateral))
    return replace(line, connectors=connectors)

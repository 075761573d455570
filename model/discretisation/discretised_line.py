"""Discretised line: finite elements of a line in its initial state."""

import math
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field, replace
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar

import numpy as np

from pantocheck.model.description.catenary import Catenary, Kind, Rayleigh
from pantocheck.model.discretisation.connectors import Connectors, build_connectors
from pantocheck.model.discretisation.initial_state import InitialState, compute_initial_state
from pantocheck.model.fem.beams import Beams, build_beams
from pantocheck.model.fem.held_stretches import HeldStretches, build_held_stretches
from pantocheck.model.fem.mesh import Mesh, build_mesh


@dataclass(frozen=True)
class DiscretisedLine:
    """Finite elements of a line in its initial state."""

    catenary: Catenary
    """Description of the line."""
    mesh: Mesh
    """Stations and rows."""
    beams: Beams
    """Rows of beams with lumped parts."""
    connectors: Connectors
    """Droppers and clamps."""
    state: InitialState
    """Line at rest."""
    stretches: HeldStretches
    """Stretches of wires that are held along the track."""
    kept: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False, compare=False)
    """Results that the simulations of the line share (`keep_with_line`); a changed line begins without any."""

    @property
    def contact_rows(self) -> list[int]:
        """Rows of the vertical deflection of the contact wires, each once."""
        return list(dict.fromkeys(self.mesh.row_of[wire.name, "z"] for wire in self.catenary.contact_wires))


def discretise(catenary: Catenary, element_length: float, places: tuple[float, ...] = ()) -> DiscretisedLine:
    """Divide a line into finite elements and compute its initial state.

    Args:
        catenary: Description of the line.
        element_length: Largest length of an element [m].
        places: Positions of additional stations, for example for loads and sensors [m].

    Returns:
        Line at rest.

    Raises:
        NoInitialState: The prescribed geometry has no equilibrium.
    """
    mesh = build_mesh(catenary, element_length, places)
    return _build_line(catenary, mesh, build_beams(catenary, mesh))


def with_properties(line: DiscretisedLine, catenary: Catenary) -> DiscretisedLine:
    """Line on the mesh of another one, of a catenary with wires and parts at the same places but other properties."""
    return _build_line(catenary, line.mesh, build_beams(catenary, line.mesh, line.beams))


def _build_line(catenary: Catenary, mesh: Mesh, beams: Beams) -> DiscretisedLine:
    state = compute_initial_state(catenary, mesh, beams)
    connectors = build_connectors(catenary, mesh, beams, state)
    stretches = build_held_stretches(catenary, mesh, state.deflection)
    return DiscretisedLine(catenary, mesh, beams, connectors, state, stretches)


def max_wave_speed(line: DiscretisedLine) -> float:
    """Upper bound of the speed of all waves of interest on any wire [m/s].

    Bending makes short waves faster: 10 % above sqrt(T / m) is sufficient up to about 60 Hz on a contact wire.
    """
    present = line.beams.mass_per_length > 0
    return 1.1 * math.sqrt(float(np.max(line.beams.tension[present] / line.beams.mass_per_length[present])))


def with_damping(line: DiscretisedLine, damping: Mapping[Kind, Rayleigh]) -> DiscretisedLine:
    """Replace the damping of a line; its initial state does not depend on it."""
    catenary = replace(line.catenary, damping=dict(damping))
    beams = build_beams(catenary, line.mesh, line.beams)
    connectors = build_connectors(catenary, line.mesh, beams, line.state)
    return replace(line, catenary=catenary, beams=beams, connectors=connectors)


def make_droppers_bilateral(line: DiscretisedLine) -> DiscretisedLine:
    """Make the droppers bilateral, so that they push as well as pull: the difference is the effect of slackening.

    Args:
        line: Line with unilateral droppers; it is not changed.
    """
    connectors = line.connectors._replace(unilateral=np.zeros_like(line.connectors.unilateral))
    return replace(line, connectors=connectors)


def keep_viscous_part(line: DiscretisedLine) -> DiscretisedLine:
    """Let the dashpots of slack droppers act as well: only the elastic force is unilateral.

    By default a slack dropper carries no force. In a code that keeps the damping matrix constant and compensates only
    the elastic force, the dashpot of a slack dropper still acts. Here it is a separate connector beside the dropper.
    """
    connectors, unilateral = line.connectors, line.connectors.unilateral
    zeros = np.zeros(int(unilateral.sum()))
    separated = connectors._replace(
        station=np.append(connectors.station, connectors.station[unilateral]),
        coefficient=np.concatenate([connectors.coefficient, connectors.coefficient[unilateral]]),
        stiffness=np.append(connectors.stiffness, zeros),
        damping=np.append(np.where(unilateral, 0.0, connectors.damping), connectors.damping[unilateral]),
        preload=np.append(connectors.preload, zeros),
        unilateral=np.append(unilateral, np.zeros(zeros.size, dtype=np.bool_)),
    )
    return replace(line, connectors=separated)


# Results that depend on the line alone: built once per line and shared by all its simulations.
Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def keep_with_line(
    build: Callable[Concatenate[DiscretisedLine, Arguments], Result],
) -> Callable[Concatenate[DiscretisedLine, Arguments], Result]:
    """Keep the results of a function with the line, so that each is built once and lives as long as the line.

    Args:
        build: Function of a line and of hashable positional arguments. Its result must not be changed by those who
            share it.

    Returns:
        The same function; equal arguments give the same object.
    """

    @wraps(build)
    def look_up(line: DiscretisedLine, /, *args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        key = (build, args, *kwargs.items())
        if key not in line.kept:
            line.kept[key] = build(line, *args, **kwargs)
        kept: Result = line.kept[key]
        return kept

    return look_up

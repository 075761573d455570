"""Static shape of a line with given dropper lengths in place of prescribed heights of the contact wire.

The heights at the droppers are found at which the droppers have the given lengths without load. Each step of the search
computes the initial state with trial heights, and corrects them by the deflection of the line when every dropper is
lengthened by its error: in the vertical plane this deflection is linear, and one step is sufficient.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.catenary import Catenary, Clamp, Dropper
from pantocheck.model.description.failures import NoInitialState
from pantocheck.model.discretisation.connectors import RIGID
from pantocheck.model.discretisation.initial_state import InitialState, compute_initial_state
from pantocheck.model.fem.beams import Beams, build_beams, wire_stiffness
from pantocheck.model.fem.mesh import Mesh, build_mesh

LENGTH_TOLERANCE = 1e-9
"""Largest error of a dropper length [m]; stiff droppers turn it into 1e-4 N."""

MAX_CORRECTIONS = 50
"""Largest number of corrections; inclined droppers need about ten."""


def unloaded_lengths(catenary: Catenary, state: InitialState) -> Array:
    """Lengths of the droppers without load: length at rest less tension over stiffness, (droppers,) [m]."""
    length, droppers = state.dropper_length, catenary.droppers
    stiffness = np.array([d.taut_stiffness(float(x)) for d, x in zip(droppers, length, strict=True)])
    return np.asarray(length - state.dropper_tension / stiffness)


def compute_unloaded_lengths(catenary: Catenary, element_length: float) -> Array:
    """Unloaded lengths of the droppers of a line with its prescribed heights, on elements of a length [m]."""
    mesh = build_mesh(catenary, element_length)
    return unloaded_lengths(catenary, compute_initial_state(catenary, mesh, build_beams(catenary, mesh)))


def hang_on_droppers(catenary: Catenary, length: Array, element_length: float) -> Catenary:
    """Replace the prescribed heights of the contact wire by those at which the droppers have given lengths.

    Supports of the messenger wires, anchors, and arms that carry their share keep their heights.

    Args:
        catenary: Description of the line; its heights at the droppers are the start of the search.
        length: Lengths of the droppers without load, (droppers,) [m].
        element_length: Largest length of an element [m].

    Returns:
        The same line with other heights at the droppers.

    Raises:
        NoInitialState: A dropper would be slack at rest, or no heights are found.
    """
    mesh = build_mesh(catenary, element_length)
    beams = build_beams(catenary, mesh)
    state = compute_initial_state(catenary, mesh, beams)
    response = _lengthening_response(catenary, mesh, beams, state)
    for _ in range(MAX_CORRECTIONS):
        error = length - unloaded_lengths(catenary, state)
        if np.abs(error).max(initial=0.0) < LENGTH_TOLERANCE:
            return catenary
        heights = [d.contact_wire_height or 0.0 for d in catenary.droppers] + response(error)
        droppers = zip(catenary.droppers, map(float, heights), strict=True)
        catenary = replace(catenary, droppers=tuple(replace(d, contact_wire_height=z) for d, z in droppers))
        try:
            state = compute_initial_state(catenary, mesh, beams)
        except NoInitialState as failure:
            raise NoInitialState(f"with the lengths of its droppers the line has no state at rest: {failure}") from None
    raise NoInitialState(f"no heights with the given dropper lengths after {MAX_CORRECTIONS} corrections")


def _lengthening_response(
    catenary: Catenary, mesh: Mesh, beams: Beams, state: InitialState
) -> Callable[[Array], Array]:
    """Rise of the contact wire at the droppers when droppers are lengthened, in the vertical plane [m, m]."""
    rows = [row for row in range(mesh.rows) if mesh.row_field[row] == "z"]
    stations, droppers = mesh.position.size, catenary.droppers

    def deflection(wire: str, position: float) -> int:
        """Index of a deflection among the unknowns of the vertical rows."""
        return 2 * (rows.index(mesh.row_of[wire, "z"]) * stations + mesh.station(position))

    bars: list[Dropper | Clamp] = [*droppers, *catenary.clamps]
    upper = [deflection(bar.upper, bar.position) for bar in bars]
    lower = [deflection(bar.lower, bar.position) for bar in bars]
    slope = state.dropper_direction[:, 1]
    axial = np.array([d.taut_stiffness(float(x)) for d, x in zip(droppers, state.dropper_length, strict=True)])
    bar_stiffness = np.append(axial * slope**2, np.full(len(catenary.clamps), RIGID))
    size = len(rows) * stations * 2
    index = (np.array([*upper, *lower], dtype=np.int64), np.tile(np.arange(len(bars)), 2))
    elongation = sp.csr_array((np.repeat([1.0, -1.0], len(bars)), index), shape=(size, len(bars)))
    wires = sp.block_diag([wire_stiffness(beams, row) for row in rows], format="csr")
    stiffness = sp.csr_array(wires + elongation @ sp.diags_array(bar_stiffness) @ elongation.T)
    free = beams.free[rows].ravel() & (stiffness.diagonal() != 0)
    free[[deflection(support.wire, support.position) for support in catenary.messenger_supports]] = False
    free[[deflection(arm.wire, arm.position) for arm in catenary.steady_arms if arm.carries_share]] = False
    solve = splu(sp.csc_array(stiffness[free][:, free])).solve
    loads = sp.csr_array(elongation[:, : len(droppers)][free])

    def rise(lengthening: Array) -> Array:
        """Rise of the contact wire at each dropper."""
        solution = np.zeros(size)
        solution[free] = solve(loads @ (axial * slope * lengthening))
        return np.asarray(solution[lower[: len(droppers)]])

    return rise

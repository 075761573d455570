"""Lateral initial state: the plan view of the line under its staggers.

    y ^    arm                       arm
      |     o-.                     .-o          contact wire: a zigzag between the steady arms
      |        `-.               .-'
      +-----------`-.---------.-'------> x
      |              `-o---o-'
                       arm

Without droppers the wires are straight between steady arms and supports. An inclined dropper pulls both its wires
sideways with its vertical force times its slope: it acts as a lateral spring of stiffness force over height.

In a curve of radius R, y counts from a centre line that is curved itself. A wire that is straight in space has the
curvature -1 / R there, as if the tension pulled it towards the centre of the curve with T / R per length.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from pantocheck.model.arrays import Array
from pantocheck.model.catenary import Catenary, Clamp, Dropper
from pantocheck.model.curves import curvature
from pantocheck.model.fem.beam import uniform_load
from pantocheck.model.fem.beams import Beams, load_row, wire_stiffness
from pantocheck.model.fem.mesh import Mesh
from pantocheck.model.statics.prescribed_displacements import solve_with_prescribed_displacements

CLAMP_STIFFNESS = 1e9
"""Lateral stiffness of a clamp: large against 1e4 N/m of a wire, small enough for ten digits of the solution [N/m]."""


@dataclass(frozen=True)
class LateralState:
    """Plan view at rest."""

    rows: list[int]
    """Indices of the lateral rows."""
    shape: Array
    """Distance from the track centre line, and slope, (lateral rows, stations, 2) [m, -]."""
    clamps: Array
    """Lateral force of the upper on the lower wire, (clamps,) [N]."""
    arms: Array
    """Lateral force of each arm on its wire, (steady arms,) [N]."""


def compute_lateral_state(catenary: Catenary, mesh: Mesh, beams: Beams, dropper_stiffness: Array) -> LateralState:
    """Compute the equilibrium of the lateral rows; `dropper_stiffness` is vertical force over height [N/m]."""
    rows = [row for row in range(mesh.rows) if mesh.row_field[row] == "y"]
    stations = mesh.position.size
    wires = sp.block_diag([wire_stiffness(beams, row) for row in rows], format="csr")

    def deflection_index(wire: str, position: float) -> int:
        """Index of a deflection among the unknowns of the lateral rows."""
        return 2 * (rows.index(mesh.row_of[wire, "y"]) * stations + mesh.station(position))

    bars: list[Dropper | Clamp] = [*catenary.droppers, *catenary.clamps]
    upper = [deflection_index(bar.upper, bar.position) for bar in bars]
    lower = [deflection_index(bar.lower, bar.position) for bar in bars]
    bar_stiffness = np.append(dropper_stiffness, np.full(len(catenary.clamps), CLAMP_STIFFNESS))
    indices = (np.append(upper, lower).astype(int), np.tile(np.arange(len(bars)), 2))
    elongation = sp.csr_array((np.repeat([1.0, -1.0], len(bars)), indices), shape=(wires.shape[0], len(bars)))
    free = beams.free[rows].copy()
    shape = np.zeros((len(rows), stations, 2))
    for wire in catenary.wires:
        for x, y in wire.stagger or ():
            row, station = rows.index(mesh.row_of[wire.name, "y"]), mesh.station(x)
            free[row, station, 0] = False
            shape[row, station, 0] = y
    stiffness = sp.csr_array(wires + elongation @ sp.diags_array(bar_stiffness) @ elongation.T)
    load = np.concatenate([_radial_load(catenary, mesh, beams, row) for row in rows])
    solution = solve_with_prescribed_displacements(stiffness, load, free, shape.ravel())
    force = bar_stiffness * (elongation.T @ solution)
    reaction = stiffness @ solution - load
    return LateralState(
        rows=rows,
        shape=np.reshape(solution, shape.shape),
        clamps=force[len(catenary.droppers) :],
        arms=np.array([reaction[deflection_index(arm.wire, arm.position)] for arm in catenary.steady_arms]),
    )


def _radial_load(catenary: Catenary, mesh: Mesh, beams: Beams, row: int) -> Array:
    """Nodal forces of the tension in a curve, T / R per length towards its centre, of one row [N, N m]."""
    middle = (mesh.position[:-1] + mesh.position[1:]) / 2
    radial = beams.tension[row] * curvature(catenary.curves, middle)
    return load_row(uniform_load(beams.length, radial))

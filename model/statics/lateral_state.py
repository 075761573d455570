"""Lateral initial state: the plan view of the line under its staggers.

    y ^    arm                       arm
      |     o-.                     .-o          contact wire: a zigzag between the steady arms
      |        `-.               .-'
      +-----------`-.---------.-'------> x
      |              `-o---o-'
                       arm

The wires are straight between the places where arms and supports hold them, but for the droppers: one that leans pulls
both its wires sideways by its vertical force times its slope, which is a lateral spring of stiffness force over height.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from pantocheck.model.arrays import Array
from pantocheck.model.catenary import Catenary
from pantocheck.model.fem.beams import Beams, wire_matrices
from pantocheck.model.fem.mesh import Mesh
from pantocheck.model.statics.prescribed_displacements import solve_with_prescribed_displacements


@dataclass(frozen=True)
class LateralState:
    """Plan view at rest.

    Parameters
    ----------
    rows : list[int]
        The lateral rows.
    shape : (lateral rows, stations, 2) ndarray
        Distance from the centre line, and slope [m, -].
    clamps : (clamps,) ndarray
        Lateral force of the upper on the lower wire [N].
    arms : (steady arms,) ndarray
        Lateral force of each arm on its wire [N].
    """

    rows: list[int]
    shape: Array
    clamps: Array
    arms: Array


def compute_lateral_state(catenary: Catenary, mesh: Mesh, beams: Beams, dropper_stiffness: Array) -> LateralState:
    """Equilibrium of the lateral rows.

    Parameters
    ----------
    catenary : Catenary
        The line, its wires with their staggers.
    mesh : Mesh
        Stations and rows.
    beams : Beams
        Rows of beams.
    dropper_stiffness : (droppers,) ndarray
        Vertical force over height of each dropper [N/m].

    Returns
    -------
    LateralState
        The plan view.
    """
    rows = [row for row in range(mesh.rows) if mesh.row_field[row] == "y"]
    stations = mesh.position.size
    wires = sp.block_diag([wire_matrices(beams, row)[0] for row in rows], format="csr")

    def at(wire: str, position: float) -> int:
        return 2 * (rows.index(mesh.row_of[wire, "y"]) * stations + mesh.station(position))

    upper = [at(d.upper, d.position) for d in catenary.droppers] + [at(c.upper, c.position) for c in catenary.clamps]
    lower = [at(d.lower, d.position) for d in catenary.droppers] + [at(c.lower, c.position) for c in catenary.clamps]
    # Stiff against a wire's 1e4 N/m, soft enough to leave the solution ten digits.
    clamp = np.full(len(catenary.clamps), 1e9)
    bars = np.concatenate([dropper_stiffness, clamp])
    number = np.arange(bars.size)
    joint = sp.csr_array(
        (np.repeat([1.0, -1.0], bars.size), (np.concatenate([upper, lower]), np.tile(number, 2))),
        shape=(wires.shape[0], bars.size),
    )
    free = beams.free[rows].copy()
    shape = np.zeros((len(rows), stations, 2))
    for wire in catenary.wires:
        for x, y in wire.stagger or ():
            row, station = rows.index(mesh.row_of[wire.name, "y"]), mesh.station(x)
            free[row, station, 0] = False
            shape[row, station, 0] = y
    stiffness = sp.csr_array(wires + joint @ sp.diags_array(bars) @ joint.T)
    solved = solve_with_prescribed_displacements(stiffness, np.zeros(shape.size), free.ravel(), shape.ravel())
    force = bars * (joint.T @ solved)
    reaction = stiffness @ solved
    return LateralState(
        rows=rows,
        shape=np.reshape(solved, shape.shape),
        clamps=force[len(catenary.droppers) :],
        arms=np.array([reaction[at(arm.wire, arm.position)] for arm in catenary.steady_arms]),
    )

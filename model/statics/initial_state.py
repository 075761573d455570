"""Initial state: the line at rest under its own weight, with the contact wire at its prescribed heights.

The contact wire's heights at the droppers give the dropper tensions; these and the weights give the shape of the wires
above; the distance between the two gives the dropper lengths. Equilibrium holds exactly in the finite-element sense, so
that the dynamics about this state start from rest.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from pantocheck.model.arrays import Array
from pantocheck.model.catenary import GRAVITY, Catenary, Kind
from pantocheck.model.failures import NoInitialState
from pantocheck.model.fem.beams import Beams, weight, wire_stiffness
from pantocheck.model.fem.mesh import Mesh
from pantocheck.model.statics.lateral_state import compute_lateral_state
from pantocheck.model.statics.prescribed_displacements import solve_with_prescribed_displacements

Stiffness = Callable[[Beams, int], sp.csr_array]


@dataclass(frozen=True)
class InitialState:
    """The line at rest.

    Parameters
    ----------
    deflection : (rows, stations, 2) ndarray
        Vertical rows: height over the contact wire at the supports; lateral rows: distance from the track's centre
        line; and slope [m, -].
    dropper_tension : (droppers,) ndarray
        Axial, at mid-length [N].
    dropper_length : (droppers,) ndarray
        Between the wires' axes [m].
    dropper_direction : (droppers, 2) ndarray
        From the lower to the upper wire, y and z [-].
    clamp_force : (clamps, 2) ndarray
        Force of the upper on the lower wire, y and z [N].
    arm_force : (steady arms, 2) ndarray
        Static force of each steady arm on the contact wire, y and z [N].
    """

    deflection: Array
    dropper_tension: Array
    dropper_length: Array
    dropper_direction: Array
    clamp_force: Array
    arm_force: Array


def compute_initial_state(
    catenary: Catenary, mesh: Mesh, beams: Beams, stiffness: Stiffness = wire_stiffness
) -> InitialState:
    """Equilibrium of the line under its weight.

    Parameters
    ----------
    catenary : Catenary
        The line.
    mesh : Mesh
        Its stations and rows.
    beams : Beams
        Its rows of beams.
    stiffness : Stiffness
        Of the wires of one row; as beams, unless strings are asked for.

    Returns
    -------
    InitialState
        The initial state.

    Raises
    ------
    NoInitialState
        a dropper would have to push.
    """
    vertical = [row for row in range(mesh.rows) if mesh.row_field[row] == "z"]
    contact = [row for row in vertical if mesh.row_kind[row] is Kind.CONTACT_WIRE]
    upper = [row for row in vertical if row not in contact]
    deflection = np.zeros((mesh.rows, mesh.position.size, 2))
    reaction = np.zeros((mesh.rows, mesh.position.size))
    for row in contact:
        shape, reaction[row] = _hold_contact_wire(catenary, mesh, beams, row, stiffness(beams, row))
        deflection[row] = shape
    tension = np.array(
        [
            reaction[mesh.row_of[d.lower, "z"], mesh.station(d.position)] + GRAVITY * (d.lower_clamp_mass + d.mass / 2)
            for d in catenary.droppers
        ]
    )
    _refuse_pushing(catenary, tension)
    clamp_force = np.zeros((len(catenary.clamps), 2))
    if upper:
        deflection[upper], clamp_force[:, 1] = _hang_upper_wires(
            catenary, mesh, beams, upper, tension, [stiffness(beams, row) for row in upper]
        )
    rise = _difference(catenary, mesh, deflection, "z")
    if rise.size and rise.min() <= 0:
        place = catenary.droppers[int(np.argmin(rise))].position
        raise NoInitialState(f"the wires cross at the dropper at x = {place:g} m; the encumbrance is too small")
    arm_force = np.zeros((len(catenary.steady_arms), 2))
    for n, arm in enumerate(catenary.steady_arms):
        if arm.carries_share:
            arm_force[n, 1] = reaction[mesh.row_of[arm.wire, "z"], mesh.station(arm.position)]
    run = np.zeros_like(rise)
    if catenary.has_lateral_field:
        lateral = compute_lateral_state(catenary, mesh, beams, tension / rise)
        deflection[lateral.rows], clamp_force[:, 0], arm_force[:, 0] = lateral.shape, lateral.clamps, lateral.arms
        run = _difference(catenary, mesh, deflection, "y")
    length = np.hypot(rise, run)
    direction = np.stack([run / length, rise / length], axis=1)
    return InitialState(deflection, tension * length / rise, length, direction, clamp_force, arm_force)


def _difference(catenary: Catenary, mesh: Mesh, deflection: Array, field: str) -> Array:
    """Upper minus lower end of every dropper in one field."""
    return np.array(
        [
            deflection[mesh.row_of[d.upper, field], mesh.station(d.position), 0]
            - deflection[mesh.row_of[d.lower, field], mesh.station(d.position), 0]
            for d in catenary.droppers
        ]
    )


def _hold_contact_wire(
    catenary: Catenary, mesh: Mesh, beams: Beams, row: int, stiffness: sp.csr_array
) -> tuple[Array, Array]:
    """Shape of a contact wire held at its prescribed heights, and the force that holds it at each station."""
    names = {name for (name, field), at in mesh.row_of.items() if at == row and field == "z"}
    held = {
        mesh.station(d.position): d.contact_wire_height
        for d in catenary.droppers
        if d.lower in names and d.contact_wire_height is not None
    }
    held |= {mesh.station(arm.position): 0.0 for arm in catenary.steady_arms if arm.wire in names and arm.carries_share}
    load = weight(beams, row, GRAVITY)
    free = beams.free[row].copy()
    shape = np.zeros((mesh.position.size, 2))
    for at, height in held.items():
        free[at, 0] = False
        shape[at, 0] = height
    solved = solve_with_prescribed_displacements(stiffness, load, free.ravel(), shape.ravel())
    return solved.reshape(-1, 2), (stiffness @ solved - load)[::2]


def _hang_upper_wires(
    catenary: Catenary, mesh: Mesh, beams: Beams, rows: list[int], tension: Array, wires: list[sp.csr_array]
) -> tuple[Array, Array]:
    """Shape of messenger and stitch wires under weight and dropper tensions, clamped together, held at the supports."""
    stations = mesh.position.size
    place = {row: index for index, row in enumerate(rows)}
    stiffness = sp.block_diag(wires, format="csr")
    load = np.concatenate([weight(beams, row, GRAVITY) for row in rows])
    free = beams.free[rows].copy()
    shape = np.zeros((len(rows), stations, 2))

    def deflection_index(name: str, position: float) -> int:
        return 2 * (place[mesh.row_of[name, "z"]] * stations + mesh.station(position))

    for d, n in zip(catenary.droppers, tension, strict=True):
        load[deflection_index(d.upper, d.position)] -= n + GRAVITY * (d.mass / 2 + d.upper_clamp_mass)
    for wire in catenary.wires:
        if wire.kind is Kind.MESSENGER_WIRE:
            _hold_messenger(catenary, mesh, wire.name, place[mesh.row_of[wire.name, "z"]], free, shape)
    # A clamp makes two deflections one: the lower wire's is expressed by the upper wire's.
    merge = np.arange(free.size)
    for clamp in catenary.clamps:
        merge[deflection_index(clamp.lower, clamp.position)] = deflection_index(clamp.upper, clamp.position)
        load[deflection_index(clamp.upper, clamp.position)] -= GRAVITY * clamp.mass
    join = sp.csr_array((np.ones(free.size), (np.arange(free.size), merge)), shape=(free.size, free.size))
    flat = free.ravel().copy()
    flat[merge != np.arange(free.size)] = False
    solved = join @ solve_with_prescribed_displacements(join.T @ stiffness @ join, join.T @ load, flat, shape.ravel())
    residual = load - stiffness @ solved
    clamp_tension = np.array([-residual[deflection_index(c.lower, c.position)] for c in catenary.clamps])
    return np.reshape(solved, (len(rows), stations, 2)), clamp_tension


def _hold_messenger(catenary: Catenary, mesh: Mesh, name: str, row: int, free: NDArray[np.bool_], shape: Array) -> None:
    supports = sorted((s for s in catenary.messenger_supports if s.wire == name), key=lambda s: s.position)
    wire = catenary.wire(name)
    ends = [] if not supports else [(wire.start, supports[0].height), (wire.end, supports[-1].height)]
    for position, height in [*ends, *((s.position, s.height) for s in supports)]:
        free[row, mesh.station(position), 0] = False
        shape[row, mesh.station(position), 0] = height


def _refuse_pushing(catenary: Catenary, tension: Array) -> None:
    if tension.size and tension.min() <= 0:
        worst = int(np.argmin(tension))
        place = catenary.droppers[worst].position
        raise NoInitialState(
            f"the dropper at x = {place:g} m would have to push with {-tension[worst]:.3g} N to hold the contact wire"
            " at its prescribed height; a dropper cannot push"
        )

"""Initial state: the line at rest in side and plan view, by linear statics with prescribed displacements."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy  # loads its parts when they are used
from numpy.typing import NDArray

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.catenary import GRAVITY, Catenary, Clamp, Dropper, Kind
from pantocheck.model.description.curves import curvature
from pantocheck.model.description.failures import ImpossibleDropper
from pantocheck.model.fem.beam import uniform_load
from pantocheck.model.fem.beams import Beams, load_row, weight, wire_stiffness
from pantocheck.model.fem.mesh import Mesh


def solve_with_prescribed_displacements(
    stiffness: "scipy.sparse.csr_array", load: Array, free: NDArray[np.bool_], prescribed: Array
) -> Array:
    """Solve K q = f for the free unknowns; a free unknown without stiffness stays at zero.

    The unknowns are solved station by station, all rows together: in this order the matrix is a narrow band.

    Args:
        stiffness: Stiffness matrix K, positive definite for the free unknowns, (n, n); n = 2 B S.
        load: Forces and moments f, (n,) [N, N m].
        free: Whether an unknown of B rows with S stations is free, (B, S, 2).
        prescribed: Values of the other unknowns, (n,) [m, -].

    Returns:
        All unknowns q, (n,) [m, -].
    """
    order = np.arange(free.size).reshape(free.shape).transpose(1, 0, 2).ravel()
    solution: Array = np.where(free.ravel(), 0.0, prescribed)
    active = order[(free.ravel() & (stiffness.diagonal() != 0))[order]]
    place = np.full(free.size, -1)
    place[active] = np.arange(active.size)
    entries = stiffness.tocoo()
    row, column = place[entries.row], place[entries.col]
    lower = (column >= 0) & (row >= column)
    distance, column = (row - column)[lower], column[lower]
    band = np.zeros((int(distance.max(initial=0)) + 1, active.size))
    np.add.at(band, (distance, column), entries.data[lower])
    solution[active] = scipy.linalg.solveh_banded(
        band, (load - stiffness @ solution)[active], lower=True, check_finite=False
    )
    return solution


# Lateral initial state: the plan view of the line under its staggers.
#
# y ^    arm                       arm
#   |     o-.                     .-o          contact wire: a zigzag between the steady arms
#   |        `-.               .-'
#   +-----------`-.---------.-'------> x
#   |              `-o---o-'
#                    arm
#
# Without droppers the wires are straight between steady arms and supports. An inclined dropper pulls both its wires
# sideways with its vertical force times its slope: it acts as a lateral spring of stiffness force over height.
#
# In a curve of radius R, y counts from a centre line that is curved itself. A wire that is straight in space has the
# curvature -1 / R there, as if the tension pulled it towards the centre of the curve with T / R per length.
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
    wires = scipy.sparse.block_diag([wire_stiffness(beams, row) for row in rows], format="csr")

    def deflection_index(wire: str, position: float) -> int:
        """Index of a deflection among the unknowns of the lateral rows."""
        return 2 * (rows.index(mesh.row_of[wire, "y"]) * stations + mesh.station(position))

    bars: list[Dropper | Clamp] = [*catenary.droppers, *catenary.clamps]
    upper = [deflection_index(bar.upper, bar.position) for bar in bars]
    lower = [deflection_index(bar.lower, bar.position) for bar in bars]
    bar_stiffness = np.append(dropper_stiffness, np.full(len(catenary.clamps), CLAMP_STIFFNESS))
    indices = (np.append(upper, lower).astype(int), np.tile(np.arange(len(bars)), 2))
    elongation = scipy.sparse.csr_array((np.repeat([1.0, -1.0], len(bars)), indices), shape=(wires.shape[0], len(bars)))
    free = beams.free[rows].copy()
    shape = np.zeros((len(rows), stations, 2))
    for wire in catenary.wires:
        for x, y in wire.stagger or ():
            row, station = rows.index(mesh.row_of[wire.name, "y"]), mesh.station(x)
            free[row, station, 0] = False
            shape[row, station, 0] = y
    stiffness = scipy.sparse.csr_array(wires + elongation @ scipy.sparse.diags_array(bar_stiffness) @ elongation.T)
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


# Initial state: the line at rest under its own weight, with the contact wire at its prescribed heights.
#
# 1. The prescribed heights of the contact wire give the dropper tensions.
# 2. Dropper tensions and weights give the shape of messenger and stitch wires.
# 3. Staggers give the lateral shape, with the droppers as lateral springs.
# 4. The distance between the wires gives length and direction of the droppers.
#
# Equilibrium holds exactly in the finite-element sense, so that a simulation started from this state is at rest.
Stiffness = Callable[[Beams, int], "scipy.sparse.csr_array"]
"""Stiffness matrix of the wires of one row: as beams or as strings."""


@dataclass(frozen=True)
class InitialState:
    """The line at rest."""

    deflection: Array
    """Vertical rows, (rows, stations, 2): height; lateral rows: distance from the track centre line; each with its
    slope [m, -].
    """
    dropper_tension: Array
    """Axial tension at mid-length, (droppers,) [N]."""
    dropper_length: Array
    """Length between the axes of the wires, (droppers,) [m]."""
    dropper_direction: Array
    """Direction from the lower to the upper wire, y and z, (droppers, 2) [-]."""
    clamp_force: Array
    """Force of the upper on the lower wire, y and z, (clamps, 2) [N]."""
    arm_force: Array
    """Static force of each steady arm on the contact wire, y and z, (steady arms, 2) [N]."""


def compute_initial_state(
    catenary: Catenary, mesh: Mesh, beams: Beams, stiffness: Stiffness = wire_stiffness
) -> InitialState:
    """Compute the equilibrium of the line under its weight.

    Args:
        catenary: Description of the line.
        mesh: Stations and rows.
        beams: Rows of beams.
        stiffness: Stiffness of the wires of one row, as beams (default) or as strings.

    Returns:
        Line at rest.

    Raises:
        NoInitialState: A dropper would have to push, or two wires cross.
    """
    vertical = [row for row in range(mesh.rows) if mesh.row_field[row] == "z"]
    contact = [row for row in vertical if mesh.row_kind[row] is Kind.CONTACT_WIRE]
    upper = [row for row in vertical if row not in contact]
    deflection = np.zeros((mesh.rows, mesh.position.size, 2))
    reaction = np.zeros((mesh.rows, mesh.position.size))
    clamp_force, arm_force = np.zeros((len(catenary.clamps), 2)), np.zeros((len(catenary.steady_arms), 2))
    # 1. Contact wires.
    for row in contact:
        deflection[row], reaction[row] = _hold_contact_wire(catenary, mesh, beams, row, stiffness(beams, row))
    tension = _dropper_tension(catenary, mesh, reaction)
    for n, arm in enumerate(catenary.steady_arms):
        if arm.carries_share:
            arm_force[n, 1] = reaction[mesh.row_of[arm.wire, "z"], mesh.station(arm.position)]
    # 2. Messenger and stitch wires.
    if upper:
        matrix = scipy.sparse.block_diag([stiffness(beams, row) for row in upper], format="csr")
        deflection[upper], clamp_force[:, 1] = _hang_upper_wires(catenary, mesh, beams, upper, tension, matrix)
    height = _dropper_extent(catenary, mesh, deflection, "z")
    if height.size and height.min() <= 0:
        position = catenary.droppers[int(np.argmin(height))].position
        raise ImpossibleDropper(
            f"the wires cross at the dropper at x = {position:g} m: the encumbrance is smaller than the sag", position
        )
    # 3. Lateral shape.
    width = np.zeros_like(height)
    if catenary.has_lateral_field:
        lateral = compute_lateral_state(catenary, mesh, beams, tension / height)
        deflection[lateral.rows], clamp_force[:, 0], arm_force[:, 0] = lateral.shape, lateral.clamps, lateral.arms
        width = _dropper_extent(catenary, mesh, deflection, "y")
    # 4. Droppers.
    length = np.hypot(height, width)
    direction = np.stack([width / length, height / length], axis=1)
    return InitialState(deflection, tension * length / height, length, direction, clamp_force, arm_force)


def _hold_contact_wire(
    catenary: Catenary, mesh: Mesh, beams: Beams, row: int, stiffness: "scipy.sparse.csr_array"
) -> tuple[Array, Array]:
    """Shape of a contact wire held at its prescribed heights, and the holding force at each station."""
    names = {name for (name, field), wire_row in mesh.row_of.items() if wire_row == row and field == "z"}
    heights = {
        mesh.station(d.position): d.contact_wire_height
        for d in catenary.droppers
        if d.lower in names and d.contact_wire_height is not None
    }
    arms = [arm for arm in catenary.steady_arms if arm.wire in names and arm.carries_share]
    heights |= {mesh.station(arm.position): arm.height for arm in arms}
    for wire in map(catenary.wire, names):
        heights |= zip(map(mesh.station, (wire.start, wire.end)), wire.end_heights or (0.0, 0.0), strict=True)
    load, free = _weight(catenary, mesh, beams, row), beams.free[row].copy()
    shape = np.zeros((mesh.position.size, 2))
    for station, height in heights.items():
        free[station, 0] = False
        shape[station, 0] = height
    solution = solve_with_prescribed_displacements(stiffness, load, free[None], shape.ravel())
    return solution.reshape(-1, 2), (stiffness @ solution - load)[::2]


def _weight(catenary: Catenary, mesh: Mesh, beams: Beams, row: int) -> Array:
    """Weight of the wires of one row and of the point masses on them, as nodal forces [N, N m]."""
    load = weight(beams, row, GRAVITY)
    for mass in catenary.point_masses:
        if mesh.row_of[mass.wire, "z"] == row:
            load[2 * mesh.station(mass.position)] -= GRAVITY * mass.mass
    return load


def _dropper_tension(catenary: Catenary, mesh: Mesh, reaction: Array) -> Array:
    """Vertical force at mid-length of every dropper, from the forces that hold the contact wires at each station."""
    tension = np.array(
        [
            reaction[mesh.row_of[d.lower, "z"], mesh.station(d.position)] + GRAVITY * (d.lower_clamp_mass + d.mass / 2)
            for d in catenary.droppers
        ]
    )
    if tension.size and tension.min() <= 0:
        worst = int(np.argmin(tension))
        position = catenary.droppers[worst].position
        raise ImpossibleDropper(
            f"the dropper at x = {position:g} m would have to push with {-tension[worst]:.3g} N to hold the contact"
            " wire at its prescribed height; a dropper cannot push",
            position,
        )
    return tension


def _hang_upper_wires(
    catenary: Catenary, mesh: Mesh, beams: Beams, rows: list[int], tension: Array, stiffness: "scipy.sparse.csr_array"
) -> tuple[Array, Array]:
    """Shape of messenger and stitch wires under weight and dropper tensions, and the vertical forces of the clamps."""
    stations = mesh.position.size
    load = np.concatenate([_weight(catenary, mesh, beams, row) for row in rows])
    free, shape = beams.free[rows].ravel(), np.zeros(len(rows) * stations * 2)

    def deflection_index(wire: str, position: float) -> int:
        """Index of a deflection among the unknowns of the upper wires."""
        return 2 * (rows.index(mesh.row_of[wire, "z"]) * stations + mesh.station(position))

    for dropper, force in zip(catenary.droppers, tension, strict=True):
        weight_share = GRAVITY * (dropper.mass / 2 + dropper.upper_clamp_mass)
        load[deflection_index(dropper.upper, dropper.position)] -= force + weight_share
    for name, position, height in _messenger_heights(catenary):
        free[deflection_index(name, position)] = False
        shape[deflection_index(name, position)] = height
    # A clamp makes two deflections one: that of the lower wire is replaced by that of the upper wire.
    merged = np.arange(free.size)
    for clamp in catenary.clamps:
        merged[deflection_index(clamp.lower, clamp.position)] = deflection_index(clamp.upper, clamp.position)
        load[deflection_index(clamp.upper, clamp.position)] -= GRAVITY * clamp.mass
    join = scipy.sparse.csr_array((np.ones(free.size), (np.arange(free.size), merged)), shape=(free.size, free.size))
    free[merged != np.arange(free.size)] = False
    joined, places = join.T @ stiffness @ join, free.reshape(len(rows), stations, 2)
    solution = join @ solve_with_prescribed_displacements(joined, join.T @ load, places, shape)
    residual = load - stiffness @ solution
    clamp_force = np.array([-residual[deflection_index(c.lower, c.position)] for c in catenary.clamps])
    return np.reshape(solution, (len(rows), stations, 2)), clamp_force


def _messenger_heights(catenary: Catenary) -> list[tuple[str, float, float]]:
    """Wire, position and height of the anchors and supports of the messenger wires; a support at an anchor rules."""
    heights = []
    for wire in catenary.wires:
        if wire.kind is Kind.MESSENGER_WIRE:
            supports = sorted((s.position, s.height) for s in catenary.messenger_supports if s.wire == wire.name)
            next_supports = (supports[0][1], supports[-1][1]) if supports else (0.0, 0.0)
            start, end = wire.end_heights or next_supports
            heights += [(wire.name, wire.start, start), (wire.name, wire.end, end)]
            heights += [(wire.name, *support) for support in supports]
    return heights


def _dropper_extent(catenary: Catenary, mesh: Mesh, deflection: Array, field: str) -> Array:
    """Upper minus lower end of every dropper in one field."""
    station = [mesh.station(dropper.position) for dropper in catenary.droppers]
    upper = [mesh.row_of[dropper.upper, field] for dropper in catenary.droppers]
    lower = [mesh.row_of[dropper.lower, field] for dropper in catenary.droppers]
    return np.asarray(deflection[upper, station, 0] - deflection[lower, station, 0])

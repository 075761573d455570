"""Connectors: what couples the rows of beams, each a bar with one elongation at one station.

A dropper is unilateral: its tension is max(0, N0 + k d + c d'), with the elongation d counted from the initial state.
All others act both ways: clamps, steady arms along their length, and the sideways stiffness, force over length, of any
loaded bar. The tension pulls every row by its coefficient: d = sum over rows of coefficient times deflection, and the
row feels minus the coefficient times the tension.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pantocheck.model.arrays import Array, Indices
from pantocheck.model.catenary import Catenary, Kind, Rayleigh, SteadyArm
from pantocheck.model.fem.beams import Beams
from pantocheck.model.fem.mesh import Mesh
from pantocheck.model.statics.initial_state import InitialState

# Stiff against the wires (about 1e5 N/m at a point) and yet far from the limits of double precision.
RIGID = 1e8
"""Stiffness of a clamp between two wires, and of a steady arm along its length [N/m]."""


@dataclass(frozen=True)
class Bar:
    """One connector: see `Connectors`."""

    station: int
    coefficient: dict[int, float]
    stiffness: float
    damping: float = 0.0
    preload: float = 0.0
    unilateral: bool = False


class Connectors(NamedTuple):
    """Connectors, droppers first, in the order of the line; N connectors, B rows.

    Parameters
    ----------
    station : (N,) ndarray
        Index.
    coefficient : (N, B) ndarray
        Of each row's deflection in the elongation [-].
    stiffness, damping : (N,) ndarray
        [N/m, N s/m].
    preload : (N,) ndarray
        Tension in the initial state [N].
    unilateral : (N,) ndarray
        Whether the tension cannot be negative.
    """

    station: Indices
    coefficient: Array
    stiffness: Array
    damping: Array
    preload: Array
    unilateral: NDArray[np.bool_]


def build_connectors(catenary: Catenary, mesh: Mesh, state: InitialState) -> Connectors:
    """Droppers, clamps and, with a lateral field, steady arms of a line.

    Parameters
    ----------
    catenary : Catenary
        The line.
    mesh : Mesh
        Its stations and rows.
    state : InitialState
        Its initial state, which gives forces, lengths and directions.

    Returns
    -------
    Connectors
        The connectors.
    """
    bars = _droppers(catenary, mesh, state) + _clamps(catenary, mesh, state)
    if catenary.has_lateral_field:
        bars += _leaning_droppers(catenary, mesh, state) + _steady_arms(catenary, mesh, state)
    coefficient = np.zeros((len(bars), mesh.rows))
    for n, bar in enumerate(bars):
        coefficient[n, list(bar.coefficient)] = list(bar.coefficient.values())
    return Connectors(
        station=np.array([bar.station for bar in bars], dtype=np.int64),
        coefficient=coefficient,
        stiffness=np.array([bar.stiffness for bar in bars]),
        damping=np.array([bar.damping for bar in bars]),
        preload=np.array([bar.preload for bar in bars]),
        unilateral=np.array([bar.unilateral for bar in bars], dtype=np.bool_),
    )


def _between(mesh: Mesh, upper: str, lower: str, direction: tuple[float, float]) -> dict[int, float]:
    """Elongation, along a direction (y, z), of what joins a lower to an upper wire."""
    y, z = direction
    ends = {mesh.row_of[upper, "z"]: z, mesh.row_of[lower, "z"]: -z}
    if (upper, "y") in mesh.row_of:
        ends |= {mesh.row_of[upper, "y"]: y, mesh.row_of[lower, "y"]: -y}
    return ends


def _droppers(catenary: Catenary, mesh: Mesh, state: InitialState) -> list[Bar]:
    rayleigh = catenary.damping.get(Kind.DROPPER, Rayleigh())
    bars = []
    for n, dropper in enumerate(catenary.droppers):
        stiffness = dropper.stiffness
        if stiffness is None:
            stiffness = (dropper.axial_stiffness or 0.0) / float(state.dropper_length[n])
        y, z = map(float, state.dropper_direction[n])
        bars.append(
            Bar(
                mesh.station(dropper.position),
                _between(mesh, dropper.upper, dropper.lower, (y, z)),
                stiffness,
                rayleigh.stiffness_coefficient * stiffness,
                float(state.dropper_tension[n]),
                unilateral=True,
            )
        )
    return bars


def _clamps(catenary: Catenary, mesh: Mesh, state: InitialState) -> list[Bar]:
    directions = [(0.0, 1.0)] if not catenary.has_lateral_field else [(0.0, 1.0), (1.0, 0.0)]
    return [
        Bar(
            mesh.station(clamp.position),
            _between(mesh, clamp.upper, clamp.lower, (y, z)),
            RIGID,
            preload=float(state.clamp_force[n] @ (y, z)),
        )
        for n, clamp in enumerate(catenary.clamps)
        for y, z in directions
    ]


def _leaning_droppers(catenary: Catenary, mesh: Mesh, state: InitialState) -> list[Bar]:
    """Sideways stiffness of the droppers at their static tension."""
    across = zip(catenary.droppers, state.dropper_direction, state.dropper_tension / state.dropper_length, strict=True)
    return [
        Bar(mesh.station(d.position), _between(mesh, d.upper, d.lower, (float(z), -float(y))), float(stiffness))
        for d, (y, z), stiffness in across
    ]


def _steady_arms(catenary: Catenary, mesh: Mesh, state: InitialState) -> list[Bar]:
    """Hinged bars: rigid along their length, and sideways as stiff as their axial force over their length."""
    rayleigh = catenary.damping.get(Kind.STEADY_ARM, Rayleigh())
    bars = []
    for arm, force in zip(catenary.steady_arms, state.arm_force, strict=True):
        station, rows = mesh.station(arm.position), [mesh.row_of[arm.wire, field] for field in "yz"]
        y, z, tension = arm_direction(arm, force)
        along = dict(zip(rows, (-y, -z), strict=True))
        bars.append(Bar(station, along, RIGID, preload=tension))
        if arm.vertical_stiffness is None and arm.length is not None and tension != 0.0:
            stiffness = tension / arm.length
            across = dict(zip(rows, (z, -y), strict=True))
            bars.append(Bar(station, across, stiffness, rayleigh.stiffness_coefficient * abs(stiffness)))
    return bars


def arm_direction(arm: SteadyArm, force: Array) -> tuple[float, float, float]:
    """Direction of a steady arm from claw to hinge, and its axial tension.

    A hinged bar lies along the force it carries; its own weight is left to its hinge. An arm that pulls has its hinge
    on the side to which it pulls, one that pushes on the other.

    Parameters
    ----------
    arm : SteadyArm
        The steady arm.
    force : (2,) ndarray
        Its static force on the contact wire, y and z [N].

    Returns
    -------
    tuple[float, float, float]
        Direction y, z [-], and tension, negative for an arm that pushes [N].
    """
    size = float(np.hypot(*force))
    if force[0] == 0.0:
        # Nothing pulls sideways: the bar lies level and carries nothing, whatever holds up the wire.
        return 1.0, 0.0, 0.0
    sign = 1.0 if arm.acts == "pull" else -1.0
    return sign * float(force[0]) / size, sign * float(force[1]) / size, sign * size


def add_lumped(catenary: Catenary, mesh: Mesh, beams: Beams) -> None:
    """Add masses, springs and dampers that act on one row at one station to the rows, in place.

    Parameters
    ----------
    catenary : Catenary
        The line.
    mesh : Mesh
        Its stations and rows.
    beams : Beams
        Its rows of beams, lumped arrays changed in place.
    """
    undamped = Rayleigh()

    def add(kind: Kind, row: int, position: float, mass: float, stiffness: float = 0.0, damping: float = 0.0) -> None:
        at, rayleigh = mesh.station(position), catenary.damping.get(kind, undamped)
        beams.lumped_mass[row, at] += mass
        beams.lumped_stiffness[row, at] += stiffness
        beams.lumped_damping[row, at] += (
            damping + rayleigh.mass_coefficient * mass + rayleigh.stiffness_coefficient * stiffness
        )

    for field in dict.fromkeys(mesh.row_field):
        for dropper in catenary.droppers:
            half = dropper.mass / 2
            upper, lower = mesh.row_of[dropper.upper, field], mesh.row_of[dropper.lower, field]
            add(Kind.DROPPER, upper, dropper.position, half + dropper.upper_clamp_mass)
            add(Kind.DROPPER, lower, dropper.position, half + dropper.lower_clamp_mass)
        for clamp in catenary.clamps:
            add(Kind.DROPPER, mesh.row_of[clamp.upper, field], clamp.position, clamp.mass)
        for arm in catenary.steady_arms:
            add(Kind.STEADY_ARM, mesh.row_of[arm.wire, field], arm.position, arm.mass)
        for support in catenary.messenger_supports:
            row = mesh.row_of[support.wire, field]
            add(Kind.MESSENGER_SUPPORT, row, support.position, 0.0, support.stiffness, support.damping)
    for arm in catenary.steady_arms:
        row = mesh.row_of[arm.wire, "z"]
        add(Kind.STEADY_ARM, row, arm.position, 0.0, arm.vertical_stiffness or 0.0, arm.vertical_damper)

"""Connectors: bars that couple the rows of beams, each with one elongation at one station.

A dropper is unilateral: its tension is max(0, N0 + k d + c d'), with the elongation d counted from the initial state.
All others act in both directions: clamps, steady arms along their length, and the transverse stiffness of loaded bars,
force over length. With the coefficients c of the rows, d is the sum of c times the deflections, and each row is loaded
by -c times the tension.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.description.catenary import Catenary, Kind, SteadyArm
from pantocheck.model.discretisation.initial_state import InitialState
from pantocheck.model.fem.beams import Beams
from pantocheck.model.fem.mesh import Mesh
from pantocheck.model.fem.residual_flexibility import combine_in_series, station_flexibility

RIGID = 1e8
"""Stiffness of a clamp between two wires, and of a steady arm along its length [N/m].

Large against the wires (about 1e5 N/m at a point) and small enough for double precision.
"""


class Bar(NamedTuple):
    """One connector; fields as in `Connectors`, coefficients by row."""

    station: int
    coefficient: dict[int, float]
    stiffness: float
    damping: float = 0.0
    preload: float = 0.0
    unilateral: bool = False


class Connectors(NamedTuple):
    """Connectors, droppers first, in the order of the line; N connectors, B rows."""

    station: Indices
    """Index of the station, (N,)."""
    coefficient: Array
    """Coefficient of each row's deflection in the elongation, (N, B) [-]."""
    stiffness: Array
    damping: Array
    """Coefficients of the elongation and its rate, (N,) [N/m, N s/m]."""
    preload: Array
    """Tension in the initial state, (N,) [N]."""
    unilateral: NDArray[np.bool_]
    """Whether the tension cannot be negative, (N,)."""


def build_connectors(catenary: Catenary, mesh: Mesh, beams: Beams, state: InitialState) -> Connectors:
    """Build droppers, clamps, springs and, with a lateral field, steady arms of a line.

    Each is in series with the residual flexibility of the wires at its ends.
    """
    bars = _droppers(catenary, mesh, state) + _clamps(catenary, mesh, state) + _springs(catenary, mesh)
    if catenary.has_lateral_field:
        bars += _transverse_droppers(catenary, mesh, state) + _steady_arms(catenary, mesh, state)
    coefficient = np.zeros((len(bars), mesh.rows))
    for n, bar in enumerate(bars):
        coefficient[n, list(bar.coefficient)] = list(bar.coefficient.values())
    station = np.array([bar.station for bar in bars], dtype=np.int64)
    unilateral = np.array([bar.unilateral for bar in bars], dtype=np.bool_)
    stiffness, damping = combine_in_series(
        np.array([bar.stiffness for bar in bars]),
        np.array([bar.damping for bar in bars]),
        *_end_flexibility(beams, station, coefficient, unilateral),
    )
    return Connectors(
        station=station,
        coefficient=coefficient,
        stiffness=stiffness,
        damping=damping,
        preload=np.array([bar.preload for bar in bars]),
        unilateral=unilateral,
    )


def _end_flexibility(
    beams: Beams, station: Indices, coefficient: Array, dropper: NDArray[np.bool_]
) -> tuple[Array, Array]:
    """Residual flexibility of the wires at the ends of N connectors, and its lag, (N,) each [m/N, m s/N].

    Droppers at one point of a wire, such as those of two contact wires, are loaded alike: each feels the sum.
    """
    at_station = np.array([station_flexibility(elements) for elements in beams.flexibility])[:, station].T
    places, place = np.unique(station[dropper], return_inverse=True)
    total = np.zeros((places.size, coefficient.shape[1]))
    np.add.at(total, place, coefficient[dropper])
    load = coefficient.copy()
    load[dropper] = total[place]
    ends = coefficient * load * at_station
    return np.asarray(ends.sum(axis=1)), np.asarray(ends @ beams.stiffness_coefficient)


def _coefficients(mesh: Mesh, upper: str, lower: str, direction: tuple[float, float]) -> dict[int, float]:
    """Coefficients, by row, of the elongation of a bar between two wires along a direction (y, z)."""
    y, z = direction
    ends = {mesh.row_of[upper, "z"]: z, mesh.row_of[lower, "z"]: -z}
    if (upper, "y") in mesh.row_of:
        ends |= {mesh.row_of[upper, "y"]: y, mesh.row_of[lower, "y"]: -y}
    return ends


def _droppers(catenary: Catenary, mesh: Mesh, state: InitialState) -> list[Bar]:
    """Unilateral bars along the droppers."""
    damping_time = catenary.rayleigh(Kind.DROPPER).stiffness_coefficient
    bars = []
    at_rest = (state.dropper_length.tolist(), state.dropper_direction.tolist(), state.dropper_tension.tolist())
    for dropper, length, (y, z), preload in zip(catenary.droppers, *at_rest, strict=True):
        stiffness = dropper.taut_stiffness(length)
        coefficient = _coefficients(mesh, dropper.upper, dropper.lower, (y, z))
        station = mesh.station(dropper.position)
        bars.append(Bar(station, coefficient, stiffness, damping_time * stiffness, preload, unilateral=True))
    return bars


def _clamps(catenary: Catenary, mesh: Mesh, state: InitialState) -> list[Bar]:
    """Rigid bars of the clamps, one per field."""
    directions = [(0.0, 1.0), (1.0, 0.0)] if catenary.has_lateral_field else [(0.0, 1.0)]
    return [
        Bar(
            mesh.station(clamp.position),
            _coefficients(mesh, clamp.upper, clamp.lower, (y, z)),
            RIGID,
            preload=float(state.clamp_force[n] @ (y, z)),
        )
        for n, clamp in enumerate(catenary.clamps)
        for y, z in directions
    ]


def _springs(catenary: Catenary, mesh: Mesh) -> list[Bar]:
    """Vertical bars of the springs between two wires."""
    return [
        Bar(
            mesh.station(spring.position),
            _coefficients(mesh, spring.upper, spring.lower, (0.0, 1.0)),
            spring.stiffness,
            spring.damping,
        )
        for spring in catenary.springs
    ]


def _transverse_droppers(catenary: Catenary, mesh: Mesh, state: InitialState) -> list[Bar]:
    """Transverse stiffness of the droppers: static tension over length."""
    droppers = zip(
        catenary.droppers, state.dropper_direction, state.dropper_tension / state.dropper_length, strict=True
    )
    return [
        Bar(mesh.station(d.position), _coefficients(mesh, d.upper, d.lower, (float(z), -float(y))), float(stiffness))
        for d, (y, z), stiffness in droppers
    ]


def _steady_arms(catenary: Catenary, mesh: Mesh, state: InitialState) -> list[Bar]:
    """Hinged bars, rigid along their length; their transverse stiffness is axial force over length."""
    damping_time = catenary.rayleigh(Kind.STEADY_ARM).stiffness_coefficient
    bars = []
    for arm, force in zip(catenary.steady_arms, state.arm_force, strict=True):
        station, rows = mesh.station(arm.position), [mesh.row_of[arm.wire, field] for field in "yz"]
        y, z, tension = arm_direction(arm, force)
        along = dict(zip(rows, (-y, -z), strict=True))
        bars.append(Bar(station, along, RIGID, preload=tension))
        stiffness = arm.transverse_stiffness(tension)
        if stiffness != 0.0:
            across = dict(zip(rows, (z, -y), strict=True))
            bars.append(Bar(station, across, stiffness, damping_time * abs(stiffness)))
    return bars


def arm_direction(arm: SteadyArm, force: Array) -> tuple[float, float, float]:
    """Direction (y, z) of a steady arm from the contact-wire clamp to the hinge, and its tension [N].

    A hinged bar lies along its force (y, z) on the contact wire [N]; its hinge carries its weight. The hinge of a
    pulling arm lies on the side to which the arm pulls, that of a pushing arm on the other side. The tension of a
    pushing arm is negative.
    """
    size = float(np.hypot(*force))
    if force[0] == 0.0:
        # Without a lateral force the bar is horizontal and carries no force.
        return 1.0, 0.0, 0.0
    sign = 1.0 if arm.acts == "pull" else -1.0
    return sign * float(force[0]) / size, sign * float(force[1]) / size, sign * size

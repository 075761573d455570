"""Numbers and positions of the mass points of a line: the points of every wire, then the hinges of the steady arms."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pantocheck.model import DiscretisedLine
from pantocheck.model.discretisation.connectors import arm_direction

# Arrays of the geometrically exact model: a line as mass points in space, joined by elastic wires, bars and springs.
#
# o---o---o---o---o---o    messenger wire: mass points, elastic segments, bending
#     |       |            droppers: bars that carry tension only
# o---o---o---o---o---o    contact wire
#                  `---x   steady arm: bar to a hinge, a mass point that is held
#
# Nothing is linearised: every force acts along the current direction of its segment or bar. Positions, velocities and
# forces are arrays (3, N) of the components x, y, z of N points.
Array = NDArray[np.float64]
Indices = NDArray[np.int64]


class Wires(NamedTuple):
    """Wires as chains of mass points; W wires."""

    first: Indices
    last: Indices
    """Mass points at the ends, (W,); the points of a wire are consecutive."""
    axial_stiffness: Array
    bending_stiffness: Array
    """EA [N] and EI [N m2], (W,)."""
    tension: Array
    """Tension at rest, which scales the stiffness-proportional damping, (W,) [N]."""
    spacing: Array
    """Distance of neighbouring points along the track at rest, (W,) [m]."""
    stiffness_coefficient: Array
    """Stiffness-proportional damping, (W,) [s]."""


class Bars(NamedTuple):
    """Massless bars between two points; B bars."""

    ends: Indices
    """Mass points at both ends, (B, 2)."""
    stiffness: Array
    length: Array
    """Axial stiffness [N/m] and unstretched length [m], (B,)."""
    axial_damping: Array
    rotational_damping: Array
    """Damping along the bar, and across it, (B,) [N s/m]."""
    unilateral: NDArray[np.bool_]
    """Whether the bar carries tension only, (B,)."""


class Springs(NamedTuple):
    """Springs and dampers from a point to the ground, one per direction; S springs."""

    point: Indices
    """Mass points, (S,)."""
    stiffness: Array
    damping: Array
    """Coefficients in x, y and z, (3, S) [N/m, N s/m]."""
    anchor: Array
    """Position without force, (3, S) [m]."""


class Strings(NamedTuple):
    """Wires with small slopes, as in the theory of the shallow cable; n segments in G groups with one tension each.

    The tension of a group changes with the elongation of its segments: a segment with the extent (dx, dy, dz) elongates
    by the sum of slope times extent and curvature times half the square of the extent.
    """

    point: Indices
    """First point of each segment, (n,); the second is the next one."""
    stiffness: Array
    """Constant tension over spacing, across the track, (3, n) [N/m]."""
    slope: Array
    """Linear coefficient of the elongation, (3, n) [-]."""
    curvature: Array
    """Quadratic coefficient of the elongation, (3, n) [1/m]."""
    group: Indices
    """Group of each segment, (n,)."""
    group_stiffness: Array
    group_length: Array
    """EA over length [N/m], and the sum of the elongations at rest [m], (G,)."""


class ExactLine(NamedTuple):
    """Line of N mass points."""

    mass: Array
    """Mass of each point, (N,) [kg]."""
    drag: Array
    """Mass-proportional damping of each point, (N,) [N s/m]."""
    free: Array
    """One where a point can move, zero where it is held, (3, N)."""
    unstretched: Array
    """Unstretched length of the segment between each point and the next of its wire, (N,) [m]."""
    gravity: float
    """Acceleration of gravity [m/s2]."""
    wires: Wires
    bars: Bars
    springs: Springs
    strings: Strings
    """Parts of the line; a wire whose tension is that of a string has no axial stiffness itself."""


def no_bars() -> Bars:
    """Bars of a line without bars."""
    nothing = np.zeros(0)
    return Bars(np.zeros((0, 2), dtype=np.int64), nothing, nothing, nothing, nothing, np.zeros(0, dtype=np.bool_))


def no_springs() -> Springs:
    """Springs of a line without springs."""
    nothing = np.zeros((3, 0))
    return Springs(np.zeros(0, dtype=np.int64), nothing, nothing, nothing)


def no_strings() -> Strings:
    """Strings of a line whose wires are all exact."""
    none, nothing = np.zeros(0, dtype=np.int64), np.zeros(0)
    return Strings(none, *(np.zeros((3, 0)) for _ in range(3)), none, nothing, nothing)


def unstretched_lengths(position: Array, wires: Wires) -> Array:
    """Unstretched length of every segment whose tension has the component T along the track [m].

    With this component the same in every segment, the points of a wire are in equilibrium along the track.
    """
    unstretched = np.ones(position.shape[1])
    for first, last, axial_stiffness, tension in zip(
        wires.first, wires.last, wires.axial_stiffness, wires.tension, strict=True
    ):
        segment = np.diff(position[:, first : last + 1])
        length = np.linalg.norm(segment, axis=0)
        strain = tension * length / segment[0] / axial_stiffness
        unstretched[first:last] = length / (1 + strain)
    return unstretched


def watched_points(line: DiscretisedLine, watched: tuple[tuple[str, float], ...]) -> Indices:
    """Points at wires and positions [m]."""
    return np.array([point_number(line, wire, x) for wire, x in watched], dtype=np.int64)


def support_points(line: DiscretisedLine) -> Indices:
    """Points of the messenger wires at their supports."""
    return watched_points(line, tuple((support.wire, support.position) for support in line.catenary.messenger_supports))


def point_number(line: DiscretisedLine, wire: str, position: float) -> int:
    """Number of the point of a wire at a position [m]."""
    names = [w.name for w in line.catenary.wires]
    return names.index(wire) * line.mesh.position.size + line.mesh.station(position)


def wire_positions(line: DiscretisedLine) -> Array:
    """Positions of the points of all wires in the static state [m]."""
    x, rows = line.mesh.position, line.mesh.row_of
    positions = []
    for wire in line.catenary.wires:
        y, z = (
            line.state.deflection[rows[wire.name, field], :, 0] if (wire.name, field) in rows else np.zeros_like(x)
            for field in "yz"
        )
        positions.append(np.stack([x, y, z]))
    return np.hstack(positions)


def hinge_positions(line: DiscretisedLine) -> Array:
    """Hinges of the steady arms; without a lateral field an arm is a spring and has none."""
    hinges = np.zeros((3, 0))
    if not line.catenary.has_lateral_field:
        return hinges
    points = wire_positions(line)
    for arm, force in zip(line.catenary.steady_arms, line.state.arm_force, strict=True):
        y, z, _ = arm_direction(arm, force)
        clamp = points[:, point_number(line, arm.wire, arm.position)]
        hinge = clamp + (arm.length or 1.0) * np.array([0.0, y, z])
        hinges = np.hstack([hinges, hinge[:, None]])
    return hinges

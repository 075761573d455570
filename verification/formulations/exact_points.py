"""Numbers and positions of the mass points of a line: the points of every wire, then the hinges of the steady arms."""

import numpy as np

from pantocheck.model import DiscretisedLine
from pantocheck.model.discretisation.connectors import arm_direction
from verification.formulations.exact_line import Array, Indices


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

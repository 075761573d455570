"""Geometrically exact model of a line: masses, unstretched lengths and directions from its static state."""

from typing import Literal

import numpy as np

from pantocheck.model import DiscretisedLine
from pantocheck.model.description.catenary import GRAVITY, Kind
from verification.formulations.exact_connections import build_bars, build_springs
from verification.formulations.exact_forces import allocate_scratch, sum_forces
from verification.formulations.exact_line import Array, ExactLine, Indices, Wires, no_strings, unstretched_lengths
from verification.formulations.exact_points import hinge_positions, point_number, support_points, wire_positions

AlongTrack = Literal["fixed", "free"]
"""Whether the messenger wire is held along the track at its supports."""


def build_exact_line(
    line: DiscretisedLine, axial_stiffness: dict[str, float], along_track: AlongTrack
) -> tuple[ExactLine, Array]:
    """Build the exact model of a line and the positions of its points in the linear static state.

    Args:
        line: Line with equidistant stations.
        axial_stiffness: EA of each wire by name [N].
        along_track: Support of the messenger wire along the track.

    Returns:
        Line, and positions, (3, N) [m].
    """
    wires = _build_wires(line, axial_stiffness)
    hinges = hinge_positions(line)
    position = np.hstack([wire_positions(line), hinges])
    mass, drag = _masses(line, hinges.shape[1])
    free = np.ones_like(position)
    free[:, wires.first], free[:, wires.last], free[:, position.shape[1] - hinges.shape[1] :] = 0.0, 0.0, 0.0
    supports = support_points(line)
    if along_track == "fixed":
        free[0, supports] = 0.0
    exact = ExactLine(
        mass=mass,
        drag=drag,
        free=free,
        unstretched=unstretched_lengths(position, wires),
        gravity=GRAVITY,
        wires=wires,
        bars=build_bars(line, position),
        springs=build_springs(line, position),
        strings=no_strings(),
    )
    return _carry_reactions(exact, position, supports), position


def _build_wires(line: DiscretisedLine, axial_stiffness: dict[str, float]) -> Wires:
    lengths, wires = np.diff(line.mesh.position), line.catenary.wires
    if np.ptp(lengths) > 1e-6:
        raise ValueError(f"elements of {lengths.min():g} m to {lengths.max():g} m; the exact model needs equal ones")
    first = lengths.size * np.arange(len(wires)) + np.arange(len(wires))
    return Wires(
        first=first,
        last=first + lengths.size,
        axial_stiffness=np.array([axial_stiffness[wire.name] for wire in wires]),
        bending_stiffness=np.array([wire.bending_stiffness for wire in wires]),
        tension=np.array([wire.tension for wire in wires]),
        spacing=np.full(len(wires), lengths.mean()),
        stiffness_coefficient=np.array([line.catenary.rayleigh(w.kind).stiffness_coefficient for w in wires]),
    )


def _masses(line: DiscretisedLine, hinges: int) -> tuple[Array, Array]:
    """Mass [kg] and mass-proportional damping [N s/m] of every point; a hinge has unit mass and is held."""
    stations, wires, h = line.mesh.position.size, line.catenary.wires, np.diff(line.mesh.position).mean()
    mass, drag = np.zeros(len(wires) * stations), np.zeros(len(wires) * stations)
    for n, wire in enumerate(wires):
        share = np.full(stations, h * wire.mass_per_length)
        share[[0, -1]] /= 2
        mass[n * stations : (n + 1) * stations] = share
        drag[n * stations : (n + 1) * stations] = line.catenary.rayleigh(wire.kind).mass_coefficient * share

    def lump(wire: str, x: float, m: float, kind: Kind) -> None:
        mass[point_number(line, wire, x)] += m
        drag[point_number(line, wire, x)] += line.catenary.rayleigh(kind).mass_coefficient * m

    for d in line.catenary.droppers:
        lump(d.upper, d.position, d.mass / 2 + d.upper_clamp_mass, Kind.DROPPER)
        lump(d.lower, d.position, d.mass / 2 + d.lower_clamp_mass, Kind.DROPPER)
    for arm in line.catenary.steady_arms:
        lump(arm.wire, arm.position, arm.mass, Kind.STEADY_ARM)
    return np.append(mass, np.ones(hinges)), np.append(drag, np.zeros(hinges))


def _carry_reactions(line: ExactLine, position: Array, supports: Indices) -> ExactLine:
    """Move the anchors of the supports so that their springs carry the forces of the static state."""
    force = np.zeros_like(position)
    sum_forces(line, position, np.zeros_like(position), force, allocate_scratch(line.mass.size))
    anchor = line.springs.anchor.copy()
    carried = np.isin(line.springs.point, supports) & (line.springs.stiffness > 0)
    anchor[carried] -= force[:, line.springs.point][carried] / line.springs.stiffness[carried]
    return line._replace(springs=line.springs._replace(anchor=anchor))

"""Connectors: what couples the rows of beams, each a bar with one elongation at one station.

A dropper is unilateral: its tension is max(0, N0 + k d + c d'), with the elongation d counted from the initial state. A
clamp is a stiff bilateral bar. The tension pulls every row by its coefficient: d = sum over rows of coefficient times
deflection, and the row feels minus the coefficient times the tension.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pantocheck.model.beams import Beams
from pantocheck.model.catenary import Catenary, Kind, Rayleigh
from pantocheck.model.initial_state import InitialState
from pantocheck.model.mesh import Mesh

Array = NDArray[np.float64]

# Stiff against the wires (about 1e5 N/m at a point) and yet far from the limits of double precision.
CLAMP_STIFFNESS = 1e8
"""Stiffness of a clamp between two wires [N/m]."""


class Connectors(NamedTuple):
    """Connectors, droppers first, in the order of the line; N connectors, B rows.

    Parameters
    ----------
    station : (N,) index
    coefficient : (N, B) of each row's deflection in the elongation [-]
    stiffness, damping : (N,) [N/m, N s/m]
    preload : (N,) tension in the initial state [N]
    unilateral : (N,) whether the tension cannot be negative
    """

    station: NDArray[np.int64]
    coefficient: Array
    stiffness: Array
    damping: Array
    preload: Array
    unilateral: NDArray[np.bool_]


def build_connectors(catenary: Catenary, mesh: Mesh, state: InitialState) -> Connectors:
    """Droppers and clamps of a line.

    Parameters
    ----------
    catenary : the line
    mesh : its stations and rows
    state : its initial state, which gives dropper tensions and lengths

    Returns
    -------
    the connectors
    """
    droppers, clamps = catenary.droppers, catenary.clamps
    count = len(droppers) + len(clamps)
    coefficient = np.zeros((count, mesh.rows))
    joints = [(d.position, d.upper, d.lower) for d in droppers] + [(c.position, c.upper, c.lower) for c in clamps]
    for n, (_, upper, lower) in enumerate(joints):
        coefficient[n, mesh.row_of[upper, "z"]] = 1.0
        coefficient[n, mesh.row_of[lower, "z"]] = -1.0
    stiffness = np.full(count, CLAMP_STIFFNESS)
    stiffness[: len(droppers)] = dropper_stiffness(catenary, state)
    damping = np.zeros(count)
    rayleigh = catenary.damping.get(Kind.DROPPER, Rayleigh())
    damping[: len(droppers)] = rayleigh.stiffness_coefficient * stiffness[: len(droppers)]
    return Connectors(
        station=np.array([mesh.station(position) for position, _, _ in joints], dtype=np.int64),
        coefficient=coefficient,
        stiffness=stiffness,
        damping=damping,
        preload=np.concatenate([state.dropper_tension, state.clamp_tension]),
        unilateral=np.arange(count) < len(droppers),
    )


def dropper_stiffness(catenary: Catenary, state: InitialState) -> Array:
    """Axial stiffness of each dropper while taut: as given, or EA over its length [N/m]."""
    return np.array(
        [
            dropper.stiffness if dropper.stiffness is not None else (dropper.axial_stiffness or 0.0) / length
            for dropper, length in zip(catenary.droppers, state.dropper_length, strict=True)
        ]
    )


def lump(catenary: Catenary, mesh: Mesh, beams: Beams) -> None:
    """Add masses, springs and dampers that act on one row at one station to the rows, in place.

    Parameters
    ----------
    catenary : the line
    mesh : its stations and rows
    beams : its rows of beams, lumped arrays changed in place
    """
    undamped = Rayleigh()

    def add(kind: Kind, wire: str, position: float, mass: float, stiffness: float, damping: float) -> None:
        row, at, rayleigh = mesh.row_of[wire, "z"], mesh.station(position), catenary.damping.get(kind, undamped)
        beams.lumped_mass[row, at] += mass
        beams.lumped_stiffness[row, at] += stiffness
        beams.lumped_damping[row, at] += (
            damping + rayleigh.mass_coefficient * mass + rayleigh.stiffness_coefficient * stiffness
        )

    for dropper in catenary.droppers:
        half = dropper.mass / 2
        add(Kind.DROPPER, dropper.upper, dropper.position, half + dropper.upper_clamp_mass, 0.0, 0.0)
        add(Kind.DROPPER, dropper.lower, dropper.position, half + dropper.lower_clamp_mass, 0.0, 0.0)
    for clamp in catenary.clamps:
        add(Kind.DROPPER, clamp.upper, clamp.position, clamp.mass, 0.0, 0.0)
    for arm in catenary.steady_arms:
        add(Kind.STEADY_ARM, arm.wire, arm.position, arm.mass, arm.vertical_stiffness or 0.0, arm.vertical_damper)
    for support in catenary.messenger_supports:
        add(Kind.MESSENGER_SUPPORT, support.wire, support.position, 0.0, support.stiffness, support.damping)

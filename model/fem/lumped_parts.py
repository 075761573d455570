"""Lumped parts: masses, springs and dampers that act on a single row at a single station.

Droppers, clamps and point masses contribute their masses, steady arms and messenger supports also stiffness and
damping.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from pantocheck.model.arrays import Array
from pantocheck.model.catenary import Catenary, Kind
from pantocheck.model.fem.mesh import Mesh


class LumpedPart(NamedTuple):
    """Mass, spring and damper at a position on a row [m, kg, N/m, N s/m]."""

    kind: Kind
    row: int
    position: float
    mass: float
    stiffness: float = 0.0
    damping: float = 0.0


def sum_lumped_parts(catenary: Catenary, mesh: Mesh) -> tuple[Array, Array, Array]:
    """Sum mass, stiffness and damping of the lumped parts at each station, (B, S) each [kg, N/m, N s/m].

    The damping includes the Rayleigh damping of the kind of each part.
    """
    mass, stiffness, damping = (np.zeros((mesh.rows, mesh.position.size)) for _ in range(3))
    for part in _lumped_parts(catenary, mesh):
        station, rayleigh = mesh.station(part.position), catenary.rayleigh(part.kind)
        mass[part.row, station] += part.mass
        stiffness[part.row, station] += part.stiffness
        damping[part.row, station] += (
            part.damping + rayleigh.mass_coefficient * part.mass + rayleigh.stiffness_coefficient * part.stiffness
        )
    return mass, stiffness, damping


def _lumped_parts(catenary: Catenary, mesh: Mesh) -> Iterator[LumpedPart]:
    """Lumped parts of every field; steady arms have springs and dampers in the vertical field only."""
    for field in dict.fromkeys(mesh.row_field):
        for dropper in catenary.droppers:
            half = dropper.mass / 2
            upper, lower = mesh.row_of[dropper.upper, field], mesh.row_of[dropper.lower, field]
            yield LumpedPart(Kind.DROPPER, upper, dropper.position, half + dropper.upper_clamp_mass)
            yield LumpedPart(Kind.DROPPER, lower, dropper.position, half + dropper.lower_clamp_mass)
        for clamp in catenary.clamps:
            yield LumpedPart(Kind.DROPPER, mesh.row_of[clamp.upper, field], clamp.position, clamp.mass)
        for arm in catenary.steady_arms:
            yield LumpedPart(Kind.STEADY_ARM, mesh.row_of[arm.wire, field], arm.position, arm.mass)
        for support in catenary.messenger_supports:
            row = mesh.row_of[support.wire, field]
            yield LumpedPart(Kind.MESSENGER_SUPPORT, row, support.position, 0.0, support.stiffness, support.damping)
        for mass in catenary.point_masses:
            kind, row = catenary.wire(mass.wire).kind, mesh.row_of[mass.wire, field]
            yield LumpedPart(kind, row, mass.position, mass.mass)
    for arm in catenary.steady_arms:
        row, stiffness = mesh.row_of[arm.wire, "z"], arm.vertical_stiffness or 0.0
        yield LumpedPart(Kind.STEADY_ARM, row, arm.position, 0.0, stiffness, arm.vertical_damper)

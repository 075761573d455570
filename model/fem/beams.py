"""Rows of tensioned beams, and the lumped masses, springs and dampers on a single row at a single station.

Droppers, clamps and point masses contribute their masses, steady arms and messenger supports also stiffness and
damping.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import scipy  # loads its parts when they are used
from numpy.typing import NDArray

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.catenary import Catenary, Kind
from pantocheck.model.fem import beam
from pantocheck.model.fem.mesh import Mesh
from pantocheck.model.fem.residual_flexibility import combine_in_series, element_flexibility, station_flexibility


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
    coefficients = {kind: catenary.rayleigh(kind) for kind in Kind}
    for part in _lumped_parts(catenary, mesh):
        station, rayleigh = mesh.station(part.position), coefficients[part.kind]
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


# Rows of tensioned beams as plain arrays, shared by statics and time integration.
#
# Parts that act on a single row at a single station are lumped onto the deflection there (`sum_lumped_parts`); parts
# that couple rows are connectors (`connectors`).
class Beams(NamedTuple):
    """Rows of beams; B rows, S stations."""

    length: Array
    """Lengths of the elements, (S-1,) [m]."""
    tension: Array
    bending_stiffness: Array
    mass_per_length: Array
    """Properties of each element, zero where the row has no wire, (B, S-1) [N, N m2, kg/m]."""
    lumped_mass: Array
    lumped_stiffness: Array
    lumped_damping: Array
    """Lumped parts on the deflections, (B, S); springs and dampers are in series with the residual flexibility
    [kg, N/m, N s/m].
    """
    mass_coefficient: Array
    stiffness_coefficient: Array
    """Rayleigh damping of the wires, (B,) [1/s, s]."""
    free: NDArray[np.bool_]
    """Whether deflection and slope can move, (B, S, 2)."""
    flexibility: Array
    """Residual flexibility of each element, see `element_flexibility`, (B, S-1, 7) [m/N]."""


def build_beams(catenary: Catenary, mesh: Mesh, known: Beams | None = None) -> Beams:
    """Build wires and lumped parts as rows of beams; `known` has the flexibility of equal wires, on the mesh."""
    stations = mesh.position.size
    length = np.diff(mesh.position)
    middle = mesh.position[:-1] + length / 2
    tension, bending_stiffness, mass_per_length = (np.zeros((mesh.rows, stations - 1)) for _ in range(3))
    free = np.zeros((mesh.rows, stations, 2), dtype=np.bool_)
    for (name, _field), row in mesh.row_of.items():
        wire = catenary.wire(name)
        inside = (wire.start < middle) & (middle < wire.end)
        tension[row, inside] = wire.tension
        for change in wire.tension_changes:
            tension[row, (change.start < middle) & (middle < change.end)] += change.change
        bending_stiffness[row, inside] = wire.bending_stiffness
        mass_per_length[row, inside] = wire.mass_per_length
        for stretch in wire.section_changes:
            changed = (stretch.start < middle) & (middle < stretch.end)
            mass_per_length[row, changed] += stretch.mass_per_length
            bending_stiffness[row, changed] += stretch.bending_stiffness
        first, last = mesh.station(wire.start), mesh.station(wire.end)
        free[row, first : last + 1] = True
        if wire.kind is not Kind.STITCH_WIRE:  # a stitch wire ends in clamps, not in anchors
            free[row, [first, last], 0] = False
    flexibility = _flexibility_of_rows(mesh, length, tension, bending_stiffness, known)
    at_station = np.array([station_flexibility(elements) for elements in flexibility])
    lumped_mass, lumped_stiffness, lumped_damping = sum_lumped_parts(catenary, mesh)
    rayleigh = [catenary.rayleigh(kind) for kind in mesh.row_kind]
    stiffness_coefficient = np.array([r.stiffness_coefficient for r in rayleigh])
    lag = stiffness_coefficient[:, None] * at_station
    return Beams(
        length,
        tension,
        bending_stiffness,
        mass_per_length,
        lumped_mass,
        *combine_in_series(lumped_stiffness, lumped_damping, at_station, lag),
        mass_coefficient=np.array([r.mass_coefficient for r in rayleigh]),
        stiffness_coefficient=stiffness_coefficient,
        free=free,
        flexibility=flexibility,
    )


def _flexibility_of_rows(
    mesh: Mesh, length: Array, tension: Array, bending_stiffness: Array, known: Beams | None
) -> Array:
    """Residual flexibility of every element of all rows; a lateral row has the wires of its vertical row."""

    def compute_row(row: int) -> Array:
        wire = (tension[row], bending_stiffness[row])
        if known is not None and np.array_equal(wire, (known.tension[row], known.bending_stiffness[row])):
            return np.asarray(known.flexibility[row])
        return element_flexibility(length, *wire)

    fields = len(set(mesh.row_field))
    return np.array([compute_row(row) for row in range(mesh.rows // fields)] * fields)


def element_stiffness(beams: Beams, row: int) -> Array:
    """Stiffness of every element of one row, (S-1, 4, 4)."""
    return beam.stiffness(beams.length, beams.tension[row], beams.bending_stiffness[row])


def wire_stiffness(beams: Beams, row: int) -> "scipy.sparse.csr_array":
    """Stiffness of the wires of one row, (2 S, 2 S), unknowns (w, r) by station; without lumped parts and supports."""
    return assemble_row(element_stiffness(beams, row))


def assemble_row(elements: Array) -> "scipy.sparse.csr_array":
    """Assemble the element matrices of a row, (S-1, 4, 4), to a matrix of its unknowns (w, r) by station."""
    unknowns = 2 * np.arange(len(elements))[:, None] + np.arange(4)
    indices = (np.repeat(unknowns, 4, axis=1).ravel(), np.tile(unknowns, (1, 4)).ravel())
    matrix = scipy.sparse.csr_array((elements.ravel(), indices), shape=(2 * len(elements) + 2,) * 2)
    matrix.eliminate_zeros()  # an element without a wire has neither stiffness nor mass
    return matrix


def weight(beams: Beams, row: int, gravity: float) -> Array:
    """Weight of the wires of one row as nodal forces, (2 S,), negative downwards [N, N m]; gravity in [m/s2]."""
    return -load_row(beam.uniform_load(beams.length, beams.mass_per_length[row] * gravity))


def load_row(elements: Array) -> Array:
    """Assemble the nodal forces of the elements of a row, (S-1, 4), to those of its unknowns (w, r) by station."""
    force = np.zeros((len(elements) + 1, 2))
    force[:-1] += elements[:, :2]
    force[1:] += elements[:, 2:]
    return force.ravel()

"""Rows of tensioned beams as plain arrays, the form in which statics and the time integration share them.

Everything that acts on a single row at a single station (clamps, steady arms, messenger supports) is lumped onto the
deflection there; everything that couples rows is a connector (`connectors`).
"""

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from pantocheck.model.arrays import Array
from pantocheck.model.catenary import Catenary, Kind, Rayleigh
from pantocheck.model.fem import beam
from pantocheck.model.fem.mesh import Mesh


class Beams(NamedTuple):
    """Rows of beams; B rows, S stations.

    Parameters
    ----------
    length : (S-1,) ndarray
        Of the elements [m].
    tension, bending_stiffness, mass_per_length : (B, S-1) ndarray
        Per element, zero where the row has no wire [N, N m2, kg/m].
    lumped_mass, lumped_stiffness, lumped_damping : (B, S) ndarray
        On the deflection [kg, N/m, N s/m].
    mass_coefficient, stiffness_coefficient : (B,) ndarray
        Rayleigh damping of the wires [1/s, s].
    free : (B, S, 2) ndarray
        Whether deflection and slope can move.
    """

    length: Array
    tension: Array
    bending_stiffness: Array
    mass_per_length: Array
    lumped_mass: Array
    lumped_stiffness: Array
    lumped_damping: Array
    mass_coefficient: Array
    stiffness_coefficient: Array
    free: NDArray[np.bool_]


def build_beams(catenary: Catenary, mesh: Mesh) -> Beams:
    """The wires of a line as rows of beams.

    Parameters
    ----------
    catenary : Catenary
        The line.
    mesh : Mesh
        Its stations and rows.

    Returns
    -------
    Beams
        The rows; what acts on a single row at a single station is lumped onto them by `connectors.lump`.
    """
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
        first, last = mesh.station(wire.start), mesh.station(wire.end)
        free[row, first : last + 1] = True
        if wire.kind is not Kind.STITCH_WIRE:  # a stitch wire ends in clamps, not in anchors
            free[row, [first, last], 0] = False
    undamped = Rayleigh()
    rayleigh = [catenary.damping.get(kind, undamped) for kind in mesh.row_kind]
    return Beams(
        length,
        tension,
        bending_stiffness,
        mass_per_length,
        lumped_mass=np.zeros((mesh.rows, stations)),
        lumped_stiffness=np.zeros((mesh.rows, stations)),
        lumped_damping=np.zeros((mesh.rows, stations)),
        mass_coefficient=np.array([r.mass_coefficient for r in rayleigh]),
        stiffness_coefficient=np.array([r.stiffness_coefficient for r in rayleigh]),
        free=free,
    )


def wire_matrices(beams: Beams, row: int) -> tuple[sp.csr_array, sp.csr_array]:
    """Stiffness and consistent mass of the wires of one row, unknowns (w, r) by station, nothing lumped or held.

    Parameters
    ----------
    beams : Beams
        The rows.
    row : int
        Which one.

    Returns
    -------
    stiffness, mass : (2 S, 2 S) ndarray
    """
    mass = beam.mass(beams.length, beams.mass_per_length[row])
    return by_station(element_stiffness(beams, row)), by_station(mass)


def by_station(elements: Array) -> sp.csr_array:
    """Matrices of a row's elements, (S-1, 4, 4), added up to one of its unknowns (w, r) by station, (2 S, 2 S)."""
    at = 2 * np.arange(len(elements))[:, None] + np.arange(4)
    place = (np.repeat(at, 4, axis=1).ravel(), np.tile(at, (1, 4)).ravel())
    matrix = sp.csr_array((elements.ravel(), place), shape=(2 * len(elements) + 2,) * 2)
    matrix.eliminate_zeros()  # an element without a wire has neither stiffness nor mass
    return matrix


def element_stiffness(beams: Beams, row: int) -> Array:
    """Stiffness of every element of one row, (S-1, 4, 4)."""
    return beam.stiffness(beams.length, beams.tension[row], beams.bending_stiffness[row])


def wire_stiffness(beams: Beams, row: int) -> sp.csr_array:
    """Stiffness of the wires of one row; as in `wire_matrices`."""
    return wire_matrices(beams, row)[0]


def weight(beams: Beams, row: int, gravity: float) -> Array:
    """Weight of the wires of one row as nodal forces, downwards negative.

    Parameters
    ----------
    beams : Beams
        The rows.
    row : int
        Which one.
    gravity : float
        [m/s2].

    Returns
    -------
    (2 S,) ndarray
        [N, N m].
    """
    force = np.zeros(2 * beams.free.shape[1])
    for e in np.flatnonzero(beams.mass_per_length[row]):
        force[2 * e : 2 * e + 4] -= beam.uniform_load(beams.length[e], beams.mass_per_length[row, e] * gravity)
    return force

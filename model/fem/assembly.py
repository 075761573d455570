"""Global sparse matrices of a line: what statics, modes and independent checks solve with.

Unknowns are ordered station by station with the rows interleaved, (w, r) each, so that the matrices are banded.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from pantocheck.model.arrays import Array, Indices
from pantocheck.model.discretised_line import DiscretisedLine
from pantocheck.model.dynamics.mass_correction import mass_correction
from pantocheck.model.fem import beam
from pantocheck.model.fem.beams import by_station, wire_matrices
from pantocheck.model.fem.mesh import find_element
from pantocheck.model.fem.residual_flexibility import condensed_bubbles, local_flexibility


@dataclass(frozen=True)
class GlobalMatrices:
    """Matrices of the free unknowns with every dropper taut.

    Parameters
    ----------
    mass, damping, stiffness : sp.csc_array
        (n, n).
    free : (n,) ndarray
        Index of each kept unknown among all of them.
    """

    mass: sp.csc_array
    damping: sp.csc_array
    stiffness: sp.csc_array
    free: Indices


def unknown(line: DiscretisedLine, row: int, station: int, slope: int = 0) -> int:
    """Index of an unknown among all of them."""
    return 2 * (station * line.mesh.rows + row) + slope


def bandwidth_order(line: DiscretisedLine) -> Indices:
    """For every unknown in global order, its place in a (rows, stations, 2) array laid flat."""
    rows, stations = line.mesh.rows, line.mesh.position.size
    return np.arange(rows * stations * 2).reshape(rows, stations, 2).transpose(1, 0, 2).ravel()


def free_unknowns(line: DiscretisedLine) -> Indices:
    """Indices of the unknowns that can move and that some wire carries."""
    carried = np.zeros_like(line.beams.free)
    present = line.beams.mass_per_length > 0
    carried[:, :-1] |= present[:, :, None]
    carried[:, 1:] |= present[:, :, None]
    return np.flatnonzero((line.beams.free & carried).ravel()[bandwidth_order(line)])


def assemble_matrices(line: DiscretisedLine) -> GlobalMatrices:
    """Mass, damping and stiffness of the line with every dropper taut.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.

    Returns
    -------
    GlobalMatrices
        Matrices of the free unknowns.
    """
    beams, free = line.beams, free_unknowns(line)
    wires = [wire_matrices(beams, row) for row in range(line.mesh.rows)]
    place = bandwidth_order(line)
    stiffness = sp.block_diag([k for k, _ in wires], format="csr")
    mass = sp.block_diag([m for _, m in wires], format="csr")
    damping = sp.block_diag(
        [
            a * k + b * m
            for (k, m), a, b in zip(wires, beams.stiffness_coefficient, beams.mass_coefficient, strict=True)
        ],
        format="csr",
    )
    joint = connector_directions(line)

    def keep(wire: sp.csr_array, lumped: Array, connector: Array) -> sp.csc_array:
        on_deflections = np.stack([lumped, np.zeros_like(lumped)], axis=-1).ravel()
        whole = (wire + sp.diags_array(on_deflections))[place][:, place] + joint @ sp.diags_array(connector) @ joint.T
        return sp.csc_array(whole[free][:, free])

    return GlobalMatrices(
        mass=keep(mass, beams.lumped_mass, np.zeros_like(line.connectors.stiffness)),
        damping=keep(damping, beams.lumped_damping, line.connectors.damping),
        stiffness=keep(stiffness, beams.lumped_stiffness, line.connectors.stiffness),
        free=free,
    )


def stepping_mass(line: DiscretisedLine, time_step: float) -> sp.csc_array:
    """Mass of the line that a time step works with, see `dispersion`; for steps that are written out plainly.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.
    time_step : float
        [s].

    Returns
    -------
    sp.csc_array
        (n, n) for the free unknowns [kg].
    """
    rows = range(line.mesh.rows)
    taken = sp.block_diag([by_station(mass_correction(line.beams, row, time_step)) for row in rows], format="csr")
    matrices, place = assemble_matrices(line), bandwidth_order(line)
    return sp.csc_array(matrices.mass - taken[place][:, place][matrices.free][:, matrices.free])


def connector_directions(line: DiscretisedLine) -> sp.csr_array:
    """Elongation of each connector per unknown, over all unknowns: (unknowns, connectors)."""
    connectors = line.connectors
    number, row = np.nonzero(connectors.coefficient)
    at = [unknown(line, int(r), int(connectors.station[n])) for n, r in zip(number, row, strict=True)]
    size = line.beams.free.size
    return sp.csr_array((connectors.coefficient[number, row], (at, number)), shape=(size, len(connectors.station)))


def point_load(line: DiscretisedLine, row: int, position: float) -> Array:
    """Unknowns' shares in the deflection of one row at any place; as a load: a unit force there.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.
    row : int
        Which row.
    position : float
        [m].

    Returns
    -------
    (unknowns,) ndarray
        [-, m].
    """
    element, length, s = find_element(line.mesh.position, position)
    share = np.zeros(line.beams.free.size)
    n = beam.shape(s, length)
    for i in range(2):
        share[unknown(line, row, element + i, 0)] = n[2 * i]
        share[unknown(line, row, element + i, 1)] = n[2 * i + 1]
    return share


def contact_stiffness(line: DiscretisedLine, row: int, position: float, penalty: float) -> float:
    """Penalty and local flexibility of the element under a place, in series: what a step written out plainly needs.

    Parameters
    ----------
    line : DiscretisedLine
        The discretised line.
    row : int
        Of a contact wire.
    position : float
        [m].
    penalty : float
        Stiffness of the contact [N/m].

    Returns
    -------
    float
        [N/m].
    """
    beams = line.beams
    element, length, s = find_element(line.mesh.position, position)
    tension, bending_stiffness = float(beams.tension[row, element]), float(beams.bending_stiffness[row, element])
    return 1 / (1 / penalty + local_flexibility(condensed_bubbles(length, tension, bending_stiffness), s))

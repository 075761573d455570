"""Global sparse matrices of a line, for statics, modes and independent checks.

Unknowns are ordered station by station with the rows interleaved, (w, r) each, so that the matrices are banded.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from pantocheck.model.fem import beam
from pantocheck.model.fem.beams import assemble_row
from pantocheck.model.fem.mass_correction import mass_correction
from pantocheck.model.fem.mesh import find_element
from pantocheck.model.fem.residual_flexibility import residual_flexibility


@dataclass(frozen=True)
class GlobalMatrices:
    """Matrices (n, n) of the free unknowns with every dropper taut and all tensions constant.

    Each is assembled when it is read [kg, N s/m, N/m; slopes accordingly].
    """

    line: DiscretisedLine

    @cached_property
    def free(self) -> Indices:
        """Indices of the free unknowns among all, (n,)."""
        return free_unknowns(self.line)

    @cached_property
    def mass(self) -> sp.csc_array:
        """Mass of wires and lumped parts."""
        connectors = np.zeros_like(self.line.connectors.stiffness)
        return self._assemble(self._masses, self.line.beams.lumped_mass, connectors)

    @cached_property
    def damping(self) -> sp.csc_array:
        """Damping of wires, lumped parts and connectors."""
        beams = self.line.beams
        wires = self._stiffnesses * beams.stiffness_coefficient[:, None, None, None]
        wires += self._masses * beams.mass_coefficient[:, None, None, None]
        return self._assemble(wires, beams.lumped_damping, self.line.connectors.damping)

    @cached_property
    def stiffness(self) -> sp.csc_array:
        """Stiffness of wires, lumped parts and connectors."""
        return self._assemble(self._stiffnesses, self.line.beams.lumped_stiffness, self.line.connectors.stiffness)

    @property
    def _masses(self) -> Array:
        return beam.mass(self.line.beams.length, self.line.beams.mass_per_length)

    @property
    def _stiffnesses(self) -> Array:
        return beam.stiffness(self.line.beams.length, self.line.beams.tension, self.line.beams.bending_stiffness)

    def _assemble(self, wires: Array, lumped: Array, connector: Array) -> sp.csc_array:
        """Sum of wires (rows, elements, 4, 4), lumped parts (rows, stations) and connectors for the free unknowns."""
        place: Indices = np.full(self.line.beams.free.shape, -1)
        place.ravel()[bandwidth_order(self.line)[self.free]] = np.arange(self.free.size)
        coefficient, station = self.line.connectors.coefficient, self.line.connectors.station
        ends, bars = np.concatenate([place[:, :-1], place[:, 1:]], axis=-1), place[:, station, 0].T
        parts = [
            (wires, ends[..., None], ends[..., None, :]),
            (lumped, place[..., 0], place[..., 0]),
            (connector[:, None, None] * coefficient[..., None] * coefficient[:, None], bars[..., None], bars[:, None]),
        ]
        value, row, column = (
            np.concatenate([np.broadcast_to(part[n], part[0].shape).ravel() for part in parts]) for n in range(3)
        )
        free = (row >= 0) & (column >= 0)
        matrix = sp.csc_array((value[free], (row[free], column[free])), shape=(self.free.size,) * 2)
        matrix.eliminate_zeros()  # an element without a wire has neither stiffness nor mass
        return matrix


def _unknowns(line: DiscretisedLine, row: int | Indices, station: Indices, slope: int | Indices = 0) -> Indices:
    """Indices of unknowns in global order."""
    return 2 * (station * line.mesh.rows + row) + slope


def bandwidth_order(line: DiscretisedLine) -> Indices:
    """Index of every unknown, in global order, in a flattened (rows, stations, 2) array."""
    rows, stations = line.mesh.rows, line.mesh.position.size
    return np.arange(rows * stations * 2).reshape(rows, stations, 2).transpose(1, 0, 2).ravel()


def free_unknowns(line: DiscretisedLine) -> Indices:
    """Indices of the unknowns that can move and belong to a wire."""
    carried = np.zeros_like(line.beams.free)
    present = line.beams.mass_per_length > 0
    carried[:, :-1] |= present[:, :, None]
    carried[:, 1:] |= present[:, :, None]
    return np.flatnonzero((line.beams.free & carried).ravel()[bandwidth_order(line)])


def assemble_matrices(line: DiscretisedLine) -> GlobalMatrices:
    """Mass, damping and stiffness of the line with every dropper taut."""
    return GlobalMatrices(line)


def correct_mass(line: DiscretisedLine, time_step: float) -> sp.csc_array:
    """Corrected mass of the free unknowns in a time step [s] (`mass_correction`), for independent solvers [kg]."""
    rows = range(line.mesh.rows)
    correction = sp.block_diag([assemble_row(mass_correction(line.beams, r, time_step)) for r in rows], format="csr")
    matrices, order = assemble_matrices(line), bandwidth_order(line)
    return sp.csc_array(matrices.mass - correction[order][:, order][matrices.free][:, matrices.free])


def connector_directions(line: DiscretisedLine) -> sp.csr_array:
    """Elongation of each connector per unknown, (unknowns, connectors)."""
    connectors = line.connectors
    number, row = np.nonzero(connectors.coefficient)
    indices = (_unknowns(line, row, connectors.station[number]), number)
    shape = (line.beams.free.size, connectors.station.size)
    return sp.csr_array((connectors.coefficient[number, row], indices), shape=shape)


def stretch_directions(line: DiscretisedLine) -> sp.csr_array:
    """Elongation of each held stretch per unknown, (unknowns, stretches)."""
    stretches = line.stretches
    number, field, station, slope = np.nonzero(stretches.coefficient)
    unknown = _unknowns(line, stretches.row[number, field], stretches.first[number] + station, slope)
    shape = (line.beams.free.size, stretches.first.size)
    return sp.csr_array((stretches.coefficient[number, field, station, slope], (unknown, number)), shape=shape)


def point_load(line: DiscretisedLine, row: int, position: float) -> Array:
    """Shape functions of one row at a position.

    Their product with the unknowns is the deflection there; they are also the nodal forces of a unit force.

    Args:
        line: Discretised line.
        row: Index of the row.
        position: Position along the track [m].

    Returns:
        Value of the shape function of every unknown, in global order, (unknowns,) [-, m].
    """
    element, length, s = find_element(line.mesh.position, position)
    share = np.zeros(line.beams.free.size)
    unknowns = _unknowns(line, row, element + np.arange(2)[:, None], np.arange(2))
    share[unknowns] = beam.shape(s, length).reshape(2, 2)
    return share


def contact_stiffness(line: DiscretisedLine, row: int, position: float, penalty: float) -> float:
    """Contact stiffness at a position, for independent solvers: penalty and residual flexibility in series.

    Args:
        line: Discretised line.
        row: Row of the contact wire.
        position: Position along the track [m].
        penalty: Stiffness of the penalty contact [N/m].

    Returns:
        Stiffness [N/m].
    """
    element, _, s = find_element(line.mesh.position, position)
    return 1 / (1 / penalty + residual_flexibility(line.beams.flexibility[row, element], s))

"""Responses of a line with taut droppers to unit forces at many points, by selected inversion of its stiffness.

The unknowns of a station are a block x_i, and the stiffness K is block tridiagonal. Elimination of all stations on the
left, and of all on the right, leaves the Schur complements A_i and B_i. The blocks of the inverse follow from them::

    (K^-1)_ii = (A_i + B_i - K_ii)^-1
    x_(i+1) = -B_(i+1)^-1 K_(i+1)i x_i      on the right of a force
    x_i = -A_i^-1 K_(i+1)i' x_(i+1)         on its left

A response is carried from station to station until it lies below rounding: a few spans on each side of the force.
"""

from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.description.failures import NoEquilibrium
from pantocheck.model.discretisation.connectors import Connectors
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, keep_with_line
from pantocheck.model.fem.beams import element_stiffness
from pantocheck.model.statics.assembly import free_unknowns, stretch_directions


# Stiffness of a line with every dropper taut, factored as a band matrix.
#
# In global order (station by station, rows interleaved) an element couples unknowns at most 2 B + 1 places apart, and a
# connector those of one station. The matrix is symmetric, and positive definite about a stable equilibrium. Its
# Cholesky factor has the same band and takes a small part of the time of a general sparse factor.
#
# Held stretches add k a a' each, with a vector a as long as the stretch. They enter by the Woodbury identity, so that
# the band remains narrow.
class LineStiffness:
    """Factored stiffness K of a line in global order, with the stiffness of held stretches.

    Args:
        line: Discretised line.

    Raises:
        NoEquilibrium: The line is not stable.
    """

    def __init__(self, line: DiscretisedLine) -> None:
        self.movable = np.zeros(line.beams.free.size)
        """One for every movable unknown, zero for the others."""
        self.movable[free_unknowns(line)] = 1.0
        self.band = _stiffness_band(line, self.movable)
        """Lower half of K without held stretches: entry (d, u) couples the unknowns u and u + d."""
        try:
            self.factor = cholesky_banded(self.band, lower=True, check_finite=False)
            """Its Cholesky factor in the same form."""
        except LinAlgError:
            raise NoEquilibrium("the line at rest is not stable: its stiffness is not positive definite") from None
        self._stretches = stretch_directions(line)
        self.stretch_columns = self._solve_band(self._stretches.toarray())
        """Displacements under a unit tension of each held stretch, (n, stretches)."""
        self.stretch_flexibility = np.diag(1 / line.stretches.stiffness) + self._stretches.T @ self.stretch_columns
        """Flexibility of the stretches, with that of the line between their ends, (stretches, stretches) [m/N]."""

    def solve(self, force: Array) -> Array:
        """Solve K x = f.

        Args:
            force: Forces and moments on all unknowns in global order, (n,) or (n, m) [N, N m]; those on fixed unknowns
                have no effect.

        Returns:
            Deflections and slopes, (n,) or (n, m) [m, -], zero at fixed unknowns.
        """
        displacement = self._solve_band(force)
        if self.stretch_flexibility.size == 0:
            return displacement
        tension = np.linalg.solve(self.stretch_flexibility, self._stretches.T @ displacement)
        return displacement - self.stretch_columns @ tension

    def _solve_band(self, force: Array) -> Array:
        """Solution without held stretches."""
        movable = (force.T * self.movable).T
        return np.asarray(cho_solve_banded((self.factor, True), movable, check_finite=False))


@keep_with_line
def factored_stiffness(line: DiscretisedLine) -> LineStiffness:
    """Factored stiffness of a line, built once."""
    return LineStiffness(line)


def _stiffness_band(line: DiscretisedLine, movable: Array) -> Array:
    """Lower half of the stiffness; fixed unknowns have the identity."""
    beams, connectors, rows = line.beams, line.connectors, line.mesh.rows
    stations = line.mesh.position.size
    band = np.zeros((2 * rows + 2, stations, rows, 2))
    for row in range(rows):
        element = element_stiffness(beams, row)
        for i, j in np.transpose(np.tril_indices(4)):
            (node_i, slope_i), (node_j, slope_j) = divmod(i, 2), divmod(j, 2)
            distance = 2 * rows * (node_i - node_j) + slope_i - slope_j
            band[distance, node_j : stations - 1 + node_j, row, slope_j] += element[:, i, j]
    band[0, :, :, 0] += beams.lumped_stiffness.T
    for lower, upper in combinations_with_replacement(range(rows), 2):
        coupling = connectors.stiffness * connectors.coefficient[:, lower] * connectors.coefficient[:, upper]
        np.add.at(band[2 * (upper - lower), :, lower, 0], connectors.station, coupling)
    flat: Array = band.reshape(len(band), -1)
    for distance in range(len(band)):
        flat[distance, : movable.size - distance] *= movable[: movable.size - distance] * movable[distance:]
    flat[0] += 1 - movable
    return flat


# Responses of a line with taut droppers to unit forces at many points, by selected inversion of its stiffness.
NEGLIGIBLE = 1e-16
"""Size of a response over its size at the force, below which it ends."""


@dataclass(frozen=True)
class UnitResponses:
    """Responses to unit forces, each at its own point."""

    flexibility: Array
    """Deflection at each force, in its direction, (n,) [m/N]."""
    connectors: Indices
    """Connectors that one of the forces elongates, (m,)."""
    elongation: Array
    """Their elongations, (n, m) [m/N]."""


@dataclass(frozen=True)
class BlockInverse:
    """Blocks of the inverse of a stiffness without held stretches, and transfers of a response to the next station.

    It does not refer to its line, which keeps it: the memory of a line that is no longer used is free at once.
    """

    stiffness: LineStiffness
    """Stiffness with its held stretches."""
    connectors: Connectors
    """Connectors of the line."""
    diagonal: Array
    """Inverse between the unknowns of each station, (stations, b, b)."""
    to_right: Array
    to_left: Array
    """Transfers to the right and to the left neighbour, (stations - 1, b, b)."""


@keep_with_line
def invert_blocks(line: DiscretisedLine) -> BlockInverse:
    """Invert the stiffness of a line block by block, once."""
    size, stiffness = 2 * line.mesh.rows, factored_stiffness(line)
    mirrored = np.zeros_like(stiffness.band)
    for distance, entries in enumerate(stiffness.band):
        count = entries.size - distance
        mirrored[distance, :count] = entries[:count][::-1]
    lower = _cut_blocks(stiffness.factor, size, 0)
    upper = _cut_blocks(cholesky_banded(mirrored, lower=True, check_finite=False), size, 0)
    left = lower @ lower.transpose(0, 2, 1)
    right = (upper @ upper.transpose(0, 2, 1))[::-1, ::-1, ::-1]
    half, coupling = _cut_blocks(stiffness.band, size, 0), _cut_blocks(stiffness.band, size, size)[:-1]
    own = half + np.tril(half, -1).transpose(0, 2, 1)
    return BlockInverse(
        stiffness=stiffness,
        connectors=line.connectors,
        diagonal=np.asarray(np.linalg.inv(left + right - own), dtype=float),
        to_right=np.asarray(-np.linalg.solve(right[1:], coupling), dtype=float),
        to_left=np.asarray(-np.linalg.solve(left[:-1], coupling.transpose(0, 2, 1)), dtype=float),
    )


def _cut_blocks(band: Array, size: int, below: int) -> Array:
    """Blocks on the diagonal of a lower band, or that many unknowns below it, (stations, size, size)."""
    blocks = np.zeros((band.shape[1] // size, size, size))
    for row, column in np.ndindex(size, size):
        if 0 <= (distance := below + row - column) < len(band):
            blocks[:, row, column] = band[distance, column::size]
    return blocks


def compute_unit_responses(inverse: BlockInverse, element: Indices, share: Array) -> UnitResponses:
    """Compute the responses to unit forces, each inside one element or at one of its stations.

    Args:
        inverse: Inverse of the stiffness of the line.
        element: Element of each force, in ascending order, (n,).
        share: Nodal forces at both stations of the element, (n, 2, unknowns of a station).
    """
    stiffness, connectors = inverse.stiffness, inverse.connectors
    stations, rows = len(inverse.diagonal), inverse.diagonal.shape[1] // 2
    movable = stiffness.movable.reshape(stations, 2 * rows)
    load = share * movable[element[:, None] + np.arange(2)]
    near = np.einsum("nij,nj->ni", inverse.diagonal[element], load[:, 0])
    back = np.einsum("nji,nj->ni", inverse.to_right[element], load[:, 1])
    first = near + np.einsum("nij,nj->ni", inverse.diagonal[element], back)
    second = np.einsum("nij,nj->ni", inverse.to_right[element], near)
    second += np.einsum("nij,nj->ni", inverse.diagonal[element + 1], load[:, 1])
    flexibility = (load[:, 0] * first + load[:, 1] * second).sum(axis=1)

    order = np.argsort(connectors.station, kind="stable")
    station, coefficient = connectors.station[order], connectors.coefficient[order]
    elongation = np.empty((element.size, order.size))
    on_right = _carry(inverse.to_right, element + 1, second, station, coefficient)
    last = stations - 1
    on_left = _carry(
        inverse.to_left[::-1], (last - element)[::-1], first[::-1], (last - station)[::-1], coefficient[::-1]
    )
    elongation[:, order] = on_right + on_left[::-1, ::-1]

    # Held stretches, by the Woodbury identity.
    columns = stiffness.stretch_columns.reshape(stations, rows, 2, -1)
    blocks = columns.reshape(stations, 2 * rows, -1)[element[:, None] + np.arange(2)]
    stretch = np.einsum("nsb,nsbm->nm", load, blocks)
    tension = np.linalg.solve(stiffness.stretch_flexibility, stretch.T).T
    flexibility -= (stretch * tension).sum(axis=1)
    elongation -= tension @ np.einsum("cr,crm->mc", connectors.coefficient, columns[connectors.station, :, 0])
    reached = np.flatnonzero(elongation.any(axis=0))
    return UnitResponses(flexibility, reached, elongation[:, reached])


def _carry(transfer: Array, start: Indices, value: Array, station: Indices, coefficient: Array) -> Array:
    """Elongations of connectors at the start of each response or behind it.

    Args:
        transfer: Transfer from each station to the next.
        start: Station at which each response starts, ascending, (n,).
        value: Unknowns there, (n, unknowns of a station).
        station: Stations of the connectors, ascending, (m,).
        coefficient: Elongation of each connector per deflection of each row, (m, rows).

    Returns:
        Elongations, (n, m) [m/N].
    """
    elongation, response = np.zeros((start.size, station.size)), value.T.copy()
    end = NEGLIGIBLE * np.abs(response).max(axis=0)
    stations = np.arange(len(transfer) + 2)
    started, passed = np.searchsorted(start, stations, "right").tolist(), np.searchsorted(station, stations).tolist()
    low = high = 0
    for here in range(int(start[0]), len(transfer) + 1):
        if low < high:
            response[:, low:high] = transfer[here - 1] @ response[:, low:high]
        high = started[here]
        at_station = slice(passed[here], passed[here + 1])
        if low < high and at_station.start < at_station.stop:
            elongation[low:high, at_station] = (coefficient[at_station] @ response[::2, low:high]).T
            while low < high and np.abs(response[:, low]).max() <= end[low]:
                low += 1
        if low == start.size:
            break
    return elongation

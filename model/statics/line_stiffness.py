"""Stiffness of a line with every dropper taut, factored as a band matrix.

In global order (station by station, rows interleaved) an element couples unknowns at most 2 B + 1 places apart, and a
connector those of one station. The matrix is symmetric, and positive definite about a stable equilibrium. Its Cholesky
factor has the same band and takes a small part of the time of a general sparse factor.

Held stretches add k a a' each, with a vector a as long as the stretch. They enter by the Woodbury identity, so that the
band remains narrow.
"""

from itertools import combinations_with_replacement

import numpy as np
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded

from pantocheck.model.description.arrays import Array
from pantocheck.model.description.failures import NoEquilibrium
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, keep_with_line
from pantocheck.model.fem.beams import element_stiffness
from pantocheck.model.statics.assembly import free_unknowns, stretch_directions


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

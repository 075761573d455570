"""Static deflection under loads, with slack droppers."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from pantocheck.model.arrays import Array
from pantocheck.model.discretised_line import DiscretisedLine
from pantocheck.model.failures import NoEquilibrium
from pantocheck.model.fem.assembly import assemble_matrices, bandwidth_order, connector_directions, factorise_stiffness

MAX_ITERATIONS = 100
"""Largest number of changes of the set of slack droppers."""


@dataclass(frozen=True)
class Deflection:
    """A static deflection about the initial state.

    Parameters
    ----------
    displacement : (rows, stations, 2) ndarray
        Deflection and slope [m, -].
    tension : (connectors,) ndarray
        Total tension [N].
    """

    displacement: Array
    tension: Array

    @property
    def slack(self) -> NDArray[np.bool_]:
        """Whether each connector carries no force, (connectors,)."""
        return np.equal(self.tension, 0.0)


class StaticSolver:
    """Static solver of one line, factored once; slack droppers enter as low-rank corrections.

    Parameters
    ----------
    line : DiscretisedLine
        Discretised line.
    """

    def __init__(self, line: DiscretisedLine) -> None:
        self.line = line
        matrices = assemble_matrices(line)
        self._free = matrices.free
        self._solve = factorise_stiffness(line, matrices)
        self._direction = sp.csc_array(connector_directions(line)[self._free])

    def deflection(self, load: Array) -> Deflection:
        """Compute the deflection under a load.

        Parameters
        ----------
        load : (unknowns,) ndarray
            Forces and moments in global order [N, N m].

        Returns
        -------
        Deflection
            Displacements and tensions.

        Raises
        ------
        NoEquilibrium
            The set of slack droppers does not settle.
        """
        connectors = self.line.connectors
        taut = self._solve(np.asarray(load, dtype=float)[self._free])
        slack = np.zeros(connectors.station.size, dtype=np.bool_)
        for _ in range(MAX_ITERATIONS):
            solution = taut
            index = np.flatnonzero(slack)
            if index.size:
                # Cancel the compression of the slack droppers, and release their preload.
                b = self._direction[:, index].toarray()
                compliance = self._solve(b)
                k, preload = connectors.stiffness[index], connectors.preload[index]
                system = np.eye(index.size) - k[:, None] * (b.T @ compliance)
                release = np.linalg.solve(system, preload + k * (b.T @ taut))
                solution = taut + compliance @ release
            tension = connectors.preload + connectors.stiffness * (self._direction.T @ solution)
            now_slack = connectors.unilateral & (tension < 0)
            if np.array_equal(now_slack, slack):
                return self._expand(solution, np.where(slack, 0.0, tension))
            slack = now_slack
        raise NoEquilibrium(
            f"no static equilibrium: the set of slack droppers still changes after {MAX_ITERATIONS} iterations"
        )

    def _expand(self, solution: Array, tension: Array) -> Deflection:
        """Deflection of all unknowns from that of the free ones."""
        full = np.zeros(self.line.beams.free.size)
        full[bandwidth_order(self.line)[self._free]] = solution
        return Deflection(full.reshape(self.line.beams.free.shape), tension)

"""Static deflection under loads, with slack droppers."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.description.failures import NoEquilibrium
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, keep_with_line
from pantocheck.model.statics.assembly import bandwidth_order, connector_directions
from pantocheck.model.statics.line_stiffness import factored_stiffness

MAX_ITERATIONS = 100
"""Largest number of changes of the set of slack droppers."""


@dataclass(frozen=True)
class Deflection:
    """A static deflection about the initial state."""

    displacement: Array
    """Deflection and slope, (rows, stations, 2) [m, -]."""
    tension: Array
    """Total tension, (connectors,) [N]."""

    @property
    def slack(self) -> NDArray[np.bool_]:
        """Whether each connector carries no force, (connectors,)."""
        return np.equal(self.tension, 0.0)


class PointResponse(NamedTuple):
    """Response of a line with taut droppers to a unit force."""

    flexibility: float
    """Deflection at the force [m/N]."""
    elongation: Array
    """Elongation of each connector, (connectors,) [m/N]."""


class StaticSolver:
    """Static solver of one line, factored once; slack droppers enter as low-rank corrections.

    Elongations of connectors under the load, and under the forces that release slack droppers, decide which droppers
    are slack. The deflection of the line follows once at the end.

    Args:
        line: Discretised line.
    """

    def __init__(self, line: DiscretisedLine) -> None:
        self._connectors = line.connectors
        self._shape, self._order = line.beams.free.shape, bandwidth_order(line)
        self._stiffness = factored_stiffness(line)
        self._direction = sp.csc_array(connector_directions(line))
        self._compliance: dict[int, Array] = {}

    def deflection(self, load: Array) -> Deflection:
        """Compute the deflection under a load.

        Args:
            load: Forces and moments in global order, (unknowns,) [N, N m].

        Returns:
            Displacements and tensions.

        Raises:
            NoEquilibrium: The set of slack droppers does not settle.
        """
        taut = self._stiffness.solve(np.asarray(load, dtype=float))
        slack, release, tension = self._release_slack(self._direction.T @ taut)
        if slack.size:
            taut = taut + self._stiffness.solve(self._direction[:, slack] @ release)
        full = np.empty(taut.size)
        full[self._order] = taut
        return Deflection(full.reshape(self._shape), tension)

    def point_response(self, direction: Array) -> PointResponse:
        """Compute the response to a unit force with taut droppers.

        Args:
            direction: Nodal forces of the unit force, in global order, (unknowns,); zero but for a few unknowns.
        """
        unit = self._stiffness.solve(direction)
        return PointResponse(point_product(direction, unit), self._direction.T @ unit)

    def deflection_at(self, point: PointResponse, force: float) -> float:
        """Compute the deflection at a point, in the direction of a force there; droppers may slacken.

        Args:
            point: Response to a unit force.
            force: Size of the force [N].

        Returns:
            Product of the direction with the displacements [m].

        Raises:
            NoEquilibrium: The set of slack droppers does not settle.
        """
        slack, release, _ = self._release_slack(force * point.elongation)
        # A unit force elongates a dropper as much as a unit elongating force of the dropper moves the unit force.
        return float(force * point.flexibility + point.elongation[slack] @ release)

    def _release_slack(self, elongation: Array) -> tuple[Indices, Array, Array]:
        """Indices of slack droppers, the forces that release them, and all tensions, from elongations of taut ones."""
        connectors = self._connectors
        slack, release, released = np.zeros(0, dtype=np.int64), np.zeros(0), elongation
        for _ in range(MAX_ITERATIONS):
            tension = connectors.preload + connectors.stiffness * released
            now_slack = np.flatnonzero(connectors.unilateral & (tension < 0))
            if np.array_equal(now_slack, slack):
                tension[slack] = 0.0
                return slack, release, tension
            slack = now_slack
            # Cancel the compression of the slack droppers, and release their preload.
            compliance = np.array([self._elongations(n) for n in slack.tolist()]).reshape(slack.size, -1)
            k, preload = connectors.stiffness[slack], connectors.preload[slack]
            system = np.eye(slack.size) - k[:, None] * compliance[:, slack]
            release = np.linalg.solve(system, preload + k * elongation[slack])
            released = elongation + release @ compliance
        raise NoEquilibrium(
            f"no static equilibrium: the set of slack droppers still changes after {MAX_ITERATIONS} iterations"
        )

    def _elongations(self, connector: int) -> Array:
        """Elongations of all connectors under a unit force that elongates one of them, (connectors,) [m/N]."""
        if connector not in self._compliance:
            force = self._direction[:, [connector]].toarray()[:, 0]
            self._compliance[connector] = self._direction.T @ self._stiffness.solve(force)
        return self._compliance[connector]


def point_product(direction: Array, displacement: Array) -> float:
    """Scalar product with a direction that is zero but for a few unknowns; only these are multiplied."""
    loaded = np.flatnonzero(direction)
    return float(direction[loaded] @ displacement[loaded])


@keep_with_line
def static_solver(line: DiscretisedLine) -> StaticSolver:
    """Static solver of a line, built once."""
    return StaticSolver(line)

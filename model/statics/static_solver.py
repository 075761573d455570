"""Static deflection under loads, with slack droppers."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from pantocheck.model.description.arrays import Array, Indices
from pantocheck.model.description.failures import NoEquilibrium
from pantocheck.model.discretisation.discretised_line import DiscretisedLine, keep_with_line
from pantocheck.model.statics.assembly import bandwidth_order, connector_directions
from pantocheck.model.statics.unit_responses import (
    UnitResponses,
    compute_unit_responses,
    factored_stiffness,
    invert_blocks,
)

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


class StaticSolver:
    """Static solver of one line, factored once; slack droppers enter as low-rank corrections.

    Elongations of connectors under the load, and under the forces that release slack droppers, decide which droppers
    are slack. The deflection of the line follows once at the end.

    Args:
        line: Discretised line.
    """

    def __init__(self, line: DiscretisedLine) -> None:
        self._inverse, self._connectors = invert_blocks(line), line.connectors
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
        every = np.arange(self._connectors.station.size)
        slack, release, tension = self._release_slack(self._direction.T @ taut, every)
        if slack.size:
            taut = taut + self._stiffness.solve(self._direction[:, slack] @ release)
        full = np.empty(taut.size)
        full[self._order] = taut
        return Deflection(full.reshape(self._shape), tension)

    def deflections_at(self, points: UnitResponses, force: float) -> Array:
        """Compute the deflection at each of some points, in the direction of a force there; droppers may slacken.

        Args:
            points: Responses to a unit force at each point in turn.
            force: Size of the force [N].

        Returns:
            Products of the directions with the displacements, (n,) [m].

        Raises:
            NoEquilibrium: The set of slack droppers does not settle.
        """
        deflection, elongation, part = force * points.flexibility, force * points.elongation, points.connectors
        tension = self._connectors.preload[part] + self._connectors.stiffness[part] * elongation
        negative = self._connectors.unilateral[part] & (tension < 0)
        self._compute_compliances(part[negative.any(axis=0)])
        for n in np.flatnonzero(negative.any(axis=1)):
            slack, release, _ = self._release_slack(elongation[n], part)
            # A unit force elongates a dropper as much as a unit elongating force of the dropper moves the unit force.
            deflection[n] += points.elongation[n, slack] @ release
        return deflection

    def _release_slack(self, elongation: Array, part: Indices) -> tuple[Indices, Array, Array]:
        """Slack droppers, the forces that release them, and all tensions, from elongations of taut ones.

        Args:
            elongation: Elongations of the connectors that the load reaches, (m,) [m].
            part: These connectors, (m,).

        Returns:
            Places of the slack ones among them, the forces [N], and the tensions (m,) [N].
        """
        stiffness, rest = self._connectors.stiffness[part], self._connectors.preload[part]
        unilateral = self._connectors.unilateral[part]
        slack, release, released = np.zeros(0, dtype=np.int64), np.zeros(0), elongation
        for _ in range(MAX_ITERATIONS):
            tension = rest + stiffness * released
            now_slack = np.flatnonzero(unilateral & (tension < 0))
            if np.array_equal(now_slack, slack):
                tension[slack] = 0.0
                return slack, release, tension
            slack = now_slack
            # Cancel the compression of the slack droppers, and release their preload.
            self._compute_compliances(part[slack])
            compliance = np.array([self._compliance[n][part] for n in part[slack].tolist()])
            system = np.eye(slack.size) - stiffness[slack, None] * compliance[:, slack]
            release = np.linalg.solve(system, rest[slack] + stiffness[slack] * elongation[slack])
            released = elongation + release @ compliance
        raise NoEquilibrium(
            f"no static equilibrium: the set of slack droppers still changes after {MAX_ITERATIONS} iterations"
        )

    def _compute_compliances(self, connectors: Indices) -> None:
        """Keep the elongations of all connectors under a unit force that elongates each of some [m/N]."""
        new = np.array([n for n in connectors.tolist() if n not in self._compliance], dtype=np.int64)
        if new.size == 0:
            return
        new = new[np.argsort(self._connectors.station[new], kind="stable")]
        station = self._connectors.station[new]
        element = np.minimum(station, self._shape[1] - 2)
        share = np.zeros((new.size, 2, 2 * self._shape[0]))
        share[np.arange(new.size), station - element, ::2] = self._connectors.coefficient[new]
        responses = compute_unit_responses(self._inverse, element, share)
        for n, elongation in zip(new.tolist(), responses.elongation, strict=True):
            self._compliance[n] = np.zeros(self._connectors.station.size)
            self._compliance[n][responses.connectors] = elongation


def point_product(direction: Array, displacement: Array) -> float:
    """Scalar product with a direction that is zero but for a few unknowns; only these are multiplied."""
    loaded = np.flatnonzero(direction)
    return float(direction[loaded] @ displacement[loaded])


@keep_with_line
def static_solver(line: DiscretisedLine) -> StaticSolver:
    """Static solver of a line, built once."""
    return StaticSolver(line)

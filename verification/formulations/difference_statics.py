"""Statics of the second formulation: strands under loads, with prescribed displacements and unilateral bars."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import SuperLU, splu

from verification.formulations.difference_strands import Floats, Indices, Weights


@dataclass(frozen=True)
class Bar:
    """Spring whose elongation is the sum of coefficients times displacements; a unilateral bar carries tension only.

    Position [m], points and coefficients, stiffness [N/m], damping [N s/m], tension at rest [N].
    """

    position: float
    points: Indices
    coefficients: Floats
    stiffness: float
    damping: float = 0.0
    preload: float = 0.0
    unilateral: bool = False


def join(*parts: tuple[float, Weights]) -> Weights:
    """Points and coefficients of a sum of factors times interpolated displacements."""
    return (
        np.concatenate([points for _, (points, _) in parts]),
        np.concatenate([factor * weights for factor, (_, weights) in parts]),
    )


def rows(weights: list[Weights], size: int) -> sp.csr_array:
    """Matrix with one row of coefficients per list entry."""
    place = np.repeat(np.arange(len(weights)), [points.size for points, _ in weights])
    points, values = (np.concatenate([w[k] for w in weights]) if weights else np.zeros(0, int) for k in (0, 1))
    return sp.csr_array((values, (place, points)), shape=(len(weights), size))


class HeldStructure:
    """Linear structure with prescribed sums of displacements, factored once: K w + A' p = load, A w = values."""

    def __init__(self, stiffness: sp.csc_array, held: sp.csr_array) -> None:
        self.size = stiffness.shape[0]
        self._factor: SuperLU = splu(sp.csc_matrix(sp.block_array([[stiffness, held.T], [held, None]])))

    def solve(self, load: Floats, values: Floats) -> tuple[Floats, Floats]:
        """Displacements and the forces that hold the prescribed sums."""
        solution = self._factor.solve(np.append(load, values))
        return solution[: self.size], -solution[self.size :]


class Uplift:
    """Static displacement from the state of rest under point loads, with slack droppers.

    With the droppers of a set slack, forces q along them cancel their linear tensions: q = preload + k d(q).
    """

    def __init__(self, stiffness: sp.csc_array, bars: list[Bar], held: sp.csr_array) -> None:
        size = stiffness.shape[0]
        self._elongation = rows([(bar.points, bar.coefficients) for bar in bars], size)
        self._stiffness = np.array([bar.stiffness for bar in bars])
        self._preload = np.array([bar.preload if bar.unilateral else np.inf for bar in bars])
        bar_matrix = self._elongation.T @ sp.diags_array(self._stiffness) @ self._elongation
        self._structure = HeldStructure(sp.csc_array(stiffness + bar_matrix), held)
        self._zero = np.zeros(held.shape[0])
        self._columns: dict[int, Floats] = {}

    def displacement(self, load: Floats) -> Floats:
        """Displacement under a load, (size,) [N]."""
        linear = self._structure.solve(load, self._zero)[0]
        displacement, slack = linear, np.zeros(0, dtype=int)
        for _ in range(100):
            tension = self._preload + self._stiffness * (self._elongation @ displacement)
            now = np.flatnonzero(tension < 0)
            if np.array_equal(now, slack):
                return displacement
            slack = now
            columns = np.array([self._column(j) for j in slack]).reshape(slack.size, linear.size)
            part = self._elongation[slack]
            k = self._stiffness[slack]
            system = np.eye(slack.size) - k[:, None] * (part @ columns.T)
            forces = np.linalg.solve(system, self._preload[slack] + k * (part @ linear))
            displacement = linear + forces @ columns
        raise RuntimeError("the set of slack droppers still changes after 100 iterations")

    def _column(self, j: int) -> Floats:
        if j not in self._columns:
            self._columns[j] = self._structure.solve(self._elongation[[j]].toarray().ravel(), self._zero)[0]
        return self._columns[j]

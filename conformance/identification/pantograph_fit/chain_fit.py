"""Fit of a chain of lumped masses to measured responses by bounded least squares from several starts."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.pantograph_fit.chain_problem import ChainProblem, MeasuredStiffness
from pantocheck.conformance.identification.pantograph_fit.chain_starts import choose_starts

START_ROWS = 240
"""Largest number of rows with which starts are compared; the best one is refined with all rows."""

START_EVALUATIONS, EVALUATIONS = 80, 500
"""Largest number of evaluations from each start, and in the refinement."""

SAME_COST = 1.01
"""Ratio of sums of squares up to which a start has reached the same minimum as the best one."""


@dataclass(frozen=True)
class ChainFit:
    """Fitted chain of n masses."""

    problem: ChainProblem
    """Measured responses and fixed values."""
    values: RealArray
    """Masses [kg], stiffnesses [N/m] and dampings [N s/m], base to head, (3, n)."""
    sum_of_squares: float
    """Sum of the squared weighted residuals."""
    starts: int
    best_starts: int
    """Number of starts, and of those that end in the best minimum."""

    @property
    def size(self) -> int:
        """Number of weighted residuals: two per row."""
        return 2 * self.problem.data.frequency.size

    @property
    def free_count(self) -> int:
        """Number of free parameters."""
        return int(self.problem.free.sum())

    @property
    def variance_ratio(self) -> float:
        """Sum of squares over the degrees of freedom: 1 if noise of the stated size is the only deviation."""
        return self.sum_of_squares / max(self.size - self.free_count, 1)


def fit_chain(data: MeasuredStiffness, fixed: RealArray) -> ChainFit:
    """Fit a chain.

    Args:
        data: Measured responses.
        fixed: Fixed masses [kg], stiffnesses [N/m] and dampings [N s/m], (3, n); NaN: free.

    Returns:
        Best fit of all starts.
    """
    coarse = ChainProblem(data.select_rows(_thin_rows(data.frequency)), fixed)
    trials = _try_starts(coarse)
    costs = np.array([cost for _, cost in trials])
    problem = ChainProblem(data, fixed)
    parameters, cost = _solve(problem, trials[int(np.argmin(costs))][0], EVALUATIONS)
    return ChainFit(
        problem, problem.unpack(parameters), cost, len(trials), int((costs <= SAME_COST * costs.min()).sum())
    )


def _try_starts(problem: ChainProblem) -> list[tuple[RealArray, float]]:
    """Free parameters and sum of squares that each start reaches; a fit with one mass less gives starts."""
    masses = problem.fixed.shape[1]
    smaller = []
    if masses > 1:
        reduced = ChainProblem(problem.data, np.full((3, masses - 1), np.nan))
        smaller = [reduced.unpack(min(_try_starts(reduced), key=lambda trial: trial[1])[0])]
    return [_solve(problem, start, START_EVALUATIONS) for start in choose_starts(problem, smaller)]


def _thin_rows(frequency: RealArray) -> NDArray[np.int64]:
    """Rows with which starts are compared, by increasing frequency, evenly spread over its logarithm."""
    rows = np.argsort(frequency, kind="stable")
    if rows.size <= START_ROWS:
        return rows
    grid = np.geomspace(frequency.min(), frequency.max(), START_ROWS)
    return np.asarray(rows[np.unique(np.searchsorted(frequency[rows], grid).clip(max=rows.size - 1))])


def _solve(problem: ChainProblem, start: RealArray, evaluations: int) -> tuple[RealArray, float]:
    """Free parameters and sum of squares of the minimum that a start reaches."""
    found = least_squares(
        problem.residuals,
        start,
        problem.jacobian,
        problem.bounds,
        "trf",
        1e-12,
        1e-12,
        1e-12,
        "jac",
        max_nfev=evaluations,
    )
    return np.asarray(found.x), 2 * float(found.cost)

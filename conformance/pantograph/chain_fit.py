"""Fits of chains of lumped masses to measured responses, their intervals, and the choice between numbers of masses.

A fit is a bounded least-squares problem, solved from several starts.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.pantograph.bending_fit import FittedMode, fit_bending_modes, remove_modes
from pantocheck.conformance.pantograph.chain_problem import ChainProblem, MeasuredStiffness
from pantocheck.conformance.pantograph.chain_starts import choose_starts
from pantocheck.conformance.pantograph.response_record import ResponseRecord

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
    """Fit a chain whose fixed masses [kg], stiffnesses [N/m] and dampings [N s/m], (3, n), are numbers; NaN: free."""
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
    found = scipy.optimize.least_squares(
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


# Intervals of the parameters of a fitted chain, from the curvature of the sum of squares at its minimum.
Determination = Literal["fixed", "determined", "weakly_determined", "not_distinguished_from_zero"]
"""How well the measured band determines a parameter."""

INTERVAL_CONFIDENCE = 0.95
"""Confidence of an interval."""

WEAK = 0.2
"""Half-width of an interval over its value above which a parameter is weakly determined: models are compared with
changes of five percent and more."""


@dataclass(frozen=True)
class FitIntervals:
    """Intervals of the parameters."""

    half_width: RealArray
    """Half-widths of the 95 % intervals of masses [kg], stiffnesses [N/m] and dampings [N s/m], (3, n); 0: fixed."""
    correlation: RealArray
    """Correlations of the free parameters, in the order of their mask, (p, p)."""


def compute_intervals(fit: ChainFit, is_noise_stated: bool) -> FitIntervals:
    """Compute the intervals of a fit.

    The deviations of the rows are taken as independent. If they are larger than the stated noise, they count with their
    own size, because the chain is then no exact model.

    Args:
        fit: Fitted chain.
        is_noise_stated: Whether the weights are the inverse standard deviations of the measurement; otherwise, the size
            of the noise follows from the residuals.
    """
    jacobian = fit.problem.value_jacobian(fit.values)
    scale = np.linalg.norm(jacobian, axis=0)
    scale[scale == 0] = 1.0
    _, singular, rows = np.linalg.svd(jacobian / scale, full_matrices=False)
    # A direction that the residuals do not feel has a singular value of rounding: its parameters are not determined.
    roots = rows / np.maximum(singular, np.finfo(float).eps * singular[0])[:, None]
    covariance = roots.T @ roots
    deviation = np.sqrt(np.diag(covariance))
    freedom = max(fit.size - fit.free_count, 1)
    noise = max(fit.variance_ratio, 1.0) if is_noise_stated else fit.variance_ratio
    half_width = np.zeros(fit.values.shape)
    quantile = scipy.special.stdtrit(freedom, (1 + INTERVAL_CONFIDENCE) / 2)
    half_width[fit.problem.free] = quantile * np.sqrt(noise) * deviation / scale
    return FitIntervals(half_width, covariance / np.outer(deviation, deviation))


def judge_parameters(fit: ChainFit, intervals: FitIntervals) -> list[list[Determination]]:
    """Determination of every parameter, in the order of `ChainFit.values`."""
    return [
        [
            "fixed"
            if not free
            else "determined"
            if width <= WEAK * value
            else "weakly_determined"
            if width < value
            else "not_distinguished_from_zero"
            for value, width, free in zip(*rows, strict=True)
        ]
        for rows in zip(fit.values, intervals.half_width, fit.problem.free, strict=True)
    ]


# Fits of chains with different numbers of masses to measured responses, and the choice between them.
MASS_COUNTS = (2, 3, 4)
"""Numbers of masses that are tried."""

UNKNOWN_NOISE = 0.01
"""Relative noise of the weights where the records state none; its size follows from the residuals."""

NORMAL_95 = 1.959964
"""Half-width of a 95 % interval in standard deviations of a normal distribution."""


@dataclass(frozen=True)
class FitTask:
    """Choices for the fit of a chain."""

    band: tuple[float, float]
    """Lowest and highest frequency of the rows in the fit [Hz]."""
    fixed: RealArray | None
    """Fixed masses [kg], stiffnesses [N/m] and dampings [N s/m] of a chain of n masses, NaN, (3, n): free; None: no
    value is fixed, and every number of masses is tried.
    """
    bending_modes: int = 0
    """Number of bending modes of the head beside the chain."""


@dataclass(frozen=True)
class ChainSelection:
    """Fitted chains."""

    fits: dict[int, ChainFit]
    """Fit by number of masses."""
    is_noise_stated: bool
    """Whether every record states its uncertainty."""
    modes: dict[int, tuple[FittedMode, ...]]
    """Bending modes of the head beside each chain, by its number of masses."""

    @property
    def best(self) -> int:
        """Number of masses with the lowest information criterion."""
        return min(self.fits, key=lambda masses: information_criterion(self.fits[masses]))

    def intervals(self, masses: int) -> FitIntervals:
        """Intervals of the parameters of a fit."""
        return compute_intervals(self.fits[masses], self.is_noise_stated)


def information_criterion(fit: ChainFit) -> float:
    """Information criterion of Schwarz (BIC) with a noise of unknown size: n ln(S / n) + p ln n.

    The lowest value is the best compromise between the sum of squares S of n residuals and p parameters.
    """
    return fit.size * math.log(fit.sum_of_squares / fit.size) + fit.free_count * math.log(fit.size)


def fit_chains(records: Sequence[ResponseRecord], task: FitTask) -> ChainSelection:
    """Fit chains to all responses together.

    Raises:
        InputError: A response is not that of the centre of the head, or the band has too few rows.
    """
    data = join_responses(records, task.band)
    counts = MASS_COUNTS if task.fixed is None else (task.fixed.shape[1],)
    fewest = 3 * max(counts)
    if data.frequency.size < fewest:
        raise InputError(
            "the responses",
            f"have {data.frequency.size} values from {task.band[0]:g} to {task.band[1]:g} Hz",
            f"Give at least {fewest}, three per mass.",
        )
    fixed = {n: np.full((3, n), np.nan) if task.fixed is None else task.fixed for n in counts}
    fits = {n: fit_chain(data, values) for n, values in fixed.items()}
    modes: dict[int, tuple[FittedMode, ...]] = dict.fromkeys(counts, ())
    if task.bending_modes:
        modes = {n: fit_bending_modes(data, fits[n].values, task.bending_modes) for n in counts}
        fits = {n: fit_chain(remove_modes(data, modes[n]), values) for n, values in fixed.items()}
    return ChainSelection(fits, all(record.uncertainty is not None for record in records), modes)


def join_responses(records: Sequence[ResponseRecord], band: tuple[float, float]) -> MeasuredStiffness:
    """Join the values of responses in a band, by increasing frequency; errors as in `fit_chains`.

    Weights are the inverse standard deviations of the records. If a record states none, all rows have equal weights.
    """
    is_noise_stated = all(record.uncertainty is not None for record in records)
    frequencies, stiffnesses, weights = [], [], []
    for record in records:
        if not record.sidecar.is_at_head:
            raise InputError(
                f"record '{record.source}'",
                "is not a response of the centre of the head",
                "Leave it out: a chain has one point of the head. `pantocheck pantograph compare` shows it.",
            )
        used = np.isfinite(record.stiffness) & (record.frequency >= band[0]) & (record.frequency <= band[1])
        frequencies.append(record.frequency[used])
        stiffnesses.append(record.stiffness[used])
        if is_noise_stated and record.uncertainty is not None:
            weights.append(NORMAL_95 / np.vstack([record.uncertainty.modulus, record.uncertainty.phase])[:, used])
        else:
            weights.append(np.full((2, int(used.sum())), 1 / UNKNOWN_NOISE))
    frequency = np.concatenate(frequencies)
    joined = MeasuredStiffness(frequency, np.concatenate(stiffnesses), np.hstack(weights))
    return joined.select_rows(np.argsort(frequency, kind="stable"))

"""Joint fit of the properties of a line and of its damping to identified modes, with one covariance.

The unknowns are the factors x of the free properties and the coefficients c of the damping of the wires. The data are
frequencies, damping ratios and shapes; a normal prior holds each factor near 1. Properties that are not free keep
their stated value. Their tolerance acts through the sensitivity of each mode: a mode that depends strongly on
them has a small weight (consider parameters, [1]). Each Gauss-Newton step computes the line anew.

The scatter of the line model is found from the residuals: that of the damping from the differences within the groups of
span modes, so that a group which the wires do not explain remains visible.

References:
    [1] S. F. Schmidt, Application of state-space methods to navigation problems, Advances in Control Systems 3 (1966).
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import IntegerArray, RealArray
from pantocheck.conformance.drops.damping_model import (
    MODEL_ERROR,
    near_their_group,
    ratio_deviation,
    refuse_few_modes,
    solve_weighted,
)
from pantocheck.conformance.drops.line_linearisation import Linearisation, linearise_line
from pantocheck.conformance.line.line_parameters import LineParameter, ParameterGroup
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.model import Catenary
from pantocheck.model.description.one_thread import use_one_thread

MOST_STEPS = 8
"""Largest number of Gauss-Newton steps."""

LAST_CHANGE = 0.1
"""Change of a factor that ends the steps, over its standard deviation [-]."""

LARGEST_STEP = 0.03
"""Largest change of a factor in one step, so that the modes remain paired [-]."""


@dataclass(frozen=True)
class Prior:
    """Prior of the factors of the properties."""

    parameters: tuple[LineParameter, ...]
    covariance: RealArray
    """Covariance of the factors, (p, p) [-]."""
    free: frozenset[ParameterGroup]
    """Groups of the properties that are fitted."""

    @property
    def is_free(self) -> NDArray[np.bool_]:
        """Mask of the fitted properties, (p,)."""
        return np.array([parameter.group in self.free for parameter in self.parameters], dtype=np.bool_)


class Scatter(NamedTuple):
    """Relative standard deviations of the line model beside those of the measurement [-]."""

    frequency: float
    damping: float
    shape: float
    """That of the shapes over `SHAPE_ERROR`."""


START_SCATTER = Scatter(5e-4, MODEL_ERROR, 1.0)
"""Scatter of the first solution."""

LEAST_SCATTER = Scatter(1e-5, 5e-4, 0.05)
"""Scatter by the discretisation alone: a fit of few modes cannot be better than its line."""


@dataclass(frozen=True)
class JointFit:
    """Fitted line and damping; f free properties and t coefficients are the unknowns."""

    linear: Linearisation
    """Modes of the fitted line."""
    factors: RealArray
    """Factor of each property, (p,); that of a property which is not free is 1."""
    values: RealArray
    """Coefficients of the damping, (t,)."""
    covariance: RealArray
    """Covariance of the unknowns, (f + t, f + t)."""
    used: IntegerArray
    """Pairs in the fit, (u,)."""
    ratio_residual: RealArray
    """Measured minus fitted damping ratios of the pairs in the fit, (u,) [-]."""
    ratio_covariance: RealArray
    """Covariance of these residuals by noise and line, (u, u) [-]."""
    frequency_residual: RealArray
    """Logarithms of measured over fitted frequencies of the pairs in the fit, (u,) [-]."""
    scatter: Scatter
    """Scatter of the line model."""
    freedom: int
    """Degrees of freedom of the scatter of the damping ratios."""
    misfit: float
    """Squared residual over its expectation [-]; above 1, it widens the covariance."""


@use_one_thread
def fit_jointly(
    usable: list[Mode], line: Catenary, prior: Prior, joins: RealArray, element: float, source: str
) -> JointFit:
    """Fit the free properties of a line and the damping of its wires.

    Args:
        usable: Identified modes.
        line: Line as stated.
        prior: Properties of the line with their tolerances.
        joins: Shares of the coefficients (t) in those of the wires, stiffness before mass of each wire, (4, t) [-].
        element: Element length [m].
        source: Name of the file of the modes, for messages.

    Raises:
        InputError: A sensor is not on the line, or too few modes have a computed counterpart.
    """
    factors, values = np.ones(len(prior.parameters)), None
    for _ in range(MOST_STEPS):
        linear = linearise_line(usable, line, prior.parameters, factors, element, source)
        if values is None:
            values = _start_values(linear, joins)
        fit = _fit_linear(_Problem(linear, prior, factors, joins, values))
        std = np.sqrt(np.diag(fit.covariance)[: int(prior.is_free.sum())])
        change = (np.abs(fit.factors - factors)[prior.is_free] / std).max(initial=0.0)
        factors, values = fit.factors, fit.values
        if change < LAST_CHANGE:
            break
    return fit


def solve_about(fit: JointFit, prior: Prior, joins: RealArray) -> JointFit:
    """Solution of the linear problem about the line of a fit, with other free properties."""
    return _fit_linear(_Problem(fit.linear, prior, fit.factors, joins, fit.values))


def _start_values(linear: Linearisation, joins: RealArray) -> RealArray:
    """Coefficients by the damping ratios alone."""
    measured = linear.matched.measured
    weight = 1 / ratio_deviation(measured)
    return solve_weighted(linear.ratios @ joins, measured.damping_ratio - linear.stated, weight)


@dataclass(frozen=True)
class _Rows:
    """Linear rows of the data: target = slope (change of the factors) + columns (coefficients), with a covariance."""

    target: RealArray
    slope: RealArray
    columns: RealArray
    covariance: RealArray
    """By noise, and by the properties that are not free."""


@dataclass(frozen=True)
class _Problem:
    """Data of the pairs of modes about one line."""

    linear: Linearisation
    prior: Prior
    factors: RealArray
    joins: RealArray
    values: RealArray
    """Present coefficients."""

    def build_rows(self, used: IntegerArray, scatter: Scatter) -> _Rows:
        """Rows of the frequencies, damping ratios and shapes of the pairs in the fit."""
        linear, free = self.linear, self.prior.is_free
        modes, measured = [linear.matched.paired[i] for i in used], linear.matched.measured.select(used)
        shapes = np.isin(linear.shape_mode, used)
        target = [
            np.log(measured.frequency / linear.frequency[used]),
            measured.damping_ratio - linear.stated[used],
            linear.shape_residual[shapes],
        ]
        std = [
            np.hypot([(mode.frequency_std_Hz or 0.0) / mode.frequency_Hz for mode in modes], scatter.frequency),
            np.hypot(measured.std, scatter.damping * measured.damping_ratio),
            np.full(int(shapes.sum()), scatter.shape),
        ]
        slope = np.vstack(
            [
                linear.frequency_slope[used],
                linear.damping_slope(self.joins @ self.values)[used],
                linear.shape_slope[shapes],
            ]
        )
        columns = np.zeros((len(slope), self.joins.shape[1]))
        columns[used.size : 2 * used.size] = linear.ratios[used] @ self.joins
        unknown = slope[:, ~free]
        covariance = np.diag(np.concatenate(std) ** 2)
        covariance += unknown @ self.prior.covariance[np.ix_(~free, ~free)] @ unknown.T
        return _Rows(np.concatenate(target), slope[:, free], columns, covariance)

    def residual(self, fit: JointFit, used: IntegerArray) -> RealArray:
        """Residuals of all rows of pairs, those left out of the fit included."""
        rows = self.build_rows(used, fit.scatter)
        return rows.target - rows.slope @ (fit.factors - self.factors)[self.prior.is_free] - rows.columns @ fit.values


def _fit_linear(problem: _Problem) -> JointFit:
    """Solve the linear problem about one line; pairs that overlap others, or that are outliers, are left out."""
    measured = problem.linear.matched.measured
    candidates = np.flatnonzero(~problem.linear.matched.overlapping)
    refuse_few_modes(candidates.size, problem.joins.shape[1])
    fit = _solve_rows(problem, candidates, START_SCATTER)
    for _ in range(4):
        left, count = problem.residual(fit, candidates), candidates.size
        group, zeta = measured.group[candidates], measured.damping_ratio[candidates]
        std = np.hypot(measured.std[candidates], fit.scatter.damping * zeta)
        near = near_their_group(left[count : 2 * count], std, group)
        near &= near_their_group(left[:count], np.full(count, fit.scatter.frequency), np.zeros_like(group))
        used = candidates[near]
        fit = _solve_rows(problem, used, _find_scatter(problem, fit, used))
    return fit


def _find_scatter(problem: _Problem, fit: JointFit, used: IntegerArray) -> Scatter:
    """Scatter of the line model with which each part of the residuals has its expected size."""
    left, count = problem.residual(fit, used), used.size
    measured = problem.linear.matched.measured.select(used)
    ratio, numbers = left[count : 2 * count] / measured.damping_ratio, np.unique(measured.group)
    means = np.array([ratio[measured.group == number].mean() for number in numbers])
    within = ratio - means[np.searchsorted(numbers, measured.group)]
    modes = [problem.linear.matched.paired[i] for i in used]
    frequency_std = np.array([(mode.frequency_std_Hz or 0.0) / mode.frequency_Hz for mode in modes])
    shape = left[2 * count :]
    return Scatter(
        _match_size(left[:count], frequency_std, count - int(problem.prior.is_free.sum()), LEAST_SCATTER.frequency),
        _match_size(within, measured.std / measured.damping_ratio, count - numbers.size, LEAST_SCATTER.damping),
        max(float(np.sqrt(np.mean(shape**2))), LEAST_SCATTER.shape) if shape.size else 1.0,
    )


def _match_size(residual: RealArray, noise: RealArray, freedom: int, smallest: float) -> float:
    """Scatter s for which the sum of residual^2 / (noise^2 + s^2) is the number of degrees of freedom."""

    def excess(scatter: float) -> float:
        return float(np.sum(residual**2 / (noise**2 + scatter**2))) - max(freedom, 1)

    largest = float(np.sqrt(np.sum(residual**2))) + smallest
    return smallest if excess(smallest) <= 0 else float(scipy.optimize.brentq(excess, smallest, largest))


def _solve_rows(problem: _Problem, used: IntegerArray, scatter: Scatter) -> JointFit:
    """Weighted least squares of data and prior; the noise of the data grows with the misfit."""
    rows, free, ratio = problem.build_rows(used, scatter), problem.prior.is_free, slice(used.size, 2 * used.size)
    own, unknowns = problem.prior.covariance[np.ix_(free, free)], int(free.sum()) + problem.joins.shape[1]
    matrix = np.hstack([rows.slope, rows.columns])
    scale = np.append(np.sqrt(np.diag(own)), 1 / np.abs(rows.columns).max(axis=0))
    data = _whiten(rows.covariance, np.column_stack([matrix * scale, rows.target]))
    known = np.zeros((len(own), unknowns + 1))
    known[:, : len(own)], known[:, -1] = np.diag(scale[: len(own)]), 1 - problem.factors[free]
    held = _whiten(own, known)
    both = np.vstack([data, held])
    # A coefficient of damping is never negative.
    low = np.where(np.arange(unknowns) < len(own), -np.inf, 0.0)
    solution = scipy.optimize.lsq_linear(both[:, :-1], both[:, -1], (low, np.inf)).x
    information, of_prior = data[:, :-1].T @ data[:, :-1], held[:, :-1].T @ held[:, :-1]
    narrow = np.linalg.pinv(information + of_prior, hermitian=True)
    left = data[:, -1] - data[:, :-1] @ solution
    misfit = float(left @ left) / max(left.size - float(np.trace(narrow @ information)), 1.0)
    covariance = np.linalg.pinv(information / max(misfit, 1.0) + of_prior, hermitian=True)
    moved = problem.factors.copy()
    moved[free] += np.clip((scale * solution)[: len(own)], -LARGEST_STEP, LARGEST_STEP)
    residual, scaled = rows.target - matrix @ (scale * solution), matrix[ratio] * scale
    groups = np.unique(problem.linear.matched.measured.group[used])
    return JointFit(
        linear=problem.linear,
        factors=moved,
        values=(scale * solution)[len(own) :],
        covariance=covariance * np.outer(scale, scale),
        used=used,
        ratio_residual=residual[ratio],
        ratio_covariance=rows.covariance[ratio, ratio] - scaled @ narrow @ scaled.T,
        frequency_residual=residual[: used.size],
        scatter=scatter,
        freedom=max(used.size - groups.size, 1),
        misfit=misfit,
    )


def _whiten(covariance: RealArray, rows: RealArray) -> RealArray:
    """Rows times the inverse of the Cholesky factor of their covariance."""
    return np.asarray(scipy.linalg.solve_triangular(np.linalg.cholesky(covariance), rows, lower=True))

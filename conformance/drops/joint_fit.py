"""Joint fit of the properties of a line and of its damping to identified modes, with one covariance.

The unknowns are the factors x of the free properties and the coefficients c of the damping of the wires. The data are
frequencies, damping ratios and shapes; a normal prior holds each factor near 1. Properties that are not free keep
their stated value. Their tolerance acts through the sensitivity of each mode: a mode that depends strongly on
them has a small weight (consider parameters, [1]). Each Gauss-Newton step computes the line anew.

The scatter of the line model is found from the residuals: that of the damping from the differences within the groups of
span modes, so that a group which the wires do not explain remains visible.

References:
    [1] S. F. Schmidt, Application of state-space methods to navigation problems, Advances in Control Systems 3 (1966).
    [2] H. D. Patterson, R. Thompson, Recovery of inter-block information when block sizes are unequal, Biometrika 58
        (1971) 545-554.
"""

from collections.abc import Iterable, Sequence
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
from pantocheck.conformance.line.line_parameters import BENDING, LineParameter, ParameterGroup
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


def build_prior(parameters: Sequence[LineParameter], covariance: RealArray, free: Iterable[ParameterGroup]) -> Prior:
    """Prior of properties with their covariance [-], and of the bending stiffness of the wires, which stays unknown."""
    bending = np.diag([each.tolerance**2 for each in BENDING])
    return Prior((*parameters, *BENDING), scipy.linalg.block_diag(covariance, bending), frozenset(free))


class Scatter(NamedTuple):
    """Relative standard deviations of the line model beside those of the measurement [-]."""

    frequency: float
    damping: float
    shape: float
    """That of the shapes over `SHAPE_ERROR`."""


START_SCATTER = Scatter(5e-4, MODEL_ERROR, 1.0)
"""Scatter of the first solution."""

LEAST_SCATTER = Scatter(1e-4, 1e-4, 0.05)
"""Scatter by the discretisation alone: a fit cannot be better than its line. The modes of the record T1, which another
program computed, differ by this much once the bending stiffness is found; the errors of near modes are similar, so that
a smaller scatter of the frequencies would take them for tensions. Chosen after the errors of T1 had been seen.
"""

SAME_COLUMN = 1e-6
"""Size below which a column lies in the span of the others [-]."""

SCATTER_TRIALS = 60
"""Number of scatters whose likelihood is compared."""


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
    coefficient_freedom: RealArray
    """Degrees of freedom of the variances of the coefficients, to which noise and line add known parts (Satterthwaite
    1946), (t,).
    """
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
    unknown: RealArray
    """Change by each of those q properties that differs by its tolerance, in independent directions, (n, q)."""

    def subtract_expected(self, residual: RealArray) -> RealArray:
        """Residuals of the rows without the changes by those properties that they let expect."""
        return np.asarray(residual - self.unknown @ (self.unknown.T @ np.linalg.solve(self.covariance, residual)))


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
        variance, direction = np.linalg.eigh(self.prior.covariance[np.ix_(~free, ~free)])
        unknown = slope[:, ~free] @ (direction * np.sqrt(np.maximum(variance, 0.0)))
        covariance = np.diag(np.concatenate(std) ** 2) + unknown @ unknown.T
        return _Rows(np.concatenate(target), slope[:, free], columns, covariance, unknown)

    def residual(self, fit: JointFit, rows: _Rows) -> RealArray:
        """Residuals of the rows of pairs, those left out of the fit included."""
        return rows.target - rows.slope @ (fit.factors - self.factors)[self.prior.is_free] - rows.columns @ fit.values


def _fit_linear(problem: _Problem) -> JointFit:
    """Solve the linear problem about one line; pairs that overlap others, or that are outliers, are left out."""
    measured = problem.linear.matched.measured
    candidates = np.flatnonzero(~problem.linear.matched.overlapping)
    refuse_few_modes(candidates.size, problem.joins.shape[1])
    fit = _solve_rows(problem, candidates, START_SCATTER)
    for _ in range(4):
        rows, count = problem.build_rows(candidates, fit.scatter), candidates.size
        left = rows.subtract_expected(problem.residual(fit, rows))
        group, zeta = measured.group[candidates], measured.damping_ratio[candidates]
        std = np.hypot(measured.std[candidates], fit.scatter.damping * zeta)
        near = near_their_group(left[count : 2 * count], std, group)
        near &= near_their_group(left[:count], np.full(count, fit.scatter.frequency), np.zeros_like(group))
        used = candidates[near]
        fit = _solve_rows(problem, used, _find_scatter(problem, fit, used))
    return fit


def _find_scatter(problem: _Problem, fit: JointFit, used: IntegerArray) -> Scatter:
    """Scatter of the line model by the residuals of each part of the data."""
    rows, count = problem.build_rows(used, fit.scatter), used.size
    left = problem.residual(fit, rows)
    measured = problem.linear.matched.measured.select(used)
    damping = slice(count, 2 * count)
    fitted = measured.damping_ratio - left[damping]
    unknown = rows.unknown[damping] / fitted[:, None]
    basis = _span_within_groups(rows.columns[damping] / fitted[:, None], measured.group)
    modes = [problem.linear.matched.paired[i] for i in used]
    frequency_std = np.array([(mode.frequency_std_Hz or 0.0) / mode.frequency_Hz for mode in modes])
    shape = left[2 * count :]
    return Scatter(
        _estimate_scatter(
            left[:count], rows.slope[:count], rows.unknown[:count], frequency_std, LEAST_SCATTER.frequency
        ),
        _estimate_scatter(left[damping] / fitted, basis, unknown, measured.std / fitted, LEAST_SCATTER.damping),
        max(float(np.sqrt(np.mean(shape**2))), LEAST_SCATTER.shape) if shape.size else 1.0,
    )


def _span_within_groups(columns: RealArray, group: IntegerArray) -> RealArray:
    """Orthonormal basis, (n, r), of the means of groups and of columns, (n, t): values that a fit removes."""
    means = np.equal.outer(group, np.unique(group)).astype(float)
    both = np.column_stack([means, columns / np.abs(columns).max(axis=0)])
    vectors, sizes, _ = np.linalg.svd(both, full_matrices=False)
    # Relative columns times the coefficients are near 1, which is a sum of the means.
    return np.asarray(vectors[:, sizes > SAME_COLUMN * sizes[0]])


def _estimate_scatter(
    values: RealArray, columns: RealArray, unknown: RealArray, noise: RealArray, smallest: float
) -> float:
    """Most likely scatter of values beside their noise, by the restricted likelihood [2].

    Args:
        values: Values, (n,).
        columns: Columns, (n, t), which are fitted to the values with the weights 1 / (noise^2 + scatter^2). Other
            weights would let the noise of one value into the residuals of all.
        unknown: Columns, (n, q), whose coefficients are normal with a standard deviation of 1.
        noise: Standard deviations of the values without the scatter, (n,).
        smallest: Smallest scatter.
    """
    largest = float(np.sqrt(np.sum(values**2))) + 2 * smallest
    trials, likelihood = np.geomspace(smallest / 10, largest, SCATTER_TRIALS), []
    held = np.eye(unknown.shape[1], unknown.shape[1] + columns.shape[1] + 1)
    for trial in trials:
        deviation = np.hypot(noise, trial)
        rows = np.column_stack([unknown, columns, values]) / deviation[:, None]
        sizes = np.abs(np.diag(np.linalg.qr(np.vstack([rows, held]), mode="r")))
        logarithms = np.log(np.maximum(sizes[:-1], np.finfo(float).tiny))  # a property without effect has zeros only
        likelihood.append(-np.sum(np.log(deviation)) - np.sum(logarithms) - sizes[-1] ** 2 / 2)
    return max(float(trials[np.argmax(likelihood)]), smallest)


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
    narrow = _invert_normal_matrix(both[:, :-1])
    left = data[:, -1] - data[:, :-1] @ solution
    shares = np.einsum("ni,ij,nj->", data[:, :-1], narrow, data[:, :-1])
    misfit = float(left @ left) / max(left.size - float(shares), 1.0)
    covariance = _invert_normal_matrix(np.vstack([data / np.sqrt(max(misfit, 1.0)), held])[:, :-1])
    moved = problem.factors.copy()
    moved[free] += np.clip((scale * solution)[: len(own)], -LARGEST_STEP, LARGEST_STEP)
    residual, scaled = rows.target - matrix @ (scale * solution), matrix[ratio] * scale
    measured = problem.linear.matched.measured.select(used)
    fitted = measured.damping_ratio - residual[ratio]
    basis = _span_within_groups(rows.columns[ratio] / fitted[:, None], measured.group)
    freedom = max(used.size - basis.shape[1], 1)
    of_scatter = (scatter.damping * measured.damping_ratio) ** 2
    # A mode tells of the scatter by its share in the variance of the mode; the rest is noise.
    known_by = max(float(np.sum((of_scatter / (of_scatter + measured.std**2)) ** 2)) * freedom / used.size, 1.0)
    gain = narrow @ np.linalg.solve(rows.covariance, matrix * scale).T
    share = (gain[:, ratio] ** 2 @ of_scatter / np.diag(narrow))[len(own) :]
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
        freedom=freedom,
        coefficient_freedom=known_by / np.maximum(share, 0.01) ** 2,
        misfit=misfit,
    )


def _whiten(covariance: RealArray, rows: RealArray) -> RealArray:
    """Rows times the inverse of the Cholesky factor of their covariance."""
    return np.asarray(scipy.linalg.solve_triangular(np.linalg.cholesky(covariance), rows, lower=True))


def _invert_normal_matrix(rows: RealArray) -> RealArray:
    """Inverse of A'A from the singular values of rows A: the product A'A has lost half of their digits."""
    inverse = np.linalg.pinv(rows)
    return np.asarray(inverse @ inverse.T)

"""Levenberg-Marquardt refinement of poles."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.linalg.lapack import dposv

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.drops.decay_kernel import (
    join_conjugates,
    kernel_and_derivative,
    real_columns,
    stack_real_imaginary,
)
from pantocheck.conformance.drops.projection import REFINEMENTS, DataBlock, eliminate_columns, prepare_elimination

SMALLEST_DAMPING_RATIO = 1e-6
"""Lower limit of a damping ratio [-]; slower decays are not observable in a record of some minutes."""

NO_SENSORS: NDArray[np.bool_] = np.zeros((0, 0), dtype=np.bool_)
"""Clocks are known."""


@dataclass(frozen=True)
class RefinedPoles:
    """Poles with the smallest output error, in the order of frequency [1/s]."""

    poles: ComplexArray
    """Poles, (m,) [1/s]."""
    cost: float
    """Sum of squared residuals, with channels in units of their noise [-]."""
    information: RealArray
    """Fisher information of the decay rates [s], followed by the angular frequencies [s/rad], (2 m, 2 m)."""

    @property
    def covariance(self) -> RealArray:
        """Covariance of the decay rates [1/s], followed by the angular frequencies [rad/s], (2 m, 2 m)."""
        scale = np.sqrt(np.maximum(np.diag(self.information), np.finfo(float).tiny))
        both = np.outer(scale, scale)
        return np.asarray(scipy.linalg.pinvh(self.information / both) / both)


def refine_poles(
    poles: ComplexArray, blocks: list[DataBlock], iterations: int = 30, tolerance: float = 1e-3
) -> RefinedPoles:
    """Minimise the output error over the poles.

    Args:
        poles: Start values, (m,) [1/s].
        blocks: Data, each channel in units of its noise.
        iterations: Largest number of steps.
        tolerance: Reduction of the cost in one step, below which the refinement ends [-].
    """
    return minimise_cost(poles, lambda trial: build_normal_equations(trial, blocks), iterations, tolerance)


def minimise_cost(
    poles: ComplexArray, build: Callable[[ComplexArray], "NormalEquations"], iterations: int, tolerance: float
) -> RefinedPoles:
    """Minimise the cost of the normal equations that `build` gives at poles; parameters as in `refine_poles`."""
    poles = poles[np.argsort(poles.imag)]
    current = build(poles)
    if not poles.size:
        return RefinedPoles(poles, current.cost, np.zeros((0, 0)))
    damping = 1e-3
    for _ in range(iterations):
        trial_poles = _step(poles, current.matrix, current.gradient, damping)
        trial = build(trial_poles)
        gain = current.cost - trial.cost
        if gain > 0:
            poles, current, damping = trial_poles, trial, max(damping / 10, 1e-9)
            if gain < tolerance:
                break
        elif damping > 1e6 or -gain < tolerance * 1e-3:
            break
        else:
            damping *= 10
    order = np.argsort(poles.imag)
    both = np.concatenate([order, order + poles.size])
    return RefinedPoles(poles[order], current.cost, current.matrix[np.ix_(both, both)])


def _step(poles: ComplexArray, matrix: RealArray, gradient: RealArray, damping: float) -> ComplexArray:
    m, decay = poles.size, -poles.real
    scale = np.sqrt(np.maximum(np.diag(matrix), np.finfo(float).tiny))
    normalised = matrix / np.outer(scale, scale)
    normalised[np.diag_indices_from(normalised)] += damping
    right = gradient / scale
    _, change, failed = dposv(normalised, right)
    if failed:
        change = np.linalg.lstsq(normalised, right, rcond=1e-14)[0]
    change = change / scale
    # The model is nearly linear within a threefold decay rate and a frequency shift of a few bandwidths.
    decay_new = np.clip(decay + change[:m], decay / 3, decay * 3)
    reach = 3 * np.maximum(decay, 0.02)
    omega = np.maximum(poles.imag + np.clip(change[m:], -reach, reach), 1e-3)
    return np.asarray(-np.maximum(decay_new, SMALLEST_DAMPING_RATIO * omega) + 1j * omega)


@dataclass(frozen=True)
class NormalEquations:
    """Gauss-Newton normal equations of the poles: cost r'r, matrix J'J and gradient J'r of residual r and Jacobian J.

    The unknowns are the decay rates, then the angular frequencies.
    """

    cost: float
    matrix: RealArray
    gradient: RealArray


def build_normal_equations(poles: ComplexArray, blocks: list[DataBlock]) -> NormalEquations:
    """Build the normal equations of the poles -delta + i omega, (m,) [1/s], over blocks in units of their noise.

    The residues of each channel are eliminated.
    """
    m = poles.size
    cost, matrix, gradient = 0.0, np.zeros((2 * m, 2 * m)), np.zeros(2 * m)
    for data in blocks:
        if data.whitening is not None:
            part = add_clock_rates(poles, data, NO_SENSORS)
            cost, matrix, gradient = cost + part.cost, matrix + part.matrix, gradient + part.gradient
            continue
        value, slope = kernel_and_derivative(join_conjugates(poles), data.omega, data.dt, data.n)
        columns, derivative = np.hstack([real_columns(value), data.residual_terms]), real_columns(slope)
        fit = eliminate_columns(columns, stack_real_imaginary(data.spectrum), derivative)
        gram, correlation = fit.remainder.T @ fit.remainder, derivative.T @ fit.residual
        cost += float(np.sum(fit.residual**2))
        _accumulate(matrix, gradient, gram, correlation, fit.coefficients[: 2 * m])
    return NormalEquations(cost, matrix, gradient)


def add_clock_rates(poles: ComplexArray, data: DataBlock, sensors: NDArray[np.bool_]) -> NormalEquations:
    """Normal equations of a whitened block with further unknowns: the rate of the clock of each sensor [-].

    Args:
        poles: Poles, (m,) [1/s].
        data: Block in units of its noise.
        sensors: Masks of the channels of each sensor, (s, c).

    Returns:
        Normal equations of decay rates, angular frequencies and rates, (2 m + s).
    """
    value, slope = kernel_and_derivative(join_conjugates(poles), data.omega, data.dt, data.n)
    columns, derivative = np.hstack([real_columns(value), data.residual_terms]), real_columns(slope)
    solve = prepare_elimination(data.expand(columns))
    coefficients, residual = solve(data.signals, 1 + REFINEMENTS)
    residues = coefficients.reshape(-1, data.spectrum.shape[1])[: derivative.shape[1]]
    # A fast clock shows lower poles at its sensor.
    slower = -np.concatenate([-poles.real, poles.imag])
    rates = [data.weigh_slopes(derivative, residues * mask) @ slower for mask in sensors]
    jacobian = solve(np.column_stack([data.weigh_slopes(derivative, residues), *rates]), 1)[1]
    return NormalEquations(float(np.sum(residual**2)), jacobian.T @ jacobian, (jacobian.T @ residual)[:, 0])


def _accumulate(
    matrix: RealArray, gradient: RealArray, gram: RealArray, correlation: RealArray, residues: RealArray
) -> None:
    """Add one block: with a = p + i s, d(model)/d(delta) = -(p D1 + s D2) and d(model)/d(omega) = -s D1 + p D2."""
    m = gram.shape[0] // 2
    p, s = residues[:m], residues[m:]
    pp, ps, ss = p @ p.T, p @ s.T, s @ s.T
    g11, g12, g21, g22 = gram[:m, :m], gram[:m, m:], gram[m:, :m], gram[m:, m:]
    matrix[:m, :m] += pp * g11 + ps * g12 + ps.T * g21 + ss * g22
    cross = ps * g11 - pp * g12 + ss * g21 - ps.T * g22
    matrix[:m, m:] += cross
    matrix[m:, :m] += cross.T
    matrix[m:, m:] += ss * g11 - ps.T * g12 - ps * g21 + pp * g22
    c1, c2 = correlation[:m], correlation[m:]
    gradient[:m] += -np.sum(p * c1 + s * c2, axis=1)
    gradient[m:] += np.sum(-s * c1 + p * c2, axis=1)

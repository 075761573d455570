"""Levenberg-Marquardt refinement of poles."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.linalg.lapack import dposv

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.drops.decay_kernel import join_conjugates, kernel_and_derivative, real_columns
from pantocheck.conformance.drops.elimination import REFINEMENTS, prepare_elimination
from pantocheck.conformance.drops.projection import DataBlock

SMALLEST_DAMPING_RATIO = 1e-6
"""Lower limit of a damping ratio [-]; slower decays are not observable in a record of some minutes."""

IDLE = 30.0
"""Cost of a step by the reach of a pole over the reduction that ends a refinement [-].

Poles that the data do not determine stay. Otherwise rounding moves them: steps along close poles amplify it a
thousandfold each, and the number of poles that are found would depend on the processor. The value was chosen with
drops of 60 kg of `verification/tables/field_coverage.py` in sight.
"""

NO_SENSORS: NDArray[np.bool_] = np.zeros((0, 0), dtype=np.bool_)
"""Clocks are known."""


@dataclass(frozen=True)
class RefinedPoles:
    """Poles with the smallest output error, in the order of frequency [1/s]."""

    poles: ComplexArray
    """Poles, (m,) [1/s]."""
    equations: "NormalEquations"
    """Normal equations at the poles, in the order of the last step."""
    order: NDArray[np.intp]
    """Index of each pole in that order, (m,)."""

    @property
    def cost(self) -> float:
        """Sum of squared residuals, with channels in units of their noise [-]."""
        return self.equations.cost

    @property
    def covariance(self) -> RealArray:
        """Covariance of the decay rates [1/s], followed by the angular frequencies [rad/s], (2 m, 2 m)."""
        if not self.order.size:
            return np.zeros((0, 0))
        both = np.concatenate([self.order, self.order + self.order.size])
        information = self.equations.matrix[np.ix_(both, both)]
        scale = np.sqrt(np.maximum(np.diag(information), np.finfo(float).tiny))
        units = np.outer(scale, scale)
        return np.asarray(scipy.linalg.pinvh(information / units) / units)


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
    damping = 1e-3
    for _ in range(iterations if poles.size else 0):
        trial_poles = _step(poles, current.matrix, current.gradient, damping, IDLE * tolerance)
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
    return RefinedPoles(poles[order], current, order)


def _step(poles: ComplexArray, matrix: RealArray, gradient: RealArray, damping: float, idle: float) -> ComplexArray:
    """Damped step, in which a change by the reach of a pole costs half of `idle`."""
    m, decay, reach = poles.size, -poles.real, find_reach(poles)
    kept = matrix.copy()
    kept.flat[:: 2 * m + 1] += idle / reach**2
    scale = np.sqrt(np.diag(kept))
    normalised = kept / (scale[:, None] * scale)
    normalised.flat[:: scale.size + 1] += damping
    right = gradient / scale
    _, change, failed = dposv(normalised, right)
    if failed:
        change = np.linalg.lstsq(normalised, right, rcond=1e-14)[0]
    change = change / scale
    # The model is nearly linear within a threefold decay rate and a frequency shift of a few bandwidths.
    decay_new = np.minimum(np.maximum(decay + change[:m], decay / 3), decay * 3)
    omega = np.maximum(poles.imag + np.clip(change[m:], -reach[m:], reach[m:]), 1e-3)
    return np.asarray(-np.maximum(decay_new, SMALLEST_DAMPING_RATIO * omega) + 1j * omega)


def bound_estimates(poles: ComplexArray) -> RealArray:
    """Least information on decay rates [s2] and angular frequencies [s2/rad2], (2 m,), for an error of ten reaches.

    Beyond the band, two poles may cancel each other. Their errors would exceed the precision of numbers.
    """
    return np.asarray((10 * find_reach(poles)) ** -2)


def find_reach(poles: ComplexArray) -> RealArray:
    """Changes of decay rates and angular frequencies beyond which a step is not linear, (2 m,) [1/s]."""
    return np.concatenate([-3 * poles.real, 3 * np.maximum(-poles.real, 0.02)])


@dataclass(frozen=True)
class NormalEquations:
    """Gauss-Newton normal equations of the poles: cost r'r, matrix J'J and gradient J'r of residual r and Jacobian J.

    The unknowns are the decay rates, then the angular frequencies.
    """

    cost: float
    derive: Callable[[], tuple[RealArray, RealArray]]
    """Function that computes matrix and gradient, when one of them is read first."""

    @cached_property
    def _derived(self) -> tuple[RealArray, RealArray]:
        return self.derive()

    @property
    def matrix(self) -> RealArray:
        """Matrix J'J."""
        return self._derived[0]

    @property
    def gradient(self) -> RealArray:
        """Gradient J'r."""
        return self._derived[1]


def build_normal_equations(poles: ComplexArray, blocks: list[DataBlock]) -> NormalEquations:
    """Build the normal equations of the poles -delta + i omega, (m,) [1/s], over blocks in units of their noise.

    The residues of each channel are eliminated.
    """
    parts = [
        _build_white(poles, data) if data.whitening is None else add_clock_rates(poles, data, NO_SENSORS)
        for data in blocks
    ]
    if len(parts) == 1:
        return parts[0]

    def derive() -> tuple[RealArray, RealArray]:
        none = np.zeros(2 * poles.size)
        return (
            sum((part.matrix for part in parts), np.outer(none, none)),
            sum((part.gradient for part in parts), none),
        )

    return NormalEquations(sum(part.cost for part in parts), derive)


def _build_white(poles: ComplexArray, data: DataBlock) -> NormalEquations:
    """Normal equations of a block with white noise, whose channels have common columns."""
    m = poles.size
    value, slope = kernel_and_derivative(join_conjugates(poles), data.omega, data.dt, data.n)
    solve = prepare_elimination(data.arrange(np.hstack([real_columns(value), data.residual_terms]))).solve
    coefficients, residual = solve(data.signals, 1 + REFINEMENTS)

    def derive() -> tuple[RealArray, RealArray]:
        """With a = p + i s, d(model)/d(delta) = -(p D1 + s D2) and d(model)/d(omega) = -s D1 + p D2."""
        derivative = real_columns(slope())
        remainder = solve(derivative, 1)[1]
        gram, correlation = remainder.T @ remainder, derivative.T @ residual
        p, s = coefficients[:m], coefficients[m : 2 * m]
        pp, ps, ss = p @ p.T, p @ s.T, s @ s.T
        g11, g12, g21, g22 = gram[:m, :m], gram[:m, m:], gram[m:, :m], gram[m:, m:]
        cross = ps * g11 - pp * g12 + ss * g21 - ps.T * g22
        own = pp * g11 + ps * g12 + ps.T * g21 + ss * g22
        last = ss * g11 - ps.T * g12 - ps * g21 + pp * g22
        matrix = np.vstack([np.hstack([own, cross]), np.hstack([cross.T, last])])
        c1, c2 = correlation[:m], correlation[m:]
        return matrix, np.concatenate([-np.sum(p * c1 + s * c2, axis=1), np.sum(-s * c1 + p * c2, axis=1)])

    return NormalEquations(float(np.sum(residual**2)), derive)


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
    solve = prepare_elimination(data.arrange(np.hstack([real_columns(value), data.residual_terms]))).solve
    coefficients, residual = solve(data.signals, 1 + REFINEMENTS)

    def derive() -> tuple[RealArray, RealArray]:
        derivative = real_columns(slope())
        residues = coefficients.reshape(-1, data.spectrum.shape[1])[: derivative.shape[1]]
        # A fast clock shows lower poles at its sensor.
        slower = -np.concatenate([-poles.real, poles.imag])
        rates = [data.weigh_slopes(derivative, residues * mask) @ slower for mask in sensors]
        jacobian = solve(np.column_stack([data.weigh_slopes(derivative, residues), *rates]), 1)[1]
        return jacobian.T @ jacobian, (jacobian.T @ residual)[:, 0]

    return NormalEquations(float(np.sum(residual**2)), derive)

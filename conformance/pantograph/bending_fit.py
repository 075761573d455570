"""Bending modes of horns and strips from the response of a head: receptances that add to that of a chain.

    1 / D  =  1 / D_chain + sum of a^2 / (w_j^2 + 2 i z_j w_j w - w^2)        a: mass-normalised shape at the head

Chain and modes are fitted together. The chain is then fitted again to the response less its modes, for its intervals.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # loads its parts when they are used

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.pantograph.chain_problem import ChainProblem, MeasuredStiffness, chain_response
from pantocheck.conformance.pantograph.chain_starts import choose_starts

START_FREQUENCIES = 8
"""Number of start frequencies of a further mode, over the upper half of the band."""

START_RATIO = 0.03
"""Damping ratio of a mode at the start."""

EVALUATIONS = 60
"""Largest number of evaluations from each start."""


@dataclass(frozen=True)
class FittedMode:
    """Bending mode of a head."""

    frequency_Hz: float
    damping_ratio: float
    shape: float
    """Mass-normalised displacement of the head [kg^-1/2]."""

    def receptance(self, s: ComplexArray) -> ComplexArray:
        """Displacement of the head per force, at frequencies s = i omega [rad/s], (m,) [m/N]."""
        omega = 2 * np.pi * self.frequency_Hz
        return np.asarray(self.shape**2 / (s**2 + 2 * self.damping_ratio * omega * s + omega**2))


def fit_bending_modes(data: MeasuredStiffness, chain: RealArray, count: int) -> tuple[FittedMode, ...]:
    """Fit a chain and bending modes together; every further mode starts at several frequencies.

    Args:
        data: Measured responses.
        chain: Masses [kg], stiffnesses [N/m] and dampings [N s/m] of a chain fitted without modes, (3, n).
        count: Number of modes.

    Returns:
        Modes by increasing frequency.
    """
    problem = ChainProblem(data, np.full(chain.shape, np.nan))
    size = chain.size
    lower, upper = problem.bounds

    def residuals(parameters: RealArray) -> RealArray:
        flexibility = 1 / chain_response(problem.unpack(parameters[:size]), data.s).stiffness
        flexibility = flexibility + sum_receptances(unpack_modes(parameters[size:]), data.s)
        deviation = -np.log(flexibility * data.stiffness)
        return np.concatenate([data.weight[0] * deviation.real, data.weight[1] * deviation.imag])

    highest = float(data.frequency.max())
    frequencies = np.geomspace(np.sqrt(data.frequency.min() * highest), 1.2 * highest, START_FREQUENCIES)
    # A chain without modes has spent a mass on them: other starts of the chain are needed as well.
    starts = [problem.pack(chain), *choose_starts(problem, [])]
    for number in range(1, count + 1):
        bounds = np.tile([[np.log(data.frequency.min()), -9.0, 1e-4], [np.log(2 * highest), -0.1, 10.0]], number)
        low, high = np.append(lower, bounds[0]), np.append(upper, bounds[1])
        trials = [
            scipy.optimize.least_squares(
                residuals,
                np.clip(np.append(start, [np.log(frequency), np.log(START_RATIO), 0.1]), low, high),
                bounds=(low, high),
                x_scale="jac",
                max_nfev=EVALUATIONS,
            )
            for start in starts
            for frequency in frequencies
        ]
        starts = [min(trials, key=lambda trial: float(trial.cost)).x]
    return tuple(sorted(unpack_modes(starts[0][size:]), key=lambda mode: mode.frequency_Hz))


def unpack_modes(parameters: RealArray) -> list[FittedMode]:
    """Modes from logarithm of the frequency, logarithm of the damping ratio, and shape of each, (3 k,)."""
    return [
        FittedMode(float(np.exp(frequency)), float(np.exp(ratio)), float(shape))
        for frequency, ratio, shape in parameters.reshape(-1, 3)
    ]


def sum_receptances(modes: Sequence[FittedMode], s: ComplexArray) -> ComplexArray:
    """Receptance of all modes at frequencies s = i omega [rad/s], (m,) [m/N]."""
    return np.asarray(sum((mode.receptance(s) for mode in modes), np.zeros(s.size, dtype=np.complex128)))


def remove_modes(data: MeasuredStiffness, modes: Sequence[FittedMode]) -> MeasuredStiffness:
    """Response of the head without its bending modes; the noise of the flexibility remains."""
    stiffness = 1 / (1 / data.stiffness - sum_receptances(modes, data.s))
    return MeasuredStiffness(data.frequency, stiffness, data.weight * np.abs(data.stiffness / stiffness))

"""Starts of the fit of a chain: from a rational function, from a smaller chain, and random ones; all deterministic."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.pantograph.chain_problem import ChainProblem

ELEMENT_DAMPING = (0.1, 0.01)
"""Damping ratios of the elements above the base in the starts from the rational function."""

BASE_ROWS = 6
"""Rows at the lowest frequencies whose imaginary part gives the base damper: the masses move together there."""

SPLIT_SHARES = (0.3, 0.6)
"""Upper shares of a mass that is split in two."""

SPLIT_FREQUENCIES = 12
"""Natural frequencies of a split mass, from the lowest to the highest measured frequency."""

SPLIT_DAMPING = 0.02
"""Damping ratio of a split mass."""

SPLIT_STARTS = 6
"""Starts from a smaller chain: a weak mode is one of the masses that vibrates in itself."""

START_SEED = 20_150_817
"""Seed of the random starts."""

RANDOM_CHAINS = 200
"""Number of random chains; the best ones are starts."""

RANDOM_STARTS = 4
"""Random starts of a fit, for responses whose rational function is not that of a chain."""

MASS_RANGE = (0.1, 2.0)
"""Random masses over the median apparent mass."""

FREQUENCY_RANGE = (0.3, 1.5)
"""Random natural frequencies of the elements over the lowest and the highest measured frequency."""

DAMPING_RANGE = (0.005, 1.0)
"""Random damping ratios of the elements."""


def choose_starts(problem: ChainProblem, smaller: Sequence[RealArray]) -> list[RealArray]:
    """Choose starts of a fit over ascending frequencies, each (p,); `smaller` are fitted chains with one mass less."""
    lower, upper = problem.bounds
    split = _select_best(problem, [chain for each in smaller for chain in _split_masses(each, problem)], SPLIT_STARTS)
    chains = [*_rational_chains(problem), *split, *_random_chains(problem)]
    return [np.clip(problem.pack(chain), lower, upper) for chain in chains]


def _rational_chains(problem: ChainProblem) -> Iterator[RealArray]:
    """Chains whose undamped frequencies are those of a rational function through the response; none if impossible."""
    data, n = problem.data, problem.fixed.shape[1]
    rational = fit_rational_response(data.frequency, data.stiffness, n)
    square = rational.reference**2
    head_mass = float(rational.numerator[-1]) / square
    masses, stiffness = expand_chain(head_mass, square * rational.free_head, square * rational.fixed_head)
    if not (np.isfinite(masses + stiffness).all() and (masses > 0).all() and (stiffness > 0).all()):
        return
    base = data.stiffness[:BASE_ROWS].imag / (2 * np.pi * data.frequency[:BASE_ROWS])
    for ratio in ELEMENT_DAMPING:
        damping = 2 * ratio * np.sqrt(masses * stiffness)
        damping[0] = max(float(np.median(base)), 0.0)
        yield np.array([masses, stiffness, damping])


def _random_chains(problem: ChainProblem) -> list[RealArray]:
    """Best ones of many random chains."""
    random = np.random.default_rng(START_SEED)
    frequency, n = problem.data.frequency, problem.fixed.shape[1]
    scale = float(np.median(np.abs(problem.data.stiffness) / (2 * np.pi * frequency) ** 2))
    size = (RANDOM_CHAINS, n)
    masses = scale * _draw(random, *MASS_RANGE, size)
    low, high = FREQUENCY_RANGE[0] * frequency.min(), FREQUENCY_RANGE[1] * frequency.max()
    omega = 2 * np.pi * _draw(random, low, high, size)
    dampings = 2 * _draw(random, *DAMPING_RANGE, size) * masses * omega
    chains = list(np.stack([masses, masses * omega**2, dampings], axis=1))
    return _select_best(problem, chains, RANDOM_STARTS)


def _split_masses(smaller: RealArray, problem: ChainProblem) -> Iterator[RealArray]:
    """Chains in which one mass of a smaller chain is split in two that vibrate against each other."""
    frequency = problem.data.frequency
    for mass in range(smaller.shape[1]):
        for share in SPLIT_SHARES:
            for split in np.geomspace(frequency[0], frequency[-1], SPLIT_FREQUENCIES):
                omega, reduced = 2 * np.pi * split, share * (1 - share) * smaller[0, mass]
                upper = [share * smaller[0, mass], reduced * omega**2, 2 * SPLIT_DAMPING * reduced * omega]
                chain = np.insert(smaller, mass + 1, upper, axis=1)
                chain[0, mass] *= 1 - share
                yield chain


def _select_best(problem: ChainProblem, chains: Sequence[RealArray], count: int) -> list[RealArray]:
    """Chains with the lowest sums of squares."""
    costs = [float(np.sum(problem.residuals(problem.pack(chain)) ** 2)) for chain in chains]
    return [chains[i] for i in np.argsort(costs, kind="stable")[:count]]


def _draw(random: np.random.Generator, low: float, high: float, size: tuple[int, int]) -> RealArray:
    """Random numbers whose logarithm is uniform."""
    return np.asarray(np.exp(random.uniform(np.log(low), np.log(high), size)))


# Undamped chain from its natural frequencies with free and with fixed head, by a continued fraction.
#
# With z = s^2, the dynamic stiffness of an undamped chain at mass i is
#
# A_i = m_i z + k_i - k_i^2 / (k_i + A_{i-1}),
#
# so that a division of polynomials gives m_i and k_i, and its remainder A_{i-1} (Stieltjes).
def expand_chain(head_mass: float, free_head: RealArray, fixed_head: RealArray) -> tuple[RealArray, RealArray]:
    """Masses and stiffnesses of an undamped chain.

    Args:
        head_mass: Mass of the head [kg].
        free_head: Squared angular frequencies with a free head, (n,) [rad2/s2].
        fixed_head: Squared angular frequencies with a fixed head, (n - 1,) [rad2/s2].

    Returns:
        Masses [kg] and stiffnesses [N/m], base to head, each (n,). They are positive if the frequencies alternate, and
        NaN if a frequency of one list is in the other.
    """
    numerator = head_mass * polynomial.polyfromroots(-free_head)
    denominator = polynomial.polyfromroots(-fixed_head)
    masses, stiffnesses = [], []
    with np.errstate(divide="ignore", invalid="ignore"):
        for _ in free_head:
            mass = numerator[-1] / denominator[-1]
            rest = numerator[:-1] - mass * np.append(0.0, denominator[:-1])
            stiffness = rest[-1] / denominator[-1]
            remainder = (rest - stiffness * denominator)[:-1]
            masses.append(mass)
            stiffnesses.append(stiffness)
            numerator = -stiffness * (stiffness * denominator + np.append(remainder, 0.0))
            denominator = remainder
    return np.array(masses[::-1]), np.array(stiffnesses[::-1])


# Rational function of s = i omega through a measured dynamic stiffness, by iterated linear least squares.
#
# The dynamic stiffness of a chain of n masses is Q(s) / P(s), with the degrees 2 n and 2 n - 2. Each iteration solves
# D P - Q = 0 with weights 1 / |D P| of the last one (Sanathanan and Koerner, 1963), which tends to the relative error.
RATIONAL_ITERATIONS = 30
"""Iterations of the weights; they converge within ten."""


@dataclass(frozen=True)
class RationalResponse:
    """Rational dynamic stiffness Q(s) / P(s) in s over a reference frequency."""

    numerator: RealArray
    """Coefficients of Q, ascending, (2 n + 1,)."""
    denominator: RealArray
    """Coefficients of P, ascending, (2 n - 1,); the last one is 1."""
    reference: float
    """Reference angular frequency [rad/s]."""

    @property
    def free_head(self) -> RealArray:
        """Squared natural frequencies with a free head, over that of reference, ascending, (n,) ndarray."""
        return _squared_frequencies(self.numerator)

    @property
    def fixed_head(self) -> RealArray:
        """Squared natural frequencies with a fixed head, over that of reference, ascending, (n - 1,) ndarray."""
        return _squared_frequencies(self.denominator)


def fit_rational_response(frequency: RealArray, stiffness: ComplexArray, n: int) -> RationalResponse:
    """Fit the rational function of a chain of n masses to a stiffness [N/m] at frequencies [Hz], (m,)."""
    reference = 2 * np.pi * float(np.sqrt(frequency.min() * frequency.max()))
    powers = (2j * np.pi * frequency / reference)[:, None] ** np.arange(2 * n + 1)
    unknown = np.hstack([powers, -stiffness[:, None] * powers[:, : 2 * n - 2]])
    known = stiffness * powers[:, 2 * n - 2]
    poles = np.ones(frequency.size, dtype=np.complex128)
    for _ in range(RATIONAL_ITERATIONS):
        weight = 1 / np.abs(stiffness * poles)
        coefficients = _solve_real(unknown * weight[:, None], known * weight)
        denominator = np.append(coefficients[2 * n + 1 :], 1.0)
        poles = powers[:, : 2 * n - 1] @ denominator
    return RationalResponse(coefficients[: 2 * n + 1], denominator, reference)


def _solve_real(matrix: NDArray[Any], right: NDArray[Any]) -> RealArray:
    """Real least-squares solution of a complex system, with columns of unit size."""
    rows = np.vstack([matrix.real, matrix.imag])
    scale = np.linalg.norm(rows, axis=0)
    return np.asarray(np.linalg.lstsq(rows / scale, np.concatenate([right.real, right.imag]))[0] / scale)


def _squared_frequencies(coefficients: RealArray) -> RealArray:
    """Products of the roots of a polynomial in pairs: conjugate ones, or neighbouring real ones."""
    sizes = np.sort(np.abs(polynomial.polyroots(coefficients)))
    return np.asarray(sizes[0::2] * sizes[1::2])

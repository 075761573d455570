"""Starts of the fit of a chain: from a rational function, from a smaller chain, and random ones; all deterministic."""

from collections.abc import Iterator, Sequence

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.pantograph_fit.chain_problem import ChainProblem
from pantocheck.conformance.identification.pantograph_fit.continued_fraction import expand_chain
from pantocheck.conformance.identification.pantograph_fit.rational_response import fit_rational_response

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
"""Random chains of which the best ones are starts."""

RANDOM_STARTS = 4
"""Random starts of a fit, for responses whose rational function is not that of a chain."""

MASS_RANGE = (0.1, 2.0)
"""Random masses over the median apparent mass."""

FREQUENCY_RANGE = (0.3, 1.5)
"""Random natural frequencies of the elements over the lowest and the highest measured frequency."""

DAMPING_RANGE = (0.005, 1.0)
"""Random damping ratios of the elements."""


def choose_starts(problem: ChainProblem, smaller: Sequence[RealArray]) -> list[RealArray]:
    """Choose starts of a fit.

    Args:
        problem: Fit of a chain; its frequencies ascend.
        smaller: Fitted chains with one mass less, each (3, n - 1).

    Returns:
        Free parameters of each start, each (p,).
    """
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

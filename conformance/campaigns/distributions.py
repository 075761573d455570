"""Distributions of random inputs, as quantile functions of a number between 0 and 1."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field
from scipy.special import ndtr, ndtri

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    Positive,
    PositiveList,
    Problems,
    cross_check,
    validation_problem,
)

SMALLEST_PROBABILITY = 2.0**-40
"""Distance of a probability from 0 and 1: a sampler may return 0, whose normal quantile is infinite."""


class Uniform(InputTable):
    """Uniform distribution between two values."""

    kind: Literal["uniform"]
    lower: float
    """Smallest value."""
    upper: float
    """Largest value."""

    @cross_check
    def _check_order(self) -> Problems:
        yield from _find_reversed(self.lower, self.upper)

    def quantiles(self, probability: RealArray) -> RealArray:
        """Values at some probabilities."""
        return self.lower + (self.upper - self.lower) * probability


class Normal(InputTable):
    """Normal distribution."""

    kind: Literal["normal"]
    mean: float
    """Mean value."""
    std: Positive
    """Standard deviation."""

    def quantiles(self, probability: RealArray) -> RealArray:
        """Values at some probabilities."""
        values: RealArray = self.mean + self.std * ndtri(
            np.clip(probability, SMALLEST_PROBABILITY, 1 - SMALLEST_PROBABILITY)
        )
        return values


class TruncatedNormal(InputTable):
    """Normal distribution of `mean` and `std`, restricted to the values between two bounds."""

    kind: Literal["truncated-normal"]
    mean: float
    """Mean of the distribution before its truncation."""
    std: Positive
    """Standard deviation before the truncation."""
    lower: float
    """Smallest value."""
    upper: float
    """Largest value."""

    @cross_check
    def _check_order(self) -> Problems:
        yield from _find_reversed(self.lower, self.upper)

    def quantiles(self, probability: RealArray) -> RealArray:
        """Values at some probabilities: the inverse of the distribution function, rescaled to the part that is left.

        Above the mean the mirrored distribution is inverted, because probabilities near 1 lose their digits.
        """
        lower, upper = (self.lower - self.mean) / self.std, (self.upper - self.mean) / self.std
        sign = -1.0 if lower > 0 else 1.0
        start, end = ndtr(sign * lower), ndtr(sign * upper)
        values: RealArray = self.mean + sign * self.std * ndtri(start + (end - start) * probability)
        return np.clip(values, self.lower, self.upper)


class Discrete(InputTable):
    """Distribution over listed values."""

    kind: Literal["discrete"]
    values: Annotated[tuple[Any, ...], Field(strict=False, min_length=1, max_length=1000)]
    """Values of the input."""
    weights: PositiveList | None = None
    """Relative frequency of each value; default: all alike."""

    @cross_check
    def _check_weights(self) -> Problems:
        if self.weights is not None and len(self.weights) != len(self.values):
            found = f"{len(self.weights)} weights for {len(self.values)} values"
            yield validation_problem("weights", found, "Give one weight per value.")

    def choices(self, probability: RealArray) -> RealArray:
        """Index of the value at some probabilities."""
        weights = np.ones(len(self.values)) if self.weights is None else np.array(self.weights)
        ends = np.cumsum(weights) / np.sum(weights)
        return np.minimum(np.searchsorted(ends, probability, side="right"), len(self.values) - 1)


class Seed(InputTable):
    """Seed of random values of a line: numbers without an order, so that no line is fitted to their effect."""

    kind: Literal["seed"]

    def seeds(self, probability: RealArray) -> RealArray:
        """Whole numbers from 0 to 2^31 - 1 at some probabilities."""
        return np.floor(probability * 2.0**31)


Distribution = Annotated[Uniform | Normal | TruncatedNormal | Discrete | Seed, Field(discriminator="kind")]
"""Distribution of a random input."""


def _find_reversed(lower: float, upper: float) -> Problems:
    if upper <= lower:
        yield validation_problem("upper", f"{upper:g} is not greater than lower = {lower:g}", "Swap them.")

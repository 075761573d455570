"""Fits of chains with different numbers of masses to measured responses, and the choice between them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.pantograph.chain_fit import ChainFit, FitIntervals, compute_intervals, fit_chain
from pantocheck.conformance.pantograph.chain_problem import MeasuredStiffness
from pantocheck.conformance.pantograph.response_record import ResponseRecord

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


@dataclass(frozen=True)
class ChainSelection:
    """Fitted chains."""

    fits: dict[int, ChainFit]
    """Fit by number of masses."""
    is_noise_stated: bool
    """Whether every record states its uncertainty."""

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

    Args:
        records: Measured responses at the centre of the head.
        task: Choices.

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
    fits = {n: fit_chain(data, np.full((3, n), np.nan) if task.fixed is None else task.fixed) for n in counts}
    return ChainSelection(fits, all(record.uncertainty is not None for record in records))


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

"""Uncertainty of statistics from the length of a record: the moving-block bootstrap.

The force repeats itself from span to span, but not exactly; a longer record would have a somewhat different mean, sigma
and extremes. Blocks of one span, drawn at random with replacement from the record, stand for other records of the same
length (Kuensch 1989, doi:10.1214/aos/1176347265); how much a statistic varies among them is its uncertainty.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.measured.pooled_signals import PooledSignals

BOOTSTRAP_REPLICATES = 1000
FEWEST_BLOCKS = 5
"""Blocks a record must hold: from fewer, the spread of a statistic cannot be told."""

COVERAGE = 1.96
"""Standard deviations to either side of an interval of 95 %."""


@dataclass(frozen=True)
class _Draws:
    """Which blocks each replicate is made of: (replicates, blocks) starts within the joined parts, and their length."""

    starts: RealArray
    length: int


def bootstrap_uncertainties(signals: PooledSignals, block_s: float, digest: str) -> dict[str, float]:
    """Half-width of the 95 % interval of the statistics of a record, by quantity; none if the record is too short.

    For the largest and smallest value it says how much depends on single events of the record; that a longer record
    can bring larger ones, no resampling shows.

    Parameters
    ----------
    signals : PooledSignals
        Of one pantograph.
    block_s : float
        Length of a block [s]; one span.
    digest : str
        SHA-256 of the record in hexadecimal, from which the random numbers are seeded.
    """
    parts = signals.parts
    draws = _draws([part.delivered.size for part in parts], block_s * parts[0].rate, digest) if parts else None
    if draws is None:
        return {}
    found: dict[str, RealArray] = {}
    mean = _means(signals.delivered, draws)
    found["mean_force_N"] = mean
    for name, ratio, series in (("std_force_N", "cov_20", "graded"), ("std_force_50_N", "cov_50", "extended")):
        try:
            force: RealArray = getattr(signals, series)
        except QuantityUnavailable:
            continue
        centred = force - force.mean()  # the difference of two large numbers would lose digits
        deviation = np.sqrt(np.maximum(_means(centred**2, draws) - _means(centred, draws) ** 2, 0))
        found[name] = deviation
        if mean.min() > 0:
            found[ratio] = deviation / mean
        if series == "graded":
            found["statistical_min_N"], found["statistical_max_N"] = mean - 3 * deviation, mean + 3 * deviation
            found["max_force_N"], found["min_force_N"] = _maxima(force, draws), -_maxima(-force, draws)
    if signals.filter_applied_Hz is None:
        found["contact_loss_pct"] = 100 * _means((signals.delivered <= 0).astype(np.float64), draws)
    try:
        height = 1e3 * signals.height
        found["contact_height_range_mm"] = _maxima(height, draws) + _maxima(-height, draws)
    except QuantityUnavailable:
        pass
    # The spread among n blocks is that about their own mean: smaller by (n - 1) / n than about the true one.
    blocks = draws.starts.shape[1]
    wider = COVERAGE * np.sqrt(blocks / (blocks - 1))
    return {name: float(wider * values.std()) for name, values in found.items()}


def _draws(sizes: list[int], block: float, digest: str) -> _Draws | None:
    length = max(1, round(block))
    blocks = round(sum(sizes) / length)
    firsts = np.cumsum([0, *sizes[:-1]])
    # A block lies within one part: across a gap there is no span.
    starts = [first + np.arange(size - length + 1) for first, size in zip(firsts, sizes, strict=True) if size >= length]
    if blocks < FEWEST_BLOCKS or not starts:
        return None
    random = np.random.default_rng(int(digest[:16], 16))
    return _Draws(random.choice(np.concatenate(starts), size=(BOOTSTRAP_REPLICATES, blocks)), length)


def _means(series: RealArray, draws: _Draws) -> RealArray:
    """Mean of a series in every replicate."""
    sums = np.concatenate([[0.0], np.cumsum(series)])
    return np.asarray((sums[draws.starts + draws.length] - sums[draws.starts]).mean(axis=1) / draws.length)


def _maxima(series: RealArray, draws: _Draws) -> RealArray:
    """Maximum of a series in every replicate."""
    # The filter is centred; its origin is moved so that it looks forward from the start of a block.
    ahead = maximum_filter1d(series, draws.length, origin=-(draws.length // 2), mode="nearest")
    return np.asarray(ahead[draws.starts].max(axis=1))

"""Uncertainty of statistics from the length of a record: the moving-block bootstrap.

The force differs from span to span, so that another record of the same length would have somewhat different statistics.
Replicates represent such records: they consist of blocks of one span, drawn at random with replacement (Kuensch 1989,
doi:10.1214/aos/1176347265). The scatter of a statistic among the replicates gives its uncertainty.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.bands import Band
from pantocheck.conformance.quantities.force_quantities import PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.pantograph_signals import ForceSignals, PantographSignals
from pantocheck.conformance.quantities.stated_quantities import SignalsOutside, list_stated
from pantocheck.conformance.quantities.statistics import Sampling
from pantocheck.conformance.quantities.unavailable import ChannelMissing, QuantityUnavailable, SectionNotCovered

BOOTSTRAP_REPLICATES = 1000
FEWEST_BLOCKS = 5
"""Smallest number of blocks in a record; fewer blocks do not give the scatter of a statistic."""

NORMAL_QUANTILE = 1.96
"""Half-width of a 95 % interval in standard deviations."""


@dataclass(frozen=True)
class BlockReplicates(Sampling):
    """Statistics of each bootstrap replicate."""

    starts: NDArray[np.intp]
    """First sample of each block within the analysis section, (replicates, blocks)."""
    length: int
    """Number of samples in a block."""

    def mean(self, series: RealArray) -> RealArray:
        """Mean value of each replicate."""
        sums = np.concatenate([[0.0], np.cumsum(series)])
        return np.asarray((sums[self.starts + self.length] - sums[self.starts]).mean(axis=1) / self.length)

    def std(self, series: RealArray) -> RealArray:
        """Standard deviation of each replicate."""
        centred = series - series.mean()  # the difference of two large numbers would lose digits
        return np.asarray(np.sqrt(np.maximum(self.mean(centred**2) - self.mean(centred) ** 2, 0)))

    def apply(self, statistic: Callable[[RealArray], float], series: RealArray) -> RealArray:
        """Any other statistic of the samples of each replicate."""
        block = np.arange(self.length)
        return np.array([statistic(series[(starts[:, None] + block).ravel()]) for starts in self.starts])

    def largest(self, series: RealArray) -> RealArray:
        """Largest value of each replicate."""
        # The filter is centred; its origin is moved so that it looks forward from the start of a block.
        ahead = scipy.ndimage.maximum_filter1d(series, self.length, origin=-(self.length // 2), mode="nearest")
        return np.asarray(ahead[self.starts].max(axis=1))

    def smallest(self, series: RealArray) -> RealArray:
        """Smallest value of each replicate."""
        return -self.largest(-series)

    def extent(self, series: RealArray, scale: float) -> RealArray:
        """Largest minus smallest value of each replicate, times a scale that converts its unit."""
        return self.largest(scale * series) - self.smallest(scale * series)

    def percentage(self, condition: NDArray[np.bool_]) -> RealArray:
        """Share of the samples that meet a condition [%], for each replicate."""
        return 100 * self.mean(condition.astype(np.float64))

    def band_rms(self, signals: ForceSignals, band: Band) -> RealArray:
        """RMS of the contact force in a frequency band of each replicate [N].

        The blocks are drawn from the part of the force inside the band: joints between blocks of the force itself would
        add content to its spectrum.
        """
        signals.band(band.low, band.high)  # raises if the record does not support the band
        return np.asarray(np.sqrt(self.mean(signals.band_part(band.low, band.high) ** 2)))


def bootstrap_uncertainties(
    signals: PantographSignals | SignalsOutside, block_s: float, digest: str
) -> dict[str, float]:
    """Half-widths of the 95 % intervals of the statistics of a record.

    The uncertainty of the largest and smallest value shows their dependence on single events of the record. It does not
    show that a longer record may contain larger events.

    Args:
        signals: Signals of one pantograph, with or without excluded stretches.
        block_s: Length of a block: one span [s].
        digest: SHA-256 of the case or of the samples in hexadecimal, which is the seed of the random numbers.

    Returns:
        Half-widths by quantity; empty if the analysis section is not covered or too short.
    """
    deviations = bootstrap_deviations(signals, block_s, digest)
    return {name: float(NORMAL_QUANTILE * values.std()) for name, values in deviations.items()}


def bootstrap_deviations(
    signals: PantographSignals | SignalsOutside, block_s: float, digest: str
) -> dict[str, RealArray]:
    """Deviations of the statistics of the replicates from their mean, by quantity; parameters as above."""
    try:
        replicates = _draw_blocks(signals.delivered.size, block_s * signals.force.rate, digest)
    except (SectionNotCovered, ChannelMissing):
        return {}
    if replicates is None:
        return {}
    # The variance of n blocks about their own mean is (n - 1) / n of the variance about the true mean.
    blocks = replicates.starts.shape[1]
    wider = np.sqrt(blocks / (blocks - 1))
    deviations = {}
    for quantity in (*PANTOGRAPH_QUANTITIES, *list_stated(signals)):
        try:
            values = quantity.compute(signals, replicates)
            deviations[quantity.name] = wider * (values - values.mean())
        except QuantityUnavailable:
            continue
    return deviations


def _draw_blocks(size: int, block: float, digest: str) -> BlockReplicates | None:
    length = max(1, round(block))
    blocks = round(size / length)
    if blocks < FEWEST_BLOCKS:
        return None
    random = np.random.default_rng(int(digest[:16], 16))
    return BlockReplicates(random.choice(size - length + 1, size=(BOOTSTRAP_REPLICATES, blocks)), length)

"""Sampling: elementary statistics of a series, over the whole record or for each replicate of a bootstrap."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.bands import Band
from pantocheck.conformance.quantities.force_signals import ForceSignals


class Sampling:
    """Statistics of all samples of the analysis section, as arrays of shape ().

    A subclass for a bootstrap returns one number per replicate, as arrays of shape (replicates,).
    """

    def mean(self, series: RealArray) -> RealArray:
        """Mean value."""
        return np.asarray(series.mean())

    def std(self, series: RealArray) -> RealArray:
        """Standard deviation."""
        return np.asarray(series.std())

    def apply(self, statistic: Callable[[RealArray], float], series: RealArray) -> RealArray:
        """Any other statistic of the samples, such as `np.median`."""
        return np.asarray(statistic(series))

    def largest(self, series: RealArray) -> RealArray:
        """Largest value."""
        return np.asarray(series.max())

    def smallest(self, series: RealArray) -> RealArray:
        """Smallest value."""
        return np.asarray(series.min())

    def extent(self, series: RealArray, scale: float) -> RealArray:
        """Largest minus smallest value, times a scale that converts its unit."""
        return np.asarray(scale * np.ptp(series))

    def percentage(self, condition: NDArray[np.bool_]) -> RealArray:
        """Share of the samples that meet a condition [%]."""
        return np.asarray(100 * np.count_nonzero(condition) / condition.size)

    def band_rms(self, signals: ForceSignals, band: Band) -> RealArray:
        """RMS of the contact force in a frequency band [N]."""
        return np.asarray(signals.band(band.low, band.high))


WHOLE_RECORD = Sampling()

"""Sampling: elementary statistics of a series, for a whole record or for each replicate of a bootstrap."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.bands import Band
from pantocheck.conformance.quantities.signals import ForceSignals


class Sampling(Protocol):
    """Statistics of a series; each result has one number per sample of the population.

    The whole record gives arrays of shape (), a bootstrap gives arrays of shape (replicates,).
    """

    def mean(self, series: RealArray) -> RealArray:
        """Mean value."""

    def std(self, series: RealArray) -> RealArray:
        """Standard deviation."""

    def largest(self, series: RealArray) -> RealArray:
        """Largest value."""

    def smallest(self, series: RealArray) -> RealArray:
        """Smallest value."""

    def extent(self, series: RealArray, scale: float) -> RealArray:
        """Largest minus smallest value, times a scale that converts its unit."""

    def percentage(self, condition: NDArray[np.bool_]) -> RealArray:
        """Share of the samples that meet a condition [%]."""

    def band_rms(self, signals: ForceSignals, band: Band) -> RealArray:
        """RMS of the contact force in a frequency band [N]."""


class WholeRecord:
    """Statistics of all samples of the analysis section."""

    def mean(self, series: RealArray) -> RealArray:
        """Mean value."""
        return np.asarray(series.mean())

    def std(self, series: RealArray) -> RealArray:
        """Standard deviation."""
        return np.asarray(series.std())

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


WHOLE_RECORD = WholeRecord()

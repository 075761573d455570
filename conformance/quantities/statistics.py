"""Statistics of the contact force over the analysis section."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.bands import Band
from pantocheck.conformance.quantities.pantograph_signals import ForceSignals
from pantocheck.conformance.quantities.unavailable import AlreadyFiltered, NoMeanForce


# Sampling: elementary statistics of a series, over the whole record or for selections of its spans.
class Sampling:
    """Statistics of all samples of the analysis section, as arrays of shape ().

    A subclass returns one number per selection of spans, as arrays of shape (selections,).
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


Estimate = TypeVar("Estimate", float, RealArray)
"""A statistic of a record, or one value per selection of spans."""


def coefficient_of_variation(mean: Estimate, deviation: Estimate) -> Estimate:
    """Standard deviation over mean force [-], both in [N] (EN 50317 practice; Vo Van et al. 2015, Table 1).

    Raises:
        NoMeanForce: The mean is not positive.
    """
    if np.min(mean) <= 0:
        raise NoMeanForce(f"the mean force is {np.min(mean):.4g} N; a coefficient of variation needs a positive mean")
    return deviation / mean


def statistical_extremes(mean: Estimate, deviation: Estimate) -> tuple[Estimate, Estimate]:
    """Statistical minimum and maximum, mean -+ 3 standard deviations [N]."""
    return mean - 3 * deviation, mean + 3 * deviation


def contact_loss(force: RealArray, filter_applied_Hz: float | None, sampling: Sampling) -> RealArray:
    """Share of samples without contact [%].

    Args:
        force: Unfiltered contact force over the analysis section, (n,) [N]; no contact is zero force.
        filter_applied_Hz: Cut-off of the low-pass filter applied before delivery [Hz]; None: unfiltered.
        sampling: Whole record, or selections of its spans.

    Returns:
        Share of the samples [%], or one share per selection.

    Raises:
        AlreadyFiltered: The force was filtered; a filter smooths a contact loss to a low force.
    """
    check_unfiltered(filter_applied_Hz)
    return sampling.percentage(force <= 0)


def check_unfiltered(filter_applied_Hz: float | None) -> None:
    """Refuse a filtered force for contact losses; parameter and error as in `contact_loss`."""
    if filter_applied_Hz is not None:
        raise AlreadyFiltered(
            f"the force was low-pass filtered at {filter_applied_Hz:g} Hz before delivery; "
            "contact losses can only be counted in an unfiltered force"
        )


def force_histogram(force: RealArray) -> tuple[RealArray, RealArray]:
    """Histogram of a force with about 30 classes; their width is 1, 2 or 5 times a power of ten.

    Args:
        force: Contact force, (n,) [N].

    Returns:
        edges: Class edges, (k + 1,) [N].
        share: Share of the samples in each class, (k,) [%].
    """
    spread = float(np.ptp(force))
    raw = max(spread, 1.0) / 30
    decade = 10 ** np.floor(np.log10(raw))
    width = decade * next(step for step in (1, 2, 5, 10) if step * decade >= raw * (1 - 1e-9))
    first, last = np.floor(force.min() / width), np.floor(force.max() / width) + 1
    edges = np.arange(first, last + 1) * width
    counts, _ = np.histogram(force, edges)
    return edges, 100 * counts / force.size

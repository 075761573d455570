"""Uncertainty of statistics from the length of a record.

The force differs from span to span, so that another record of the same length would have somewhat different statistics.

Influence of a span: n - 1 times the change of a statistic if the span is left out (jackknife). The mean of the
influences has the variance of the statistic. Neighbouring spans are correlated. The variance is therefore taken from
the slowest fluctuations along the record: the coefficients of the influences in the cosines of 1/2, 1, ... 3 periods
(Lazarus, Lewis, Stock and Watson 2018, doi:10.1080/07350015.2018.1506926). Six coefficients give a Student variate with
six degrees of freedom. Skewed influences widen the interval: its error of coverage grows with the square of the
skewness of the mean (Hall 1992, doi:10.1007/978-1-4612-4384-7).

Extremes: the extreme of a record scatters about its expected value, the return level of the record. Its scatter follows
from the extremes of the spans by a generalised extreme value distribution (Hosking, Wallis and Wood 1985,
doi:10.1080/00401706.1985.10488049). Their interval has no stated share: it depends on the tail of the distribution.

The settings were chosen on records of the process of verification/tables/coverage.py with other seeds.
docs/tables/coverage.csv and coverage-simulated.csv show how often the intervals contain the true value.
"""

import math
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property, partial
from typing import TypeVar

import numpy as np
import scipy  # loads scipy.special when it is used: its import takes longer than a listing of the cases
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.near_limit import QUANTILE_95
from pantocheck.conformance.quantities.bands import Band
from pantocheck.conformance.quantities.force_quantities import LINE_QUANTITIES, PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import ForceSignals, PantographSignals
from pantocheck.conformance.quantities.quantity import PantographQuantity
from pantocheck.conformance.quantities.stated_quantities import SignalsOutside, list_stated
from pantocheck.conformance.quantities.statistics import WHOLE_RECORD, Sampling
from pantocheck.conformance.quantities.unavailable import ChannelMissing, QuantityUnavailable, SectionNotCovered

FEWEST_SPANS = 5
"""Smallest number of spans that show how a statistic varies along a record."""

FEWEST_SPANS_INTERVAL = 60
"""Smallest number of spans for an interval; fewer do not show a correlation of neighbouring spans."""

MOST_BLOCKS = 500
"""Largest number of parts of a record; the parts of a longer record have more than one span."""

COSINES = 6
"""Number of cosines, the degrees of freedom. Fewer give wide intervals, more leave out the slow fluctuations."""

LARGEST_CORRELATION = 0.85
"""Largest assumed correlation of neighbouring spans [-]; 60 spans do not show a larger one."""

CORRELATION_ERRORS = 2.0
"""Standard errors between the estimated and the assumed correlation."""

SKEWNESS_WIDENING, LARGEST_WIDENING = 0.4, 0.2
"""Relative widening per square of the skewness of the mean influence, and its largest value."""

FEWEST_DEGREES = 3.0
"""Smallest number of degrees of freedom of the scale of an extreme; jackknife estimates of it scatter."""

SAME_VALUE = 0.01
"""Difference of equal values over the standard deviation [-]; the spans differ by one sample in length."""

GUMBEL_HALF_WIDTH = 2.429
"""Half-width that contains 95 % of a Gumbel variate about its mean, in units of its scale."""


@dataclass(frozen=True)
class SpanInterval:
    """Interval from the fluctuations along the record."""

    contributions: RealArray
    """Contribution of each cosine to the deviation, (cosines,), on the scale of the interval."""
    scatter: float
    """Standard deviation of the part without correlation to other quantities, on the same scale."""
    change: Callable[[RealArray], RealArray]
    """Function that gives the change of the value for deviations on this scale."""

    @property
    def half_width(self) -> float:
        """Larger one of the distances between the value and the ends of the interval."""
        deviation = np.hypot(np.linalg.norm(self.contributions), self.scatter)
        return float(self.change(np.asarray(_student_quantile(COSINES) * deviation)))


class StatisticInterval(SpanInterval):
    """Interval of a statistic, which contains the true value in 89 to 99 % of the records of two benchmarks."""


class ExtremeInterval(SpanInterval):
    """Interval of an extreme about its return level, without a stated share."""


@dataclass(frozen=True)
class SubRecordRange:
    """Range of the values of all stretches of half the record. No share of true values is stated."""

    half_width: float
    """Largest distance from the value of the record."""


LengthUncertainty = StatisticInterval | ExtremeInterval | SubRecordRange
"""Uncertainty of a value from the length of the record."""


@dataclass(frozen=True)
class SpanSelections(Sampling):
    """Statistics of the spans of each selection."""

    starts: NDArray[np.intp]
    """First sample of each span within the analysis section, and the number of samples, (spans + 1,)."""
    kept: NDArray[np.bool_]
    """Whether a selection contains a span, (selections, spans)."""

    @cached_property
    def sizes(self) -> NDArray[np.intp]:
        """Number of samples in each span."""
        return np.diff(self.starts)

    def mean(self, series: RealArray) -> RealArray:
        """Mean value of each selection."""
        return np.asarray(self.kept @ np.add.reduceat(series, self.starts[:-1]) / (self.kept @ self.sizes))

    def std(self, series: RealArray) -> RealArray:
        """Standard deviation of each selection."""
        centred = series - series.mean()  # the difference of two large numbers would lose digits
        return np.asarray(np.sqrt(np.maximum(self.mean(centred**2) - self.mean(centred) ** 2, 0)))

    def apply(self, statistic: Callable[[RealArray], float], series: RealArray) -> RealArray:
        """Any other statistic of the samples of each selection."""
        return np.array([statistic(series[np.repeat(spans, self.sizes)]) for spans in self.kept])

    def largest(self, series: RealArray) -> RealArray:
        """Largest value of each selection."""
        maxima = np.maximum.reduceat(series, self.starts[:-1])
        return np.asarray(np.where(self.kept, maxima, -np.inf).max(axis=1))

    def smallest(self, series: RealArray) -> RealArray:
        """Smallest value of each selection."""
        return -self.largest(-series)

    def extent(self, series: RealArray, scale: float) -> RealArray:
        """Largest minus smallest value of each selection, times a scale that converts its unit."""
        return self.largest(scale * series) - self.smallest(scale * series)

    def percentage(self, condition: NDArray[np.bool_]) -> RealArray:
        """Share of the samples that meet a condition [%], for each selection."""
        return 100 * self.mean(condition.astype(np.float64))

    def band_rms(self, signals: ForceSignals, band: Band) -> RealArray:
        """RMS of the contact force in a frequency band of each selection [N].

        The spans are taken from the part of the force inside the band: joints between spans of the force itself would
        add content to its spectrum.
        """
        signals.band(band.low, band.high)  # raises if the record does not support the band
        return np.asarray(np.sqrt(self.mean(signals.band_part(band.low, band.high) ** 2)))


class SingleSpans(SpanSelections):
    """Statistics of each span."""

    def extent(self, series: RealArray, scale: float) -> RealArray:
        """Largest and negative smallest value of each span, (2, spans), whose maxima add up to that of the record."""
        return np.array([self.largest(scale * series), self.largest(-scale * series)])


def length_uncertainties(signals: PantographSignals | SignalsOutside, span_s: float) -> dict[str, LengthUncertainty]:
    """Uncertainties of the statistics of a record from its length.

    Args:
        signals: Signals of one pantograph, with or without excluded stretches.
        span_s: Time of a span [s].

    Returns:
        Uncertainties by quantity; empty if the analysis section is not covered or too short. A quantity of zero that is
        never negative has none.
    """
    found: dict[str, LengthUncertainty] = {}
    try:
        size = signals.delivered.size
    except (SectionNotCovered, ChannelMissing):
        return found
    spans = min(round(size / max(span_s * signals.force.rate, 1.0)), MOST_BLOCKS)
    if spans < FEWEST_SPANS:
        return found
    starts = np.round(np.linspace(0, size, spans + 1)).astype(np.intp)
    for quantity in (*PANTOGRAPH_QUANTITIES, *list_stated(signals)):
        try:
            value = float(quantity.compute(signals, WHOLE_RECORD))
            if value != 0 or not quantity.never_negative:
                found[quantity.name] = _find_uncertainty(quantity, signals, value, starts)
        except QuantityUnavailable:
            continue
    return {name: uncertainty for name, uncertainty in found.items() if np.isfinite(uncertainty.half_width)}


def uplift_uncertainties(line: LineSignals) -> dict[str, LengthUncertainty]:
    """Uncertainties of the extremes at the supports, by quantity; empty below `FEWEST_SPANS_INTERVAL` supports."""
    found: dict[str, LengthUncertainty] = {}
    for quantity in LINE_QUANTITIES:
        try:
            quantity.needs.check(line)
            values = quantity.support_values(line)
        except QuantityUnavailable:
            continue
        if values.size >= FEWEST_SPANS_INTERVAL and not _is_sparse(values):
            found[quantity.name] = _extreme_interval(values[None, :])
    return found


def _find_uncertainty(
    quantity: PantographQuantity, signals: ForceSignals, value: float, starts: NDArray[np.intp]
) -> LengthUncertainty:
    index = np.arange(starts.size - 1)
    single = index[:, None] == index
    if index.size >= FEWEST_SPANS_INTERVAL:
        if quantity.extreme:
            sign = {"largest": 1, "smallest": -1}[quantity.extreme]
            extremes = np.atleast_2d(sign * quantity.compute(signals, SingleSpans(starts, single)))
            if not any(map(_is_sparse, extremes)):
                return _extreme_interval(extremes)
        else:
            others = quantity.compute(signals, SpanSelections(starts, ~single))
            if not _is_sparse(others) and not (quantity.never_negative and np.min(others) <= 0):
                return _statistic_interval(others, value, quantity.never_negative)
    half = (index.size + 1) // 2
    first = np.arange(index.size - half + 1)[:, None]
    stretches = SpanSelections(starts, (first <= index) & (index < first + half))
    return SubRecordRange(float(np.max(np.abs(quantity.compute(signals, stretches) - value))))


def _is_sparse(values: RealArray) -> bool:
    """Whether more than half of the spans have the same value, as for contact losses in a few spans."""
    if not np.isfinite(values).all():
        return True
    distance = np.abs(values - np.median(values))
    return bool(np.mean(distance <= SAME_VALUE * values.std()) > 0.5)


def _statistic_interval(others: RealArray, value: float, never_negative: bool) -> StatisticInterval:
    """Interval of a statistic from its values without one span, (spans,).

    The logarithm of a quantity that is never negative has a more symmetrical distribution than the quantity.
    """
    change = partial(_relative_change, value) if never_negative else np.asarray
    others = np.log(others) if never_negative else others
    influence = (others.size - 1) * (others.mean() - others)
    return StatisticInterval((1 + _skewness_widening(influence)) * cosine_contributions(influence), 0.0, change)


def _relative_change(value: float, deviation: RealArray) -> RealArray:
    return value * np.expm1(deviation)


def cosine_contributions(influence: RealArray) -> RealArray:
    """Contributions of the cosines to the standard deviation of the mean influence, (cosines,).

    The spectrum of the influences decreases with frequency if neighbouring spans are correlated. The coefficients are
    therefore multiplied by the ratio of the spectra at zero and at their frequency for an autoregression of first
    order. Its coefficient is the estimate with the correction of the bias (Kendall 1954,
    doi:10.1093/biomet/41.3-4.403) and `CORRELATION_ERRORS` standard errors.
    """
    n = influence.size
    frequency, cosines = _list_cosines(n)
    rho = _upper_correlation(influence)
    spectrum_ratio = (1 - 2 * rho * np.cos(frequency) + rho**2) / (1 - rho) ** 2
    finite_length = 1 - 2 * rho * (1 - rho**n) / (n * (1 - rho**2))
    return np.asarray(cosines @ influence * np.sqrt(spectrum_ratio * finite_length / (n * COSINES)))


@cache
def _list_cosines(n: int) -> tuple[RealArray, RealArray]:
    """Frequencies per span times 2 pi, (cosines,), and orthonormal cosines, (cosines, n)."""
    frequency = np.pi * np.arange(1, COSINES + 1) / n
    return frequency, np.sqrt(2 / n) * np.cos(frequency[:, None] * (np.arange(n) + 0.5))


def _upper_correlation(influence: RealArray) -> float:
    n, variance = influence.size, float(influence @ influence)
    rho = float(influence[1:] @ influence[:-1]) / variance if variance else 0.0
    unbiased = min(max(rho + (1 + 4 * rho) / n, 0.0), LARGEST_CORRELATION)
    return min(unbiased + CORRELATION_ERRORS * math.sqrt((1 - unbiased**2) / n), LARGEST_CORRELATION)


def _skewness_widening(influence: RealArray) -> float:
    """Relative widening of an interval by the skewness of the influences, for as many independent spans."""
    rho, scale = _upper_correlation(influence), float(np.std(influence))
    if scale == 0:
        return 0.0
    skewness = float(np.mean((influence - influence.mean()) ** 3)) / scale**3
    independent = influence.size * (1 - rho) / (1 + rho)
    return min(SKEWNESS_WIDENING * skewness**2 / independent, LARGEST_WIDENING)


def _extreme_interval(extremes: RealArray) -> ExtremeInterval:
    """Interval of the sum of the largest values of independent extremes, from those of the spans, (extremes, spans).

    The extreme of independent spans scatters like a Gumbel variate. Its scale is estimated; a Student factor with the
    degrees of freedom of the estimate (Welch 1947) allows for that. Correlated spans have a common level, which one
    record does not show in full: its variance replaces that of the mean of independent spans.
    """
    influence = extremes.sum(axis=0) - extremes.sum(axis=0).mean()
    contributions, n = cosine_contributions(influence), influence.size
    independent = influence @ influence / (n * (n - 1))
    shown = max(1 - contributions @ contributions / (n * independent), 0.5)
    variance, one_less = -independent, ~np.eye(n, dtype=np.bool_)
    for maxima in extremes:
        scale = float(extreme_scale(maxima[None, :], n)[0])
        others = np.log(extreme_scale(np.broadcast_to(maxima, (n, n))[one_less].reshape(n, n - 1), n))
        freedom = max(1 / (2 * (n - 1) * float(np.var(others))), FEWEST_DEGREES)
        widening = _student_quantile(freedom) / QUANTILE_95
        variance += (GUMBEL_HALF_WIDTH * scale * widening / _student_quantile(COSINES)) ** 2 / shown
    return ExtremeInterval(contributions, float(np.sqrt(max(variance, 0.0))), np.asarray)


def extreme_scale(maxima: RealArray, spans: int) -> RealArray:
    """Scale of the largest value of a record, by L-moments of a generalised extreme value distribution.

    Args:
        maxima: Largest values of the spans, (samples, n).
        spans: Spans of the record.

    Returns:
        Scale of each sample, (samples,).
    """
    ordered, n = np.sort(maxima, axis=1), maxima.shape[1]
    index = np.arange(n)
    b0 = ordered.mean(axis=1)
    b1 = (index / (n - 1) * ordered).mean(axis=1)
    b2 = (index * (index - 1) / ((n - 1) * (n - 2)) * ordered).mean(axis=1)
    second, third = 2 * b1 - b0, 6 * b2 - 6 * b1 + b0
    c = 2 / (3 + third / second) - np.log(2) / np.log(3)
    shape = 7.8590 * c + 2.9554 * c**2
    shape = np.where(np.abs(shape) < 1e-6, 1e-6, shape)
    scale = second * shape / ((1 - 2.0**-shape) * scipy.special.gamma(1 + shape))
    return np.asarray(scale * float(spans) ** -shape)


def _student_quantile(freedom: float) -> float:
    """Half-width of a 95 % interval of a Student variate."""
    return float(scipy.special.stdtrit(freedom, 0.975))


# Joint sample of the deviations of all quantities of a case.
Key = TypeVar("Key", bound=Hashable)


def draw_deviations(intervals: Mapping[Key, SpanInterval], count: int, digest: str) -> dict[Key, RealArray]:
    """Draw joint deviations of quantities.

    The deviations are those of a multivariate Student distribution. Its marginal distributions have the stated
    intervals, and its correlations are those of the slow fluctuations along the record.

    Args:
        intervals: Intervals of quantities over the same spans.
        count: Number of draws.
        digest: SHA-256 of the case or of the samples in hexadecimal, which is the seed of the random numbers.

    Returns:
        Changes of each value, (count,), in its unit.
    """
    random = np.random.default_rng(int(digest[:16], 16))
    shared = random.standard_normal((count, COSINES))
    widening = np.sqrt(COSINES / random.chisquare(COSINES, count))
    drawn = {}
    for key, interval in intervals.items():
        normal = shared @ interval.contributions + interval.scatter * random.standard_normal(count)
        drawn[key] = interval.change(widening * normal)
    return drawn

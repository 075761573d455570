"""Coverage of the intervals from the length of a record, on records of a process with known statistics.

python -m verification.tables.coverage [--records 2000]

Process. The contact force has 200 samples per second and one span per second. In span j it is

    110 N + 5 N g_j + exp(0.2 a_j) (25 N sin(2 pi t) + 6 N n1(t) + 16 N n2(t) + 12 N n3(t))

with Gaussian noise n1, n2, n3 of unit variance in 1-5 Hz, 5-20 Hz and 20-50 Hz. The contact height is
5.3 m + 3 mm g_j - 20 mm exp(0.2 a_j) sin(2 pi t), the largest uplift at a support 60 mm + 6 mm g_j + 4 mm times a
Gumbel variate. Level g and amplitude a are two Gaussian autoregressions of first order with unit variance and the
coefficient rho from span to span.

Rows. Every quantity, with 5, 8, 10, 15, 20, 30, 40 and 60 spans, and rho = 0, 0.3, 0.5 and 0.7. Rows are not pooled.

Seeds. Records come in batches of 250. The seed of batch b of the row (spans, rho) is (50318, spans, 100 rho, b), with
b = 0, 1, 2 ... The true values have the seeds (50318, 0, 100 rho, b). This rule was recorded before the first run, and no
other seed enters the table.

True values. A mean, a deviation or a share: the value of 60,000 spans. An extreme or a number of events: the mean value
of all records of the row.

Outcomes of a row, by the share of intervals that contain the true value and its 95 % confidence interval (Wilson):

    FAIL             the confidence interval excludes 95 %, or the share is outside of 93 % to 97 %
    shortfall width  the median half-width is more than 1.5 times the smallest one with correct coverage, which is the
                     95 % quantile of the distance between value and true value in the row
    95 %             none of these
    range            the product does not call the interval one of 95 %

A correct interval of 95 % gives FAIL in 5 % of the rows.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.signal import butter, lfilter, sosfilt

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals

RATE, SPAN_M = 200, 60.0
"""Samples per span and per second; span length [m], so that the speed is 60 m/s."""

SPANS, CORRELATIONS = (5, 8, 10, 15, 20, 30, 40, 60), (0.0, 0.3, 0.5, 0.7)

SEED, BATCH = 50318, 250

MARGIN = 1
"""Spans before and behind the analysis section, in which the filters settle."""

NOISE = (((1.0, 5.0), 6.0), ((5.0, 20.0), 16.0), ((20.0, 50.0), 12.0))
"""Bands of the noise [Hz] and its standard deviation [N]."""


class MadeRecord(NamedTuple):
    """Signals of one record of the process."""

    pantograph: PantographSignals
    line: LineSignals


def make_records(seed: tuple[int, ...], count: int, spans: int, rho: float) -> Iterator[MadeRecord]:
    """Records of the process.

    Args:
        seed: Seed of the batch.
        count: Number of records.
        spans: Spans of the analysis section.
        rho: Correlation of neighbouring spans [-].
    """
    random = np.random.default_rng(seed)
    total = spans + 2 * MARGIN
    level, amplitude = (_autoregression(random, count, total, rho) for _ in range(2))
    factor = np.repeat(np.exp(0.2 * amplitude), RATE, axis=1)
    step = np.repeat(level, RATE, axis=1)
    wave = np.tile(np.sin(2 * np.pi * np.arange(RATE) / RATE), total)
    force = 110 + 5 * step + factor * (25 * wave + _noise(random, count, total))
    height = 5.3 + 3e-3 * step - 20e-3 * factor * wave
    uplift = 1e-3 * (60 + 6 * level[:, MARGIN:] + random.gumbel(0, 4, (count, total - MARGIN)))
    position = SPAN_M * (np.arange(total * RATE) / RATE - MARGIN)
    section = (0.0, SPAN_M * spans)
    supports = SPAN_M * np.arange(spans + 1)
    for i in range(count):
        channel = ForceChannel(force[i], float(RATE), Filter())
        yield MadeRecord(
            PantographSignals(position, channel, section, height[i]),
            LineSignals(section, supports, uplift[i, : spans + 1, None], tuple(supports)),
        )


def _autoregression(random: np.random.Generator, count: int, size: int, rho: float) -> RealArray:
    """Stationary Gaussian autoregression of first order with unit variance, (count, size)."""
    shocks = np.sqrt(1 - rho**2) * random.standard_normal((count, size))
    shocks[:, 0] /= np.sqrt(1 - rho**2)
    return np.asarray(lfilter([1.0], [1.0, -rho], shocks, axis=1))


def _noise(random: np.random.Generator, count: int, spans: int) -> RealArray:
    """Sum of the noise in all bands, (count, samples) [N]."""
    settling = 2 * RATE
    total = np.zeros((count, spans * RATE))
    for band, deviation in NOISE:
        sections = butter(2, band, "bandpass", fs=RATE, output="sos")
        gain = np.sqrt(np.sum(sosfilt(sections, np.eye(1, 20 * RATE)[0]) ** 2))
        white = random.standard_normal((count, settling + spans * RATE))
        total += deviation / gain * sosfilt(sections, white, axis=1)[:, settling:]
    return total

"""Coverage of the intervals from the length of a record, on records of a process with known statistics.

python -m verification.tables.coverage [--records 2000]

Process. The contact force has 200 samples per second and one span per second. In span j it is

    110 N + 5 N g_j + exp(0.2 a_j) (25 N sin(2 pi t) + 6 N n1(t) + 16 N n2(t) + 12 N n3(t))

with Gaussian noise n1, n2, n3 of unit variance in 1-5 Hz, 5-20 Hz and 20-50 Hz. The contact height is
5.3 m + 3 mm g_j - 20 mm exp(0.2 a_j) sin(2 pi t), the largest uplift at a support 60 mm + 6 mm g_j + 4 mm times a
Gumbel variate. Level g and amplitude a are two Gaussian autoregressions of first order with unit variance and the
coefficient rho from span to span.

Rows. Every quantity, with 5, 8, 10, 15, 20, 30, 40, 60, 100 and 150 spans, and rho = 0, 0.3, 0.5 and 0.7. Rows are not
pooled. The run-in is no part of the rows: the component `start` states it.

Seeds. Records come in batches of 250. The seed of batch b of the row (spans, rho) is (50319, spans, 100 rho, b), with
b = 0, 1, 2 ... The true values have the seeds (50319, 0, 100 rho, b). This rule was recorded before the first run with
these seeds, and no other seed enters the table. Earlier settings of the intervals were measured with the seed 50318.

True values. A mean, a deviation or a share: the value of 60,000 spans. An extreme or a number of events: the mean value
of all records of the row.

Outcomes of a row are those of verification/tables/interval_share.py; the smallest width with correct coverage is the
95 % quantile of the distance between value and true value in the row. Further outcomes:

    no share         the product states no share for the interval (extremes)
    range            the product states a range of what was run
"""

import argparse
import itertools
import time
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.fft import irfft, next_fast_len
from scipy.signal import butter, lfilter, sosfreqz

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.evaluation import LINE, evaluate_signals
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.force_quantities import LINE_QUANTITIES, PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals
from pantocheck.conformance.records.length_uncertainty import (
    FEWEST_SPANS_INTERVAL,
    ExtremeInterval,
    LengthUncertainty,
    StatisticInterval,
    SubRecordRange,
    length_uncertainties,
    uplift_uncertainties,
)
from verification.tables.interval_share import SHARE_COLUMNS, IntervalShare

RATE, SPAN_M = 200, 60.0
"""Samples per span and per second; span length [m], so that the speed is 60 m/s."""

SPANS, CORRELATIONS = (150, 100, 60, 40, 30, 20, 15, 10, 8, 5), (0.0, 0.3, 0.5, 0.7)

SEED, BATCH = 50319, 250

RANGE_SHARE = 4
"""Records of a row of 95 % intervals over those of a row of ranges, which claim no share."""

MARGIN = 1
"""Spans before and behind the analysis section, in which the filters settle."""

NOISE = (((1.0, 5.0), 6.0), ((5.0, 20.0), 16.0), ((20.0, 50.0), 12.0))
"""Bands of the noise [Hz] and its standard deviation [N]."""


@dataclass(frozen=True)
class SharedSpectra(PantographSignals):
    """Signals that compute each band once."""

    parts: dict[tuple[float, float], RealArray] = field(default_factory=dict)
    """Force in each band ]low, high] Hz."""

    def band(self, low: float, high: float) -> float:
        """RMS of the force in a band [N], by Parseval equal to that of its part."""
        return float(np.sqrt(np.mean(self.band_part(low, high) ** 2)))

    def band_part(self, low: float, high: float) -> RealArray:
        """Contact force in a band [N]."""
        if (low, high) not in self.parts:
            self.parts[low, high] = super().band_part(low, high)
        return self.parts[low, high]


class MadeRecord(NamedTuple):
    """Signals of one record of the process."""

    pantograph: SharedSpectra
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
    level, amplitude = (draw_autoregression(random, count, total, rho) for _ in range(2))
    factor = np.repeat(np.exp(0.2 * amplitude), RATE, axis=1)
    step = np.repeat(level, RATE, axis=1)
    wave = np.tile(np.sin(2 * np.pi * np.arange(RATE) / RATE), total)
    force = 110 + 5 * step + factor * (25 * wave + _noise(random, count, total * RATE))
    height = 5.3 + 3e-3 * step - 20e-3 * factor * wave
    uplift = 1e-3 * (60 + 6 * level[:, MARGIN:] + random.gumbel(0, 4, (count, total - MARGIN)))
    position = SPAN_M * (np.arange(total * RATE) / RATE - MARGIN)
    section = (0.0, SPAN_M * spans)
    supports = SPAN_M * np.arange(spans + 1)
    uplift = np.stack([np.zeros_like(uplift), uplift], axis=-1)
    for i in range(count):
        channel = ForceChannel(force[i], float(RATE), Filter())
        yield MadeRecord(
            SharedSpectra(position, channel, section, height[i]),
            LineSignals(section, supports, uplift[i, : spans + 1], tuple(supports)),
        )


def draw_autoregression(random: np.random.Generator, count: int, size: int, rho: float) -> RealArray:
    """Stationary Gaussian autoregression of first order with unit variance, (count, size)."""
    shocks = np.sqrt(1 - rho**2) * random.standard_normal((count, size))
    shocks[:, 0] /= np.sqrt(1 - rho**2)
    return np.asarray(lfilter([1.0], [1.0, -rho], shocks, axis=1))


def _noise(random: np.random.Generator, count: int, samples: int) -> RealArray:
    """Sum of the noise in all bands, (count, samples) [N]: independent spectral lines with the density of the sum."""
    size = next_fast_len(samples + 2 * RATE, real=True)  # the ends of a longer series are not neighbours
    frequency = np.fft.rfftfreq(size, 1 / RATE)
    density = np.zeros(frequency.size)
    for band, deviation in NOISE:
        _, response = sosfreqz(butter(2, band, "bandpass", fs=RATE, output="sos"), frequency, fs=RATE)
        density += deviation**2 * np.abs(response) ** 2 / np.mean(np.abs(response) ** 2)
    lines = random.standard_normal((count, frequency.size, 2)).view(np.complex128)[..., 0]
    return np.asarray(irfft(lines * np.sqrt(size / 2 * density), size)[:, :samples])


HEADING = f"""\
| quantity | spans | correlation | {SHARE_COLUMNS} | outcome |
|---|--:|--:|--:|--:|---|--:|---|"""
"""Head of a table of rows in Markdown."""


class Row(NamedTuple):
    """Intervals of one quantity with one number of spans and one correlation."""

    quantity: str
    spans: int
    rho: float
    intervals: IntervalShare
    """Those of the kind."""
    kind: type[LengthUncertainty]
    """Kind of the intervals: of a statistic if a record has one, or of an extreme, or a range."""

    @property
    def text(self) -> str:
        """Row of a table in Markdown."""
        return f"| {self.quantity} | {self.spans} | {self.rho:g} | {self.intervals.text} | {self.outcome} |"

    @property
    def outcome(self) -> str:
        """Outcome by the rule of this module."""
        if self.kind is not StatisticInterval:
            return "no share" if self.kind is ExtremeInterval else "range"
        return self.intervals.outcome


def measure_rows(spans: int, rho: float, records: int) -> list[Row]:
    """Rows of all quantities for one number of spans and one correlation."""
    values: dict[str, list[float]] = {}
    uncertainties: dict[str, list[LengthUncertainty | None]] = {}
    if spans < FEWEST_SPANS_INTERVAL:
        records = records // RANGE_SHARE
    for batch in range(-(-records // BATCH)):
        for record in make_records((SEED, spans, round(100 * rho), batch), BATCH, spans, rho):
            found = length_uncertainties(record.pantograph, 1.0) | uplift_uncertainties(record.line)
            for name, value in _evaluate(record).items():
                values.setdefault(name, []).append(value)
                uncertainties.setdefault(name, []).append(found.get(name))
    limits = _long_values(rho)
    return [
        row
        for name, numbers in values.items()
        if (row := build_row(name, spans, rho, np.array(numbers), uncertainties[name], limits))
    ]


def _evaluate(record: MadeRecord) -> dict[str, float]:
    evaluation = evaluate_signals({1: record.pantograph}, record.line)
    return {name: float(value) for owner in (1, LINE) for name, value in evaluation.values[owner].items()}  # type: ignore[arg-type]


EXTREMES = {quantity.name for quantity in PANTOGRAPH_QUANTITIES if quantity.extreme} | {
    quantity.name for quantity in LINE_QUANTITIES
}

GROWING = EXTREMES | {"contact_loss_events"}
"""Quantities that grow with the length of a record: their true value is the mean value of all records of a row."""

LONG_RECORDS, LONG_SPANS = 20, 3000


@cache
def _long_values(rho: float) -> Mapping[str, float]:
    """Values of a long record."""
    found = [
        _evaluate(record)
        for batch in range(LONG_RECORDS)
        for record in make_records((SEED, 0, round(100 * rho), batch), 1, LONG_SPANS, rho)
    ]
    return {name: float(np.mean([values[name] for values in found])) for name in found[0]}


def build_row(
    name: str,
    spans: int,
    rho: float,
    values: RealArray,
    uncertainties: list[LengthUncertainty | None],
    limits: Mapping[str, float],
    returns: Mapping[str, float] | None = None,
) -> Row | None:
    """Row of one quantity.

    Args:
        name: Quantity.
        spans: Spans of a record.
        rho: Correlation of neighbouring spans [-].
        values: Values of the records, (n,).
        uncertainties: Their uncertainties.
        limits: True values of a mean, a deviation or a share, by quantity.
        returns: True values of an extreme or a number of events; default: the mean value of the records.

    Returns:
        Row; None if no record has an uncertainty.
    """
    found = {type(uncertainty) for uncertainty in uncertainties}
    kind = next((kind for kind in (StatisticInterval, ExtremeInterval, SubRecordRange) if kind in found), None)
    if kind is None:
        return None
    selected = [isinstance(uncertainty, kind) for uncertainty in uncertainties]
    widths = np.array([x.half_width for x in itertools.compress(uncertainties, selected) if x is not None])
    grown = {name: float(values.mean())} if returns is None else returns
    distance = np.abs(values - (grown if name in GROWING else limits)[name])
    contained = int(np.sum(distance[np.array(selected)] <= widths))
    ratio = float(np.median(widths) / np.quantile(distance, 0.95))
    return Row(name, spans, rho, IntervalShare(widths.size, contained, ratio), kind)


def print_rows(rows: Iterable[Row]) -> list[Row]:
    """Print a table of rows as they come, and return them."""
    print(HEADING)
    printed = []
    for row in rows:
        print(row.text, flush=True)
        printed.append(row)
    return printed


def list_worst(rows: Iterable[Row]) -> list[Row]:
    """Row of each quantity with the largest distance of its share from 95 %, among the intervals of 95 %."""
    worst: dict[str, Row] = {}
    for row in rows:
        if row.kind is StatisticInterval and abs(row.intervals.share - 95) >= abs(
            worst.get(row.quantity, row).intervals.share - 95
        ):
            worst[row.quantity] = row
    return list(worst.values())


def main() -> None:
    """Measure and print all rows, then the worst row of each quantity."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--records", type=int, default=2000, help="records of a row; default: %(default)s")
    records, begin = parser.parse_args().records, time.process_time()
    rows = print_rows(
        row for spans, rho in itertools.product(SPANS, CORRELATIONS) for row in measure_rows(spans, rho, records)
    )
    print()
    print_rows(list_worst(rows))
    claimed = [row.outcome for row in rows if row.kind is StatisticInterval]
    counts = ", ".join(f"{claimed.count(outcome)} {outcome}" for outcome in dict.fromkeys(claimed))
    print(f"\n{len(claimed)} rows of intervals of statistics: {counts}; {len(rows) - len(claimed)} other rows.")
    print(f"{time.process_time() - begin:.0f} s of process time.")


if __name__ == "__main__":
    main()

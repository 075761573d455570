"""Join of two clocks: ties between times of both, and pulses of the uplift that show the passages at a support.

A tie is an event with a time in both clocks. A straight line through the differences gives offset and drift.

When a pantograph passes a support, the uplift there is near its maximum, and the contact wire has a kink. The product
of both shows the passage more sharply than either (L: 5 m, v: speed, u: uplift above its median):

    b(t) = 2 u(t) - u(t - L/v) - u(t + L/v)        pulse(t) = sqrt(max(b, 0) max(u, 0))

In the simulated passages of the library the largest pulse lies within 1 m of the support. Others, from waves that
droppers reflect 10 to 20 m away, have up to 0.82 of its height. Therefore the pattern of all pulses is compared with
the passages of all pantographs at all supports of a source: the match is the geometric mean of the pulses at the
passages, over the largest pulses around them.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from pantocheck.conformance.core.array_types import RealArray

PULSE_LENGTH_M = 5.0
"""Distance L, and largest distance of a pulse from its passage [m]."""

NEIGHBOURHOOD_M = 150.0
"""Distance before the first and behind the last passage in which a pattern has no larger pulses [m]."""

SMALLEST_MATCH = 0.7
"""Smallest match of a passage; with two pantographs, a pattern that is one of them late has about 0.6."""

SMALLEST_PULSE = 5.0
"""Smallest kink of a pulse, in robust standard deviations of b; noise alone has 4.5 in a minute at 200 Hz."""

SIGNIFICANT = 3.0
"""Drift over its standard uncertainty from which it is corrected and named."""

FEWEST_FOR_DRIFT = 4
"""Smallest number of ties that show a drift."""

SMALLEST_STRENGTH = 0.75
"""Smallest strength of a second passage, over the first one: free oscillations of the line have up to 0.62."""

MOST_PASSAGES = 4
"""Largest number of passages that are named."""

MOST_SHIFTS = 1_000_000
"""Largest number of shifts that are compared."""

WEAKEST = 1e-3
"""Height of a pulse that is missing, over the largest one."""


@dataclass(frozen=True)
class Clock:
    """Clock of a source: time of the record = time + offset + drift (time - middle)."""

    offset: float
    """Time of the record less the time of the source, at the middle [s]."""
    uncertainty: float
    """Half-width of the 95 % interval of a time of the record [s]."""
    drift: float = 0.0
    """Drift of the record against the source [-]; 0 if it is not significant."""
    drift_uncertainty: float | None = None
    """Half-width of the 95 % interval of the drift [-]; None: not known."""
    middle: float = 0.0
    """Mean time of the ties in the source [s]."""

    def convert(self, time: RealArray) -> RealArray:
        """Times of the record that belong to times of the source, (n,) [s]."""
        return np.asarray(time + self.offset + self.drift * (time - self.middle))

    def shift_at(self, time: float) -> float:
        """Time of the record less a time of the source [s]."""
        return self.offset + self.drift * (time - self.middle)


def fit_clock(source: RealArray, record: RealArray, scatter: float, common: float = 0.0) -> Clock:
    """Fit a clock to ties by least squares.

    Args:
        source: Times of the ties in the source, (k,) [s].
        record: Times of the ties in the record, (k,) [s].
        scatter: Smallest standard deviation of a tie [s].
        common: Half-width of the 95 % interval of an error that all ties share [s].
    """
    shift, middle = record - source, float(source.mean())
    spread = float(((source - middle) ** 2).sum())
    drift, width = 0.0, None
    if source.size >= FEWEST_FOR_DRIFT and spread > 0:
        slope = float(((source - middle) * (shift - shift.mean())).sum() / spread)
        residual = shift - shift.mean() - slope * (source - middle)
        scatter = max(scatter, float(np.sqrt((residual**2).sum() / (source.size - 2))))
        width = 2 * scatter / float(np.sqrt(spread))
        drift = slope if abs(slope) > SIGNIFICANT * width / 2 else 0.0
    elif source.size > 1:
        scatter = max(scatter, float(shift.std(ddof=1)))
    reach = 0.0 if width is None else width * float(np.ptp(source)) / 2
    uncertainty = float(np.hypot(2 * scatter / np.sqrt(source.size), reach)) + common
    return Clock(float(shift.mean()), uncertainty, drift, width, middle)


@dataclass(frozen=True)
class Passages:
    """Uplift at supports in the time of a source, and the passages of the pantographs in the time of the record."""

    time: RealArray
    """Time of the source, increasing, (n,) [s]."""
    uplift: RealArray
    """Uplift at the supports, (s, n) [m]; NaN where it is missing."""
    moments: RealArray
    """Time of the record at which each pantograph passes each support, (s, p) [s]; NaN where it is not known."""
    speed: float
    """Speed of the train [m/s]."""

    @property
    def step(self) -> float:
        """Sampling interval [s]."""
        return float(np.median(np.diff(self.time)))

    @property
    def reach(self) -> float:
        """Largest time between a passage and a moment of its neighbourhood [s]."""
        return NEIGHBOURHOOD_M / self.speed + float(np.nanmax(self.moments) - np.nanmin(self.moments))

    @cached_property
    def even(self) -> RealArray:
        """Evenly spaced times of the source, (m,) [s]."""
        return np.asarray(self.time[0] + self.step * np.arange(int((self.time[-1] - self.time[0]) / self.step) + 1))

    @cached_property
    def pulses(self) -> RealArray:
        """Pulses at each support and even time, (s, m) [m]; 0 where no kink stands out from the noise."""
        lag, rows = PULSE_LENGTH_M / self.speed, np.zeros((len(self.uplift), self.even.size))
        for row, uplift in zip(rows, self.uplift, strict=True):
            known = np.isfinite(uplift)
            if known.sum() < 2:
                continue
            level = uplift[known] - np.median(uplift[known])
            middle, before, after = (np.interp(self.even + dt, self.time[known], level) for dt in (0.0, -lag, lag))
            kink = 2 * middle - before - after
            noise = 1.4826 * float(np.median(np.abs(kink - np.median(kink))))
            row[:] = np.where(kink > SMALLEST_PULSE * noise, np.sqrt(np.maximum(kink, 0) * np.maximum(middle, 0)), 0.0)
        return rows

    def compare_patterns(self) -> "PatternComparison":
        """Compare pulses and passages at every shift with which they overlap."""
        known = np.isfinite(self.moments)
        if not known.any() or self.even.size < 2:
            return PatternComparison(np.zeros(0), np.zeros(0), np.zeros(0), NEIGHBOURHOOD_M / self.speed)
        low, high = float(np.nanmin(self.moments)) - self.even[-1], float(np.nanmax(self.moments)) - self.even[0]
        shifts = np.linspace(low, high, int(min((high - low) / self.step, MOST_SHIFTS)) + 1)
        total = np.zeros((2, shifts.size))
        for row, moments in zip(self.pulses, self.moments, strict=True):
            around = scipy.ndimage.maximum_filter1d(row, 2 * round(self.reach / self.step) + 1, mode="constant")
            share = np.divide(row, around, out=np.zeros(row.size), where=around > 0)
            for moment in moments[np.isfinite(moments)]:
                heights = (share, row / max(float(row.max()), WEAKEST**2))
                found = [np.interp(moment - shifts, self.even, height, left=0.0, right=0.0) for height in heights]
                total += np.log(np.maximum(found, WEAKEST))
        match, strength = np.exp(total / known.sum())
        return PatternComparison(shifts, match, strength, NEIGHBOURHOOD_M / self.speed)

    def find_ties(self, shift: float) -> RealArray:
        """Time of the source of the largest pulse near each passage, (s, p) [s]; NaN without a pulse."""
        ties = np.full(self.moments.shape, np.nan)
        for place in np.argwhere(np.isfinite(self.moments)):
            row, expected = self.pulses[place[0]], self.moments[tuple(place)] - shift
            near = np.flatnonzero(np.abs(self.even - expected) <= PULSE_LENGTH_M / self.speed)
            if near.size and row[near].max() > 0:
                ties[tuple(place)] = self._refine(row, int(near[np.argmax(row[near])]))
        return ties

    def _refine(self, row: RealArray, index: int) -> float:
        """Time of the top of the parabola through a largest sample and its neighbours [s]."""
        if not 0 < index < row.size - 1:
            return float(self.even[index])
        before, top, after = row[index - 1 : index + 2]
        bend = 2 * top - before - after
        return float(self.even[index] + self.step * (0.0 if bend <= 0 else (after - before) / 2 / bend))


@dataclass(frozen=True)
class PatternComparison:
    """Match of pulses and passages by shift: the time of the record less the time of the source."""

    shifts: RealArray
    """Shifts in increasing order, (k,) [s]."""
    match: RealArray
    """Mean height of the pulses at the passages over the largest pulses around them, (k,)."""
    strength: RealArray
    """Mean height of these pulses over the largest pulses of the source, (k,)."""
    neighbourhood: float
    """Time in which another passage of a train is impossible [s]."""

    def find_best(self, low: float, high: float) -> tuple[float, float]:
        """Shift of the best match between two shifts [s], and this match; a match of 0 if there is none."""
        inside = np.flatnonzero((self.shifts >= low) & (self.shifts <= high))
        if not inside.size:
            return np.nan, 0.0
        best = int(inside[np.argmax(self.match[inside])])
        return float(self.shifts[best]), float(self.match[best])

    def list_passages(self, low: float, high: float) -> list[float]:
        """Shifts between two shifts at which the passages of a train match, the strongest first [s]."""
        inside = (self.shifts >= low) & (self.shifts <= high) & (self.match >= SMALLEST_MATCH)
        strength, found = np.where(inside, self.match * self.strength, 0.0), list[float]()
        smallest = SMALLEST_STRENGTH * strength.max(initial=0.0)
        while len(found) < MOST_PASSAGES and strength.max(initial=0.0) > smallest:
            found.append(float(self.shifts[np.argmax(strength)]))
            strength[np.abs(self.shifts - found[-1]) <= self.neighbourhood] = 0.0
        return found

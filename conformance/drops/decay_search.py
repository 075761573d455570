"""Search for the linear part of a decay.

The decay is linear from the time when the last dropper becomes taut until wind or traffic moves the line. Both times
are unknown. Decays are fitted to the first minute and then to longer and longer parts of the record. The residual of
each fit is compared with the noise in windows over the whole record; a disturbed window limits the linear part.

If the residual of this part exceeds the motion at rest, the decay begins later: decays are fitted to the last half,
quarter and eighth of the record. The first fit with a residual like the motion at rest is extended back, step by step,
as far as its residual allows.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import ComplexArray, IntegerArray, RealArray
from pantocheck.conformance.drops.decay_kernel import FrequencyBand, filter_full_overlap, low_pass_taps
from pantocheck.conformance.drops.model_order import select_poles
from pantocheck.conformance.drops.projection import build_block, solve_residues
from pantocheck.conformance.drops.start_poles import find_start_poles

SHORTEST_DECAY = 10.0
"""Shortest linear decay that gives damping ratios of a catenary [s]."""

FIRST_FIT = 60.0
"""Length of the first fit [s]."""

LONG_WINDOW, SHORT_WINDOW = 4.0, 1.0
"""Lengths of the windows of the residual for the end and for the start of the linear part [s]."""

EARLIEST_START = 1.0
"""Earliest start after the release [s]; earlier, the filter of the residual does not show disturbances."""

TEST_TRANSITION = 2.5
"""Transition band of the low-pass for the residual [Hz]."""

CALM = 4.0
"""Power of the residual over that of the motion at rest, up to which a part counts as linear decay [-]."""

NEAR_FIT = 30.0
"""Same ratio before a fitted part, up to which errors of its poles can be the cause [-]."""

LEAST_RESIDUAL = 3e-4
"""Residual over the RMS of the decay, which no record falls below: a rest without noise is not a measure [-]."""

LATE_SHARES = (1 / 2, 3 / 4, 7 / 8)
"""Shares of the record after which a late linear part is searched [-]."""


@dataclass(frozen=True)
class ResidualWindows:
    """Windows of a residual: first samples, mask of the disturbed ones, lengths [samples] without and with filter."""

    starts: IntegerArray
    disturbed: NDArray[np.bool_]
    window: int
    reach: int

    def first_after_calm(self, begin: int) -> int:
        """First sample of the first disturbance after a calm window; beyond the record if there is none.

        Disturbed windows before the first calm window belong to the start of the decay, not to its end. So do those
        that follow within a window: fast poles can hide a short part.
        """
        calm = np.flatnonzero(~self.disturbed & (self.starts >= begin))
        if not calm.size:
            return begin
        # One window in a hundred is disturbed by chance; a line vibrates for several windows after a disturbance.
        lasting = np.convolve(self.disturbed, np.ones(6), mode="full")[5:] >= 4
        later = np.flatnonzero(self.disturbed & lasting & (self.starts > self.starts[calm[0]]))
        # A window with a small part of a disturbance still counts as noise: a quarter of a window is left out.
        first = int(self.starts[later[0]]) - self.window // 4 if later.size else np.iinfo(np.int64).max
        return first if first >= begin + self.window else self.first_after_calm(begin + self.window)

    def stays_disturbed(self, sample: int) -> bool:
        """Whether most windows after a sample are disturbed, as by wind; the error of a fit decays instead."""
        after = self.disturbed[self.starts >= sample]
        return after.size >= 8 and bool(after.mean() > 0.5)


@dataclass(frozen=True)
class ResidualCourse:
    """Power of a residual over that of the motion at rest, in windows."""

    starts: IntegerArray
    """First sample of each window, (w,)."""
    window: int
    """Samples of a window."""
    ratio: RealArray
    """Ratio in each window at each channel, (w, c) [-]."""
    reference: str
    """Motion at rest, or its substitute in the record."""

    @property
    def middle(self) -> RealArray:
        """Median over the channels, (w,) [-]."""
        return np.asarray(np.median(self.ratio, axis=1))

    def level(self, begin: int, end: int) -> float:
        """Median over the windows in [begin, end), or in its first quarter if that is larger [-]."""
        inside = (self.starts >= begin) & (self.starts + self.window <= end)
        first = inside & (self.starts < begin + (end - begin) // 4)
        return max((float(np.median(self.middle[part])) for part in (inside, first) if part.any()), default=0.0)

    def first_near(self, begin: int, limit: float) -> int:
        """First window of an unbroken sequence before `begin` whose ratios stay below a limit [samples]."""
        beyond = np.flatnonzero((self.middle > limit) & (self.starts < begin))
        return int(self.starts[beyond[-1] + 1]) if beyond.size and beyond[-1] + 1 < self.starts.size else 0


@dataclass(frozen=True)
class DecaySearch:
    """Search in the filtered and decimated samples after a release, (n, c), at intervals `dt` [s], from `begin`."""

    samples: RealArray
    begin: int
    dt: float
    band: FrequencyBand
    rest: RealArray
    """Filtered and decimated samples at rest before the release, (r, c); may be none."""

    def find_late_begin(self) -> int | None:
        """Start of a later part whose residual is like the motion at rest; None if there is none."""
        total = self.samples.shape[0]
        for share in LATE_SHARES:
            late = replace(self, begin=self.begin + int(share * (total - self.begin)))
            if (total - late.begin) * self.dt < SHORTEST_DECAY:
                break
            if late.follow_coarse_fit().level(late.begin, total) <= CALM:
                return late._extend_back(self.begin)
        return None

    def _extend_back(self, earliest: int) -> int:
        """Earliest start of a fit whose residual remains like the motion at rest."""
        total, begin, limit = self.samples.shape[0], self.begin, NEAR_FIT
        for _ in range(8):
            near = replace(self, begin=begin).follow_coarse_fit().first_near(begin, limit)
            earlier = replace(self, begin=max(near, earliest))
            if (begin - earlier.begin) * self.dt < SHORT_WINDOW:
                break
            if earlier.follow_coarse_fit().level(earlier.begin, total) <= CALM:
                begin = earlier.begin
            elif limit == CALM:
                break
            else:
                limit = CALM
        return begin

    def follow_coarse_fit(self) -> ResidualCourse:
        """Residual of a fit of start poles from `begin` to the end of the record, which takes tenths of a second."""
        return self.follow_residual(self.samples.shape[0], self._find_coarse_poles())

    def _find_coarse_poles(self) -> ComplexArray:
        samples = self.samples[self.begin :]
        scaled = samples / np.maximum(samples.std(axis=0), np.finfo(float).tiny)
        return find_start_poles([scaled], 1 / self.dt, self.band.low, self.band.fitted + 0.5)

    def follow_residual(self, end: int, poles: ComplexArray) -> ResidualCourse:
        """Residual of the decays fitted to [begin, end) over the motion at rest, in windows over the whole record."""
        filter_length = _test_filter(self.dt, self.band).size
        window = min(int(LONG_WINDOW / self.dt), self.samples.shape[0] - filter_length)
        starts, level = _residual_levels(self._residual(end, poles), window, self.dt, self.band)
        reference = "the motion at rest" if self._has_rest else "that of the last half, because there is no rest"
        return ResidualCourse(starts, window, level / self._rest_level, reference)

    @property
    def _has_rest(self) -> bool:
        return bool((self.rest.shape[0] - _test_filter(self.dt, self.band).size) * self.dt >= SHORT_WINDOW)

    @cached_property
    def _rest_level(self) -> RealArray:
        """Mean square of the motion at rest; without a rest that of the residual in the last half, (c,)."""
        residual, window = self.rest, int(LONG_WINDOW / self.dt)
        if self._has_rest:
            window = min(window, self.rest.shape[0] - _test_filter(self.dt, self.band).size)
        else:
            late = replace(self, begin=self.samples.shape[0] // 2)
            residual = late._residual(self.samples.shape[0], late._find_coarse_poles())[late.begin :]
            window = min(window, residual.shape[0] - _test_filter(self.dt, self.band).size)
        level = np.median(_residual_levels(residual, window, self.dt, self.band)[1], axis=0)
        least = LEAST_RESIDUAL * self.samples.std(axis=0)
        return np.asarray(np.maximum(level, least**2 + np.finfo(float).tiny))

    def find_linear_part(self) -> tuple[int, int, ComplexArray]:
        """Find the start and the end of the linear part [samples], and the poles of the last fit, (m,) [1/s].

        The fitted part becomes longer until a disturbance or the end of the record.

        The fit of a short part may have a large residual later, because it did not separate close modes. An end
        therefore counts only if a fit that includes it also has a large residual there.
        """
        total, least = self.samples.shape[0], int(SHORTEST_DECAY / self.dt)
        begin, end, limit = self.begin, min(total, self.begin + int(FIRST_FIT / self.dt)), total
        for _ in range(8):
            poles = self._fit_poles(end)
            tested = self._test_windows(end, poles, LONG_WINDOW)
            late = tested.first_after_calm(begin)
            if late < end - tested.reach and late < limit:
                limit = end = max(late, begin + least)
                continue
            # A large residual far behind the end of the fit is a disturbance; a near one is a mode missing in the fit.
            if end + (end - begin) // 4 < late < limit and tested.stays_disturbed(late):
                return self._find_start(end, poles), late, poles
            further = min(limit, max(late, begin + (end - begin) * 3 // 2)) if late < limit else limit
            if late >= limit or further <= end:
                return self._find_start(end, poles), limit if late >= limit else end, poles
            end = further
        return self._find_start(end, poles), end, poles

    def _fit_poles(self, end: int) -> ComplexArray:
        samples = self.samples[self.begin : end]
        scaled = samples / samples.std(axis=0)
        poles = find_start_poles([scaled], 1 / self.dt, self.band.low, self.band.fitted + 0.5)
        return select_poles(poles, [build_block(samples, self.dt, self.band.low, self.band.fitted)], rounds=4).poles

    def _test_windows(self, end: int, poles: ComplexArray, width: float) -> ResidualWindows:
        """Compare the residual of a fit with its median, in windows of a width [s]."""
        window = int(width / self.dt)
        starts, level = _residual_levels(self._residual(end, poles), window, self.dt, self.band)
        reach = window + _test_filter(self.dt, self.band).size
        inside = (starts >= self.begin) & (starts + reach < end)
        floor = np.maximum(np.median(level[inside], axis=0), np.finfo(float).tiny)
        return ResidualWindows(starts, _exceeds_noise(level / floor, width, self.band), window, reach)

    def _residual(self, end: int, poles: ComplexArray) -> RealArray:
        """Samples minus the decays fitted to [begin, end); drift and content outside the band remain."""
        block = build_block(self.samples[self.begin : end], self.dt, self.band.low, self.band.fitted)
        residues = solve_residues(poles, block).residues
        t = (np.arange(self.samples.shape[0]) - self.begin) * self.dt
        # Poles beyond the band represent leakage, not decays; fast decays are not extrapolated back to the release.
        real = (poles.imag < 2 * np.pi * self.band.fitted) & (-poles.real * self.begin * self.dt < 5)
        return np.asarray(self.samples - 2 * (np.exp(np.outer(t, poles[real])) @ residues[real]).real)

    def _find_start(self, end: int, poles: ComplexArray) -> int:
        tested = self._test_windows(end, poles, SHORT_WINDOW)
        earliest = int(EARLIEST_START / self.dt)
        # Up to the first calm second or more; a single disturbed window after it is due to chance.
        calm = np.convolve(~tested.disturbed, np.ones(5), mode="full")[4:] == 5
        early = tested.disturbed & (tested.starts < self.begin + 0.25 * (end - self.begin))
        early &= np.cumsum(calm & (tested.starts >= earliest)) == 0
        if not early.any():
            return earliest
        # The last disturbed window contains the disturbance in its first samples, and its filter in the middle.
        reach = tested.window // 4 + 1 + _test_filter(self.dt, self.band).size // 2
        return min(max(int(tested.starts[early][-1]) + reach, earliest), end - 1)


def _residual_levels(
    residual: RealArray, window: int, dt: float, band: FrequencyBand
) -> tuple[IntegerArray, RealArray]:
    """First samples of overlapping windows, (w,), and mean squares of the filtered residual in them, (w, c).

    The linear trend of each window is removed.
    """
    inner = filter_full_overlap(residual, _test_filter(dt, band))
    starts = np.arange(0, inner.shape[0] - window + 1, max(window // 4, 1))
    t = np.linspace(-1, 1, window)
    line = np.column_stack([np.ones(window), t])
    trend = line @ np.linalg.pinv(line)
    views = np.lib.stride_tricks.sliding_window_view(inner, window, axis=0)[starts]
    return starts, np.asarray(np.mean((views - views @ trend) ** 2, axis=2))


def _exceeds_noise(ratio: RealArray, width: float, band: FrequencyBand) -> NDArray[np.bool_]:
    """Windows whose residual exceeds the noise, on average over the channels or in one channel."""
    freedom = 2 * width * (band.high - band.low)
    # Weak modes without a pole, and gusts, increase the residual by some ten percent; a disturbance doubles it.
    together = ratio.mean(axis=1) > 1 + max(6 * np.sqrt(2 / (freedom * ratio.shape[1])), 1.0)
    alone = ratio.max(axis=1) > 1 + max(9 * np.sqrt(2 / freedom), 2.0)
    return np.asarray(together | alone)


def _test_filter(dt: float, band: FrequencyBand) -> RealArray:
    """Short low-pass for the residual, so that a disturbance is located in time."""
    passes = max(band.fitted - TEST_TRANSITION, 0.5 * band.fitted)
    return low_pass_taps(1 / dt, passes, band.fitted, 70.0)

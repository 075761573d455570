"""The stretch of a record in which it is a free linear decay.

It starts after the last slackening of a dropper and ends where something else moves the line; neither instant is known.
Both are found from the residual of a fit: a first fit over a safe minute, then, window by window in both directions,
whether what the fit leaves is still noise.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import ComplexArray, IntegerArray, RealArray
from pantocheck.conformance.identification.decay_filters import complete_overlap, low_pass_decay
from pantocheck.conformance.identification.model_order import select_poles
from pantocheck.conformance.identification.projection import build_block, solve_residues
from pantocheck.conformance.identification.release import Release
from pantocheck.conformance.identification.start_poles import find_start_poles
from pantocheck.conformance.input_files.input_error import InputError

GUARD = 2.0  # droppers are taut again this long after the release, as a first guess [s]
FIRST_FIT = 60.0  # length of the first fit [s]
SHORTEST = 10.0  # below this no damping of a catenary can be had [s]
LONG_WINDOW, SHORT_WINDOW = 4.0, 1.0  # for the end and the start [s]
EARLIEST = 1.0  # after the release, whatever the residual says: its test sees little before its own length [s]
TEST_TRANSITION = 2.5  # of the filter in front of that test [Hz]


@dataclass(frozen=True)
class FrequencyBand:
    """What is identified, and what it takes.

    Parameters
    ----------
    low, high : float
        Modes between these are reported [Hz].
    fitted : float
        The fit goes up to here, so that the edge disturbs no reported mode [Hz].
    stop : float
        Nothing is left above this [Hz].
    """

    low: float = 0.3
    high: float = 10.0
    fitted: float = 11.0
    stop: float = 14.0

    @classmethod
    def up_to(cls, high: float, rate: float, low: float = 0.3) -> "FrequencyBand":
        """Band for a wanted upper frequency [Hz], lowered if the sampling rate [Hz] demands it."""
        stop = min(high + 4.0, 0.45 * rate)
        fitted = min(high + 1.0, 0.78 * stop)
        return cls(low, min(high, 0.92 * fitted), fitted, stop)


@dataclass(frozen=True)
class LinearDecay:
    """Free decay of one record, low-passed and decimated; every decay in it keeps its pole.

    Parameters
    ----------
    samples : ndarray
        (n, c).
    dt : float
        Sampling interval [s].
    taps : ndarray
        The low-pass at the original rate.
    rate : float
        Original samples per second [Hz].
    start, end : float
        Of the samples used, in the record's time [s].
    first : float
        Time to which the first sample belongs, in the record's time [s].
    poles : complex ndarray
        What the search already found [1/s].
    warnings : tuple[str, ...]
        Why the stretch is shorter than the record.
    """

    samples: RealArray
    dt: float
    taps: RealArray
    rate: float
    start: float
    end: float
    first: float
    poles: ComplexArray = field(default_factory=lambda: np.zeros(0, dtype=np.complex128))
    warnings: tuple[str, ...] = ()

    @property
    def duration(self) -> float:
        """[s]"""
        return float(self.samples.shape[0] * self.dt)


def find_linear_decay(
    signals: RealArray,
    rate: float,
    release: Release,
    band: FrequencyBand,
    name: str,
    channels: tuple[str, ...],
    clipped_until: float = 0.0,
) -> LinearDecay:
    """The longest stretch after the release that a sum of decays explains down to the noise.

    Parameters
    ----------
    signals : ndarray
        (n, c).
    rate : float
        Samples per second [Hz].
    release : Release
        When the mass was released.
    band : FrequencyBand
        What is identified.
    name : str
        Of the record, for messages.
    channels : tuple[str, ...]
        (c,) names, for messages.
    clipped_until : float
        Last clipped sample [s].

    Raises
    ------
    InputError
        Less than `SHORTEST` is left, or a channel is dead there.
    """
    begin = int(release.time * rate)
    taps = low_pass_decay(rate, band.fitted, band.stop, 80.0)
    step = max(1, int(rate / (2.6 * band.stop)))
    available = (signals.shape[0] - begin) / rate
    if available - GUARD < SHORTEST:
        raise InputError(
            name,
            f"only {max(available, 0):.1f} s after the release",
            f"At least {SHORTEST + GUARD:g} s are needed, and minutes for a damping ratio: record 120 to 240 s.",
        )
    samples = complete_overlap(signals[begin:], taps)[::step]
    dt = step / rate
    total = samples.shape[0]
    guard = max(int(GUARD / dt), int(np.ceil((clipped_until - release.time) / dt)) + 1)
    if (total - guard) * dt < SHORTEST - taps.size / rate:
        raise InputError(name, "is clipped or disturbed almost to its end", "Repeat the drop with a larger range.")
    dead = np.flatnonzero(np.ptp(signals[begin + guard * step :], axis=0) == 0)
    if dead.size:
        raise InputError(
            f"{name}, channel '{channels[dead[0]]}'",
            "never changes after the release",
            "The sensor was lost: leave this channel out of the sidecar.",
        )
    start, end, poles = _search(samples, guard, dt, band)
    if clipped_until > release.time:
        start = max(start, guard)
    warnings = []
    if end < total:
        warnings.append(f"{name}: used up to {end * dt:.0f} s after the release; no free decay explains what follows")
    if (end - start) * dt < SHORTEST - taps.size / rate:
        raise InputError(
            name,
            f"is a free decay for only {(end - start) * dt:.1f} s",
            "Repeat the drop in calm weather and away from traffic.",
        )
    if start * dt > GUARD + 1.0:
        warnings.append(f"{name}: not a linear decay before {start * dt:.1f} s after the release")
    half_filter = (taps.size - 1) / 2 / rate
    return LinearDecay(
        samples=samples[start:end],
        dt=dt,
        taps=taps,
        rate=rate,
        start=begin / rate + start * dt,
        end=begin / rate + end * dt + 2 * half_filter,
        first=begin / rate + start * dt + half_filter,
        poles=poles,
        warnings=tuple(warnings),
    )


def _search(samples: RealArray, guard: int, dt: float, band: FrequencyBand) -> tuple[int, int, ComplexArray]:
    """First sample, end, and poles of the linear stretch.

    Fits over ever longer stretches are each tested over the whole record. A fit over a short stretch may fail further
    on because it could not tell close modes apart; so an end counts only if a fit that spans it fails there too.
    """
    total, least = samples.shape[0], int(SHORTEST / dt)
    begin, end, limit = guard, min(total, guard + int(FIRST_FIT / dt)), total
    for _ in range(8):
        poles = _poles(samples[begin:end], dt, band)
        tested = _tested(samples, begin, end, poles, dt, band)
        late = tested.first_after_calm(begin)
        if late < end - tested.reach and late < limit:
            limit = end = max(late, begin + least)
            continue
        # A fit that foresaw the decay for long is right about its end; one that fails at once missed close modes.
        if end + (end - begin) // 4 < late < limit and tested.stays_disturbed(late):
            return _first_sample(samples, begin, end, poles, dt, band), late, poles
        further = min(limit, max(late, begin + (end - begin) * 3 // 2)) if late < limit else limit
        if late >= limit or further <= end:
            return _first_sample(samples, begin, end, poles, dt, band), limit if late >= limit else end, poles
        end = further
    return _first_sample(samples, begin, end, poles, dt, band), end, poles


@dataclass(frozen=True)
class _Tested:
    """Windows over the whole record and which of them hold more than the fit and noise."""

    starts: IntegerArray
    disturbed: NDArray[np.bool_]
    window: int
    reach: int  # samples that a window sees, its filter included

    def first_after_calm(self, begin: int) -> int:
        """First sample of the first disturbed window that follows calm ones; beyond the record if there is none.

        Disturbed windows at the very beginning are the start's concern: what decays away is no disturbance of the end.
        """
        calm = np.flatnonzero(~self.disturbed & (self.starts >= begin))
        if not calm.size:
            return begin
        # One window in a hundred is loud by chance; what moves a line rings on for several.
        lasting = np.convolve(self.disturbed, np.ones(6), mode="full")[5:] >= 4
        later = np.flatnonzero(self.disturbed & lasting & (self.starts > self.starts[calm[0]]))
        # The first windows that hold a little of a disturbance still look like noise: a quarter of one is given up.
        return int(self.starts[later[0]]) - self.window // 4 if later.size else np.iinfo(np.int64).max

    def stays_disturbed(self, late: int) -> bool:
        """Whether most windows from a sample on are disturbed: what a fit fails to foresee decays, wind goes on."""
        after = self.disturbed[self.starts >= late]
        return after.size >= 8 and bool(after.mean() > 0.5)


def _tested(
    samples: RealArray,
    begin: int,
    end: int,
    poles: ComplexArray,
    dt: float,
    band: FrequencyBand,
    width: float = LONG_WINDOW,
) -> _Tested:
    window = int(width / dt)
    starts, level = residual_levels(_left(samples, begin, end, poles, dt, band), window, dt, band)
    reach = window + _test_filter(dt, band).size
    inside = (starts >= begin) & (starts + reach < end)
    floor = np.maximum(np.median(level[inside], axis=0), np.finfo(float).tiny)
    return _Tested(starts, _disturbed(level / floor, width, band), window, reach)


def _first_sample(samples: RealArray, begin: int, end: int, poles: ComplexArray, dt: float, band: FrequencyBand) -> int:
    tested = _tested(samples, begin, end, poles, dt, band, SHORT_WINDOW)
    # Up to the first second and more of calm: a single loud window later on is chance.
    calm = np.convolve(~tested.disturbed, np.ones(5), mode="full")[4:] == 5
    early = tested.disturbed & (tested.starts < begin + 0.25 * (end - begin))
    early &= np.cumsum(calm & (tested.starts >= int(EARLIEST / dt))) == 0
    earliest = int(EARLIEST / dt)
    if not early.any():
        return earliest
    # Going back in time, what first disturbs a window is its first sample; the test's filter weighs its middle most.
    reach = tested.window // 4 + 1 + _test_filter(dt, band).size // 2
    return min(max(int(tested.starts[early][-1]) + reach, earliest), end - 1)


def _poles(samples: RealArray, dt: float, band: FrequencyBand) -> ComplexArray:
    spread = samples.std(axis=0)
    poles = find_start_poles([samples / spread], 1 / dt, band.low, band.fitted + 0.5)
    return select_poles(poles, [build_block(samples, dt, band.low, band.fitted)], rounds=4).poles


def _left(samples: RealArray, start: int, end: int, poles: ComplexArray, dt: float, band: FrequencyBand) -> RealArray:
    """What the decays fitted over [start, end) leave of all samples; drift and what lies outside the band stay in."""
    residues = solve_residues(poles, build_block(samples[start:end], dt, band.low, band.fitted)).residues
    t = (np.arange(samples.shape[0]) - start) * dt
    # Poles beyond the band stand for what leaks in from there; as decays they mean nothing.
    # Nor does a fast decay carried back over many of its own time constants.
    real = (poles.imag < 2 * np.pi * band.fitted) & (-poles.real * start * dt < 5)
    return np.asarray(samples - 2 * (np.exp(np.outer(t, poles[real])) @ residues[real]).real)


def residual_levels(residual: RealArray, window: int, dt: float, band: FrequencyBand) -> tuple[IntegerArray, RealArray]:
    """Mean square below the band's upper end in overlapping windows, a trend in each taken off.

    Parameters
    ----------
    residual : ndarray
        (n, c).
    window : int
        Samples of a window.
    dt : float
        Sampling interval [s].
    band : FrequencyBand
        What is identified.

    Returns
    -------
    tuple[ndarray, ndarray]
        First sample of every window, (w,), and its levels, (w, c).
    """
    inner = complete_overlap(residual, _test_filter(dt, band))
    starts = np.arange(0, inner.shape[0] - window + 1, max(window // 4, 1))
    t = np.linspace(-1, 1, window)
    line = np.column_stack([np.ones(window), t])
    straight = line @ np.linalg.pinv(line)
    views = np.lib.stride_tricks.sliding_window_view(inner, window, axis=0)[starts]
    return starts, np.asarray(np.mean((views - views @ straight) ** 2, axis=2))


def _disturbed(ratio: RealArray, width: float, band: FrequencyBand) -> NDArray[np.bool_]:
    """Windows that hold more than noise: all channels together, or one alone."""
    freedom = 2 * width * (band.high - band.low)
    # Weak modes nobody fitted and gusts make the noise of a line breathe by some ten percent; a disturbance doubles it.
    together = ratio.mean(axis=1) > 1 + max(6 * np.sqrt(2 / (freedom * ratio.shape[1])), 1.0)
    alone = ratio.max(axis=1) > 1 + max(9 * np.sqrt(2 / freedom), 2.0)
    return np.asarray(together | alone)


def _test_filter(dt: float, band: FrequencyBand) -> RealArray:
    """What lies above the band is no part of the test of the residual; short, so that it sees where a change is."""
    passes = max(band.fitted - TEST_TRANSITION, 0.5 * band.fitted)
    return low_pass_decay(1 / dt, passes, band.fitted, 70.0)

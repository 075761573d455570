"""Frequency band of an identification, and filters of finite length, which do not change the pole of a decay."""

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import scipy.signal

from pantocheck.conformance.array_types import ComplexArray, RealArray

SampledArray = TypeVar("SampledArray", RealArray, ComplexArray)


LOWEST_FREQUENCY = 0.3
"""Lower edge of the band of the reported modes [Hz]."""


@dataclass(frozen=True)
class FrequencyBand:
    """Band of the reported modes, with margins above it for fit and filters."""

    low: float
    high: float
    """Edges of the band of the reported modes [Hz]."""
    fitted: float
    """Upper edge of the fit [Hz]; its distance from `high` keeps errors at the edge away from the reported modes."""
    stop: float
    """Lower edge of the stop band of the low-pass [Hz]."""

    @classmethod
    def up_to(cls, high: float, rate: float) -> "FrequencyBand":
        """Band up to a frequency [Hz], or up to a lower one if the sampling rate [Hz] is too low."""
        stop = min(high + 4.0, 0.45 * rate)
        fitted = min(high + 1.0, 0.78 * stop)
        return cls(LOWEST_FREQUENCY, min(high, 0.92 * fitted), fitted, stop)


def low_pass_decay(rate: float, passes: float, stops: float, attenuation: float) -> RealArray:
    """Taps of a linear-phase low-pass (Kaiser window).

    Args:
        rate: Sampling rate [Hz].
        passes, stops: Edges of the transition band [Hz].
        attenuation: Attenuation of the stop band [dB].

    Returns:
        Taps, (t,); t is odd.
    """
    length, beta = scipy.signal.kaiserord(attenuation, (stops - passes) / (rate / 2))
    taps = scipy.signal.firwin(length | 1, (passes + stops) / 2, window=("kaiser", beta), fs=rate)
    return np.asarray(taps, dtype=np.float64)


def complete_overlap(samples: SampledArray, taps: RealArray) -> SampledArray:
    """Filtered samples at full overlap with the filter, (n - t + 1, c), in which each decay has its exact pole."""
    return np.asarray(scipy.signal.oaconvolve(samples, taps[:, None], mode="valid", axes=0))


def filter_gain(taps: RealArray, poles: ComplexArray, rate: float) -> ComplexArray:
    """Complex gain of the filter for a decay at each pole, (m,).

    The delay of the filter is removed: the first filtered sample belongs to the time of the middle tap.
    """
    offsets = (np.arange(taps.size) - (taps.size - 1) / 2) / rate
    return np.asarray(np.exp(-np.outer(poles, offsets)) @ taps)

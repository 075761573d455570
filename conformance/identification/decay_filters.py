"""Frequency band of an identification, and finite filters: a filtered decay keeps its pole."""

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
    """Band of the reported modes, and the margins that fit and filters need above it.

    Parameters
    ----------
    low, high : float
        Edges of the band of the reported modes [Hz].
    fitted : float
        Upper edge of the fit [Hz]; the margin keeps the effects of the edge away from the reported modes.
    stop : float
        Lower edge of the stop band of the low-pass [Hz].
    """

    low: float
    high: float
    fitted: float
    stop: float

    @classmethod
    def up_to(cls, high: float, rate: float) -> "FrequencyBand":
        """Band up to a frequency [Hz], or to a lower one if the sampling rate [Hz] requires it."""
        stop = min(high + 4.0, 0.45 * rate)
        fitted = min(high + 1.0, 0.78 * stop)
        return cls(LOWEST_FREQUENCY, min(high, 0.92 * fitted), fitted, stop)


def low_pass_decay(rate: float, passes: float, stops: float, attenuation: float) -> RealArray:
    """Taps of a linear-phase low-pass (Kaiser window).

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].
    passes, stops : float
        Edges of the transition band [Hz].
    attenuation : float
        Attenuation of the stop band [dB].
    """
    length, beta = scipy.signal.kaiserord(attenuation, (stops - passes) / (rate / 2))
    taps = scipy.signal.firwin(length | 1, (passes + stops) / 2, window=("kaiser", beta), fs=rate)
    return np.asarray(taps, dtype=np.float64)


def complete_overlap(samples: SampledArray, taps: RealArray) -> SampledArray:
    """Filtered samples of complete overlaps only, (n - taps + 1, c): each decay keeps its pole exactly."""
    return np.asarray(scipy.signal.oaconvolve(samples, taps[:, None], mode="valid", axes=0))


def filter_gain(taps: RealArray, poles: ComplexArray, rate: float) -> ComplexArray:
    """Factor by which the filter, its delay removed, multiplies the amplitude of a decay at each pole, (m,).

    The first filtered sample is assigned to the time of the middle tap.
    """
    offsets = (np.arange(taps.size) - (taps.size - 1) / 2) / rate
    return np.asarray(np.exp(-np.outer(poles, offsets)) @ taps)

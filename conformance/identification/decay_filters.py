"""Finite filters: a filtered decay keeps its pole."""

from typing import TypeVar

import numpy as np
import scipy.signal

from pantocheck.conformance.array_types import ComplexArray, RealArray

SampledArray = TypeVar("SampledArray", RealArray, ComplexArray)


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

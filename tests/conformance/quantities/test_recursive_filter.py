"""Filters against those of scipy.signal, which are computed in another way."""

import numpy as np
import pytest
import scipy.signal

from pantocheck.conformance.quantities.filters import (
    design_band_pass,
    design_low_pass,
    filter_both_ways,
    filter_forwards,
    frequency_response,
)

CASES = [
    *[(1, 0.0, 20.0, 100.0), (3, 0.0, 20.0, 500.0), (3, 0.0, 20.0, 1e5), (6, 0.0, 50.0, 126.0), (12, 0.0, 5.0, 2000.0)],
    *[(1, 1.0, 20.0, 500.0), (2, 5.0, 20.0, 200.0), (3, 0.5, 50.0, 1000.0), (6, 20.0, 50.0, 500.0)],
]
"""Order, lower edge [Hz], upper edge [Hz], sampling rate [Hz]."""


@pytest.mark.parametrize(("order", "low", "high", "rate"), CASES)
def test_filters_are_those_of_scipy(order: int, low: float, high: float, rate: float) -> None:
    if low:
        sections = design_band_pass(order, (low, high), rate)
        other = scipy.signal.butter(order, (low, high), "bandpass", fs=rate, output="sos")
    else:
        sections = design_low_pass(order, high, rate)
        other = scipy.signal.butter(order, high, fs=rate, output="sos")
    frequency = np.linspace(0.0, rate / 2, 200)
    response = scipy.signal.sosfreqz(other, frequency, fs=rate)[1]
    assert frequency_response(sections, frequency, rate) == pytest.approx(response, abs=1e-11)
    signal = 120 + np.cumsum(np.random.default_rng(1).standard_normal(3000))
    forwards, _ = scipy.signal.sosfilt(other, signal, zi=scipy.signal.sosfilt_zi(other) * signal[0])
    # The gain at zero frequency, 1 + a1 + a2 and the like, loses as many digits as the square of rate over edge has.
    rounding = 1e-9 + 1e-15 * np.abs(signal).max() * (rate / (low or high)) ** 2
    assert filter_forwards(sections, signal) == pytest.approx(forwards, abs=rounding)
    for padding in (0, 700, signal.size - 1):
        both = scipy.signal.sosfiltfilt(other, signal, padlen=padding)
        assert filter_both_ways(sections, signal, padding) == pytest.approx(both, abs=rounding)


def test_short_signals_are_filtered() -> None:
    sections = design_low_pass(4, 20.0, 500.0)
    for size in (1, 2, 3):
        assert filter_forwards(sections, np.full(size, 7.0)) == pytest.approx(np.full(size, 7.0))

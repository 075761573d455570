"""Band of an identification, and finite filters that keep the poles of a decay."""

import numpy as np
import pytest
import scipy.signal

from pantocheck.conformance.drops.decay_kernel import FrequencyBand, complete_overlap, filter_gain, low_pass_decay


@pytest.mark.parametrize(
    ("high", "rate", "expected"),
    [
        (6.0, 200.0, (0.3, 6.0, 7.0, 10.0)),  # 1 Hz of margin for the fit, 4 Hz for the low-pass
        (10.0, 20.0, (0.3, 6.4584, 7.02, 9.0)),  # 0.45 times the rate; 78 % of that; 92 % of that
        (2.0, 12.0, (0.3, 2.0, 3.0, 5.4)),
        (0.5, 1.5, (0.3, 0.48438, 0.5265, 0.675)),
    ],
)
def test_band_keeps_its_margins(high: float, rate: float, expected: tuple[float, ...]) -> None:
    band = FrequencyBand.up_to(high, rate)
    assert (band.low, band.high, band.fitted, band.stop) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("attenuation", [40.0, 60.0, 80.0])
def test_low_pass_has_its_attenuation(attenuation: float) -> None:
    """A Kaiser window has ripples of the attenuation in both bands; the estimate of its length misses it by 2 dB."""
    taps = low_pass_decay(100.0, 5.0, 8.0, attenuation)
    frequency, response = scipy.signal.freqz(taps, fs=100.0, worN=4096)
    ripple = 10 ** (-(attenuation - 2) / 20)
    assert np.abs(np.abs(response[frequency <= 5.0]) - 1).max() < ripple
    assert np.abs(response[frequency >= 8.0]).max() < ripple
    assert np.abs(response[frequency >= 8.0]).max() > 10 ** (-(attenuation + 6) / 20)
    assert taps.size % 2 == 1


def test_filter_gain_is_that_of_a_filtered_decay() -> None:
    """Exact: a decay is an eigenfunction of a finite filter. The middle tap gives the time of a filtered sample."""
    rate, poles = 50.0, np.array([-0.3 + 12.0j, -1.5 + 31.0j])
    taps = low_pass_decay(rate, 4.0, 7.0, 60.0)
    decay = np.exp(np.outer(np.arange(200) / rate, poles))
    filtered = complete_overlap(decay, taps)
    assert filtered.shape[0] == 200 - taps.size + 1
    expected = filter_gain(taps, poles, rate) * decay[taps.size // 2 :][: filtered.shape[0]]
    assert filtered == pytest.approx(expected, abs=1e-12)

"""Bands partition the variance: Parseval holds, sines fall into their band, unknown bands are rejected."""

from contextlib import nullcontext

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from pantocheck.conformance.quantities.bands import BANDS, amplitude_spectrum, band_rms
from pantocheck.conformance.quantities.filters import CUTOFF_TOLERANCE, Filter
from pantocheck.conformance.quantities.unavailable import AlreadyFiltered, BandNotObservable

RATE = 500.0


def noise(seed: int, n: int = 2000) -> np.ndarray:
    return 120 + 30 * np.random.default_rng(seed).normal(size=n)


@settings(max_examples=30)
@given(seed=st.integers(0, 2**32 - 1), n=st.integers(1000, 1999), edge=st.floats(2.0, 190.0))
def test_two_bands_add_up_to_their_union(seed: int, n: int, edge: float) -> None:
    force = noise(seed, n)
    parts = [band_rms(force, RATE, low, high) for low, high in ((0, edge), (edge, 200))]
    assert_allclose(np.hypot(*parts), band_rms(force, RATE, 0, 200), rtol=1e-12)


@pytest.mark.parametrize("n", [2000, 2001])
def test_all_bands_add_up_to_the_variance(n: int) -> None:
    """The force has no content above 0.4 of the rate, where the highest band ends."""
    spectrum = np.fft.rfft(noise(3, n))
    spectrum[np.fft.rfftfreq(n, 1 / RATE) > 200] = 0
    force = np.fft.irfft(spectrum, n)
    bands = [band_rms(force, RATE, low, high) for low, high in ((0, 5), (5, 20), (20, 50), (50, 200))]
    assert_allclose(np.sqrt(np.sum(np.square(bands))), force.std(), rtol=1e-12)


@pytest.mark.parametrize(("frequency", "band"), [(1.0, 0), (5.0, 0), (5.5, 1), (20.0, 1), (20.5, 2), (50.0, 2)])
def test_sine_falls_into_its_band_with_its_rms(frequency: float, band: int) -> None:
    """Whole periods in 4 s: no leakage. An edge belongs to the band below it."""
    time = np.arange(2000) / RATE
    force = 120 + 10 * np.sin(2 * np.pi * frequency * time + 0.3)
    values = [band_rms(force, RATE, low, high) for low, high in ((0, 5), (5, 20), (20, 50))]
    expected = [0.0, 0.0, 0.0]
    expected[band] = 10 / np.sqrt(2)
    assert_allclose(values, expected, atol=1e-10)


@settings(max_examples=20)
@given(seed=st.integers(0, 1000), scale=st.floats(0.01, 100), shift=st.floats(-1000, 1000))
def test_band_scales_with_the_force_and_ignores_its_mean(seed: int, scale: float, shift: float) -> None:
    force = noise(seed)
    assert_allclose(band_rms(scale * force + shift, RATE, 5, 20), scale * band_rms(force, RATE, 5, 20), rtol=1e-6)


@pytest.mark.parametrize(
    ("rate", "samples", "band", "applied", "message"),
    [
        (125.0, 2000, (20, 50), None, None),  # 50 Hz is 0.4 of 125 samples per second
        (124.0, 2000, (20, 50), None, "record has 124 samples per second; a band up to 50 Hz needs at least 125"),
        (RATE, 400, (0, 5), None, None),  # 5 Hz times 0.8 s: four spectral lines
        (RATE, 399, (0, 5), None, "a band of 5 Hz needs at least"),
        (RATE, 60, (20, 50), None, "a band of 30 Hz needs at least"),
        (RATE, 300, (0, 5), None, r"the analysis section lasts 0\.6 s; a band of 5 Hz needs at least 0\.8 s"),
        (RATE, 2000, (5, 20), 20.0, None),
        (RATE, 2000, (5, 20), (1 - CUTOFF_TOLERANCE) * 20, None),  # a thousandth for printed numbers
        (RATE, 2000, (5, 20), 19.97, "which removed the band 5-20 Hz"),
        (RATE, 2000, (20, 50), 20.0, "filtered at 20 Hz before delivery, which removed the band 20-50 Hz"),
    ],
)
def test_band_needs_its_rate_its_length_and_no_filter_inside(
    rate: float, samples: int, band: tuple[float, float], applied: float | None, message: str | None
) -> None:
    force = noise(1, samples)
    error = AlreadyFiltered if applied else BandNotObservable
    with nullcontext() if message is None else pytest.raises(error, match=message):
        assert band_rms(force, rate, *band, applied) == band_rms(force, rate, *band) > 0


def test_spectrum_has_every_line_with_the_amplitude_of_its_sine() -> None:
    time = np.arange(2000) / RATE
    frequency, amplitude = amplitude_spectrum(120 + 10 * np.sin(2 * np.pi * 12.5 * time), RATE, 50.0)
    assert frequency[0] > 0
    assert frequency[-1] <= 50.0
    assert_allclose(amplitude[np.argmax(amplitude)], 10.0, rtol=1e-12)
    assert frequency[np.argmax(amplitude)] == 12.5
    # 4 s give lines every 0.25 Hz; the end itself belongs to the spectrum, the mean does not.
    frequency, amplitude = amplitude_spectrum(noise(1), RATE, 50.0)
    assert_allclose(frequency, 0.25 * np.arange(1, 201), rtol=1e-12)
    inside = np.sqrt(np.sum(amplitude**2) / 2)
    assert_allclose(inside, band_rms(noise(1), RATE, 0, 50), rtol=1e-12)


def test_bands_of_the_contract_have_no_gap_and_no_roll_off() -> None:
    """]0, 5], ]5, 20] and ]20, 50] Hz (Vo Van et al. 2015, Table 1); the names of the quantities state them."""
    assert [tuple(band) for band in BANDS] == [(0, 5, "rms_0_5_N"), (5, 20, "rms_5_20_N"), (20, 50, "rms_20_50_N")]
    # White noise through |H|^2 = 1/(1 + W^6)^2-like skirts: within 5 %, and equal without content near the cut-off.
    force = noise(5, 20_000)
    brick = band_rms(force, RATE, 0, 20)
    assert_allclose(Filter()(force, RATE).std(), brick, rtol=0.05)
    time = np.arange(20_000) / RATE
    slow = 120 + 20 * np.sin(2 * np.pi * 1.0 * time) + 10 * np.sin(2 * np.pi * 7.0 * time)
    # Gain at 7 Hz is 1 - 0.5 (7/20)^6 (sqrt(2) - 1) ~ 0.999.
    assert_allclose(Filter()(slow, RATE)[5000:15_000].std(), band_rms(slow, RATE, 0, 20), rtol=1e-3)

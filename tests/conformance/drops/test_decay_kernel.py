"""Transform of a truncated decay, which is exact."""

import numpy as np
import pytest
import scipy.signal
from hypothesis import given
from hypothesis import strategies as st

from pantocheck.conformance.drops.decay_kernel import (
    FrequencyBand,
    decay_kernel,
    drift_columns,
    far_pole_columns,
    filter_full_overlap,
    filter_gain,
    join_conjugates,
    kernel_and_derivative,
    low_pass_taps,
    real_columns,
)
from pantocheck.conformance.drops.decay_search import DecaySearch, ResidualWindows

DT, N = 0.025, 400


@given(
    frequency=st.floats(0.2, 15.0),
    damping_ratio=st.floats(1e-5, 0.05),
    amplitude=st.complex_numbers(min_magnitude=0.1, max_magnitude=10, allow_nan=False),
)
def test_model_is_the_transform_of_the_decay(frequency: float, damping_ratio: float, amplitude: complex) -> None:
    """The geometric sum is exact, so only rounding over N terms is left: 1e-10 of the largest line."""
    pole = np.array([2 * np.pi * frequency * (-damping_ratio + 1j)])
    omega = 2 * np.pi * np.arange(1, N // 2) / (N * DT)
    decay = 2 * (amplitude * np.exp(pole * DT * np.arange(N))).real
    modelled = amplitude * decay_kernel(pole, omega, DT, N)[:, 0]
    modelled += np.conj(amplitude) * decay_kernel(pole.conj(), omega, DT, N)[:, 0]
    measured = np.fft.rfft(decay)[1 : N // 2]
    assert np.abs(modelled - measured).max() < 1e-10 * np.abs(measured).max()


def test_columns_of_kernels_have_their_derivatives_and_residues() -> None:
    """Central differences of step h have an error of order h^2: here h = 1e-4, and the kernel varies over 0.05 1/s."""
    poles = np.array([-0.05 + 6.0j, -0.2 + 11.3j])
    omega = 2 * np.pi * np.arange(5, 60) / (N * DT)
    h = 1e-4
    slope = kernel_and_derivative(poles, omega, DT, N)[1]()
    difference = (decay_kernel(poles + h, omega, DT, N) - decay_kernel(poles - h, omega, DT, N)) / (2 * h)
    assert np.abs(slope - difference).max() < 1e-5 * np.abs(slope).max()
    poles, residue = np.array([-0.1 + 5.0j]), 0.7 - 1.9j
    omega = 2 * np.pi * np.arange(1, 50) / (N * DT)
    kernels = decay_kernel(join_conjugates(poles), omega, DT, N)
    expected = kernels @ np.array([residue, np.conj(residue)])
    rows = real_columns(kernels) @ np.array([residue.real, residue.imag])
    assert rows == pytest.approx(np.concatenate([expected.real, expected.imag]), rel=1e-12, abs=1e-12)


def test_extra_columns_absorb_a_drift_and_distant_modes() -> None:
    """A cubic drift is a combination of the first three Legendre polynomials: the residual is rounding."""
    t = np.linspace(0, 1, N)
    lines = np.arange(1, 60)
    drift = np.fft.rfft(3 - 2 * t + t**2 - 4 * t**3)[lines]
    rows = np.concatenate([drift.real, drift.imag])
    columns = drift_columns(4, N, lines)
    left = rows - columns @ np.linalg.lstsq(columns, rows, rcond=None)[0]
    assert np.linalg.norm(left) < 1e-10 * np.linalg.norm(rows)
    # Poles at three half-widths from the middle of the band; the terms of a series in 1 / 3 fall by 3^4 to 1 %.
    omega = 2 * np.pi * np.arange(40, 120) / (N * DT)
    columns = far_pole_columns(omega, 3)
    assert columns.shape == (2 * omega.size, 8)
    assert np.linalg.norm(columns, axis=0) == pytest.approx(1, rel=1e-12)
    middle, half = (omega[0] + omega[-1]) / 2, (omega[-1] - omega[0]) / 2
    for distance in (-3.0, 3.0):
        tail = (0.3 + 2j) / (1j * (omega - middle - distance * half) + 0.1)
        rows = np.concatenate([tail.real, tail.imag])
        left = rows - columns @ np.linalg.lstsq(columns, rows, rcond=None)[0]
        assert np.linalg.norm(left) < 0.01 * np.linalg.norm(rows)


# Band of an identification, and finite filters that keep the poles of a decay.
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


@pytest.mark.parametrize(("attenuation", "stops"), [(40.0, 8.0), (50.0, 5.7), (80.0, 9.0), (90.0, 5.1)])
def test_taps_are_those_of_scipy(attenuation: float, stops: float) -> None:
    """The same formulas; rounding of the Bessel function is below 1e-14."""
    length, beta = scipy.signal.kaiserord(attenuation, (stops - 5.0) / 50)
    expected = scipy.signal.firwin(length | 1, (5.0 + stops) / 2, window=("kaiser", beta), fs=100.0)
    assert low_pass_taps(100.0, 5.0, stops, attenuation) == pytest.approx(expected, rel=1e-12, abs=1e-14)


@pytest.mark.parametrize("count", [30, 31, 256, 500, 5000])
@pytest.mark.parametrize("factor", [1.0, 1.0 + 2.0j], ids=["real", "complex"])
def test_filtered_samples_are_the_full_overlap_of_a_convolution(count: int, factor: complex) -> None:
    """Sums of 31 products of order 1, also in several parts; a record that is shorter than the filter has none."""
    random = np.random.default_rng(1)
    taps, samples = random.standard_normal(31), random.standard_normal((count, 2)) * factor
    found = filter_full_overlap(samples, taps)
    assert (found.shape, found.dtype) == ((max(count - 30, 0), 2), samples.dtype)
    for channel, filtered in zip(samples.T, found.T, strict=True):
        expected = np.convolve(channel, taps, "valid") if count > 30 else []
        assert filtered == pytest.approx(np.array(expected), abs=1e-13)


@pytest.mark.parametrize("attenuation", [40.0, 60.0, 80.0])
def test_low_pass_has_its_attenuation(attenuation: float) -> None:
    """A Kaiser window has ripples of the attenuation in both bands; the estimate of its length misses it by 2 dB."""
    taps = low_pass_taps(100.0, 5.0, 8.0, attenuation)
    frequency, response = scipy.signal.freqz(taps, fs=100.0, worN=4096)
    ripple = 10 ** (-(attenuation - 2) / 20)
    assert np.abs(np.abs(response[frequency <= 5.0]) - 1).max() < ripple
    assert np.abs(response[frequency >= 8.0]).max() < ripple
    assert np.abs(response[frequency >= 8.0]).max() > 10 ** (-(attenuation + 6) / 20)
    assert taps.size % 2 == 1


def test_filter_gain_is_that_of_a_filtered_decay() -> None:
    """Exact: a decay is an eigenfunction of a finite filter. The middle tap gives the time of a filtered sample."""
    rate, poles = 50.0, np.array([-0.3 + 12.0j, -1.5 + 31.0j])
    taps = low_pass_taps(rate, 4.0, 7.0, 60.0)
    decay = np.exp(np.outer(np.arange(200) / rate, poles))
    filtered = filter_full_overlap(decay, taps)
    assert filtered.shape[0] == 200 - taps.size + 1
    expected = filter_gain(taps, poles, rate) * decay[taps.size // 2 :][: filtered.shape[0]]
    assert filtered == pytest.approx(expected, abs=1e-12)


# Search for the end of a linear decay: disturbed windows, and a disturbance of one sensor among many.


def build_windows(pattern: str) -> ResidualWindows:
    """Windows of 20 samples, one every 5 samples; x is disturbed."""
    disturbed = np.array([mark == "x" for mark in pattern])
    return ResidualWindows(5 * np.arange(disturbed.size), disturbed, window=20, reach=30)


@pytest.mark.parametrize(
    ("pattern", "begin", "end"),
    [
        ("xx.....x....xx.xxx..", 0, 55),  # four of six windows, the first of them less a quarter of a window
        ("xxxxxx....xxxx......", 0, 45),  # the disturbance at the very beginning is not the end
        ("..xxxxxx....xxxx......", 0, 55),  # calm for less than a window
        ("xxxxxx....xxxx......", 55, np.iinfo(np.int64).max),
        ("..........xxx.......", 0, np.iinfo(np.int64).max),  # three windows are chance
        ("..........xxx..x....", 0, 45),
        ("xxxxxxxxxxxxxxxxxxxx", 15, 15),  # no calm window
        ("....................", 0, np.iinfo(np.int64).max),
    ],
)
def test_disturbance_after_a_calm_window_lasts(pattern: str, begin: int, end: int) -> None:
    assert build_windows(pattern).first_after_calm(begin) == end


@pytest.mark.parametrize(
    ("pattern", "sample", "stays"),
    [
        (".......xxxxx...", 35, True),  # five of eight windows
        (".......xxxx....", 35, False),  # four of eight
        ("........xxxxxxx", 40, False),  # seven windows are too few
        (".......xxxxxxxx", 35, True),
        ("xxxxxxxxxxxx....xx..", 60, False),
    ],
)
def test_wind_disturbs_most_of_at_least_eight_windows(pattern: str, sample: int, stays: bool) -> None:
    assert build_windows(pattern).stays_disturbed(sample) == stays


@pytest.mark.parametrize(("factor", "ends"), [(1.3, False), (3.5, True)])
def test_one_disturbed_sensor_among_sixteen_ends_the_decay(factor: float, ends: bool) -> None:
    """Noise times 3.5 in one channel from 30 s on: 12 times the mean square there, 1.7 times in the mean of sixteen."""
    # A window of 4 s up to 4 Hz has 30 degrees of freedom: one channel alone counts from 1 + 9 sqrt(2 / 30) = 3.3
    # times, all together from twice.
    dt, n = 0.05, 900
    random = np.random.default_rng(1)
    t = dt * np.arange(n)
    poles = 2 * np.pi * np.array([0.9, 1.7]) * (-0.004 + 1j)
    residues = random.standard_normal((2, 16)) * np.exp(1j * random.uniform(0, 6, (2, 16)))
    noise = 0.02 * random.standard_normal((n, 16))
    noise[t > 30.0, 3] *= factor
    samples = 2 * (np.exp(np.outer(t, poles)) @ residues).real + noise
    search = DecaySearch(np.asarray(samples), 40, dt, FrequencyBand.up_to(4.0, 50.0), np.asarray(samples)[:0])
    start, end, found = search.find_linear_part()
    assert start * dt < 2.1
    # A window of 4 s and its filter reach beyond the start of the disturbance.
    assert (25.5 < end * dt < 30.5) if ends else end == n
    for pole in poles:
        assert np.abs(found - pole).min() < 0.1 * -pole.real

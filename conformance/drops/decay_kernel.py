"""Exact discrete Fourier transform of a truncated free decay, and filters that keep its pole.

A decay x_n = A exp(lambda n dt) + conj., n = 0..N-1, has at the lines w_k = 2 pi k / (N dt) the transform

    X_k = A (1 - exp(lambda N dt)) / (1 - q_k) + conj. part,    q_k = exp((lambda - i w_k) dt)

because w_k N dt is a multiple of 2 pi. The model thus includes leakage: no window is needed, and the lines of white
noise remain uncorrelated.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from pantocheck.conformance.core.array_types import ComplexArray, IntegerArray, RealArray


def decay_kernel(poles: ComplexArray, omega: RealArray, dt: float, n: int) -> ComplexArray:
    """Transform of exp(lambda n dt), n = 0..N-1, at spectral lines of the record.

    Args:
        poles: Poles lambda, (m,) [1/s].
        omega: Angular frequencies, multiples of 2 pi / (n dt), (k,) [rad/s].
        dt: Sampling interval [s].
        n: Number of samples N.

    Returns:
        Sum of the geometric series, (k, m) [-].
    """
    return np.asarray(-np.expm1(poles * (n * dt)) / _one_minus_q(poles, omega, dt))


def kernel_and_derivative(
    poles: ComplexArray, omega: RealArray, dt: float, n: int
) -> tuple[ComplexArray, Callable[[], ComplexArray]]:
    """Kernel [-], and a function that computes its derivative by lambda [s], each (k, m); see `decay_kernel`."""
    growth = np.expm1(poles * (n * dt))
    inverse = np.reciprocal(_one_minus_q(poles, omega, dt))
    value = inverse * -growth
    return np.asarray(value), lambda: np.asarray(dt * (inverse * (value - n * (1 + growth)) - value))


def _one_minus_q(poles: ComplexArray, omega: RealArray, dt: float) -> ComplexArray:
    """1 - q, (k, m), from expm1 of both exponents, because q is close to 1 near a pole: 1 - e^(a+b) = -e^b E(a) - E(b).

    With one exponential per pole and per line, instead of one per pair, it takes a fifth of the time.
    """
    at_line = np.expm1(-1j * dt * omega)
    product = (-1 - at_line)[:, None] * np.expm1(poles * dt)
    product -= at_line[:, None]
    return np.asarray(product)


def join_conjugates(poles: ComplexArray) -> ComplexArray:
    """Poles followed by their conjugates, (2 m,)."""
    return np.concatenate([poles, poles.conj()])


def real_columns(kernels: ComplexArray) -> RealArray:
    """Real least-squares columns of A K(lambda) + conj(A) K(conj lambda).

    Args:
        kernels: K (or its derivative) at the poles lambda, then at their conjugates, (k, 2 m).

    Returns:
        Rows, (2 k, 2 m): real parts, then imaginary parts. Columns: factors of Re A of all poles, then of Im A of all
        poles.
    """
    k, m = kernels.shape[0], kernels.shape[1] // 2
    own, conjugate = kernels[:, :m], kernels[:, m:]
    columns = np.empty((2 * k, 2 * m))
    np.add(own.real, conjugate.real, out=columns[:k, :m])
    np.add(own.imag, conjugate.imag, out=columns[k:, :m])
    np.subtract(conjugate.imag, own.imag, out=columns[:k, m:])
    np.subtract(own.real, conjugate.real, out=columns[k:, m:])
    return columns


def stack_real_imaginary(spectrum: ComplexArray) -> RealArray:
    """Real parts above imaginary parts: (k, ...) complex spectral lines as (2 k, ...) real rows."""
    return np.concatenate([spectrum.real, spectrum.imag])


def drift_columns(degree: int, n: int, lines: IntegerArray) -> RealArray:
    """Columns for a drift of the offset: transforms of Legendre polynomials 1..degree in time, (2 k, degree).

    The columns have unit length. A constant offset appears in line 0 only, which is not used.
    """
    t = np.linspace(-1.0, 1.0, n)
    polynomials = np.polynomial.legendre.legvander(t, degree)[:, 1:]
    columns = stack_real_imaginary(np.fft.rfft(polynomials, axis=0)[lines])
    return np.asarray(columns / np.linalg.norm(columns, axis=0))


def far_pole_columns(omega: RealArray, degree: int) -> RealArray:
    """Columns for modes outside the band: complex polynomials in frequency, (2 k, 2 (degree + 1)), of unit length."""
    middle = (omega[0] + omega[-1]) / 2
    half = max((omega[-1] - omega[0]) / 2, 1e-12)
    polynomials = np.polynomial.legendre.legvander((omega - middle) / half, degree)
    zero = np.zeros_like(polynomials)
    columns = np.block([[polynomials, zero], [zero, polynomials]])
    return np.asarray(columns / np.linalg.norm(columns, axis=0))


# Frequency band of an identification, and filters of finite length, which do not change the pole of a decay.
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


def low_pass_taps(rate: float, passes: float, stops: float, attenuation: float) -> RealArray:
    """Taps of a linear-phase low-pass (Kaiser window).

    Args:
        rate: Sampling rate [Hz].
        passes, stops: Edges of the transition band [Hz].
        attenuation: Attenuation of the stop band, above 21 [dB].

    Returns:
        Taps, (t,); t is odd, and their sum is 1.

    References:
        [1] J. F. Kaiser, Nonrecursive digital filter design using the I0-sinh window function, IEEE Int. Symp. Circuits
            and Systems (1974) 20-23.
    """
    length = int(np.ceil((attenuation - 7.95) / (2.285 * 2 * np.pi * (stops - passes) / rate) + 1)) | 1
    beta = 0.1102 * (attenuation - 8.7)
    if attenuation <= 50:
        beta = 0.5842 * (attenuation - 21) ** 0.4 + 0.07886 * (attenuation - 21)
    offset = np.arange(length) - (length - 1) / 2
    taps = np.sinc((passes + stops) / rate * offset) * np.kaiser(length, beta)
    return np.asarray(taps / taps.sum())


def filter_full_overlap(samples: SampledArray, taps: RealArray) -> SampledArray:
    """Filtered samples at full overlap with the filter, (n - t + 1, c), in which each decay has its exact pole.

    Overlapping parts are multiplied in the frequency domain; of each, the samples with full overlap are kept.
    """
    (n, channels), t = samples.shape, taps.size
    length = 1 << (8 * t).bit_length()
    step, left = length - t + 1, max(n - t + 1, 0)
    padded = np.zeros((max(-(-left // step), 1) * step + t - 1, channels), dtype=samples.dtype)
    padded[:n] = samples
    parts = np.lib.stride_tricks.sliding_window_view(padded, length, axis=0)[::step]
    forward, back = (np.fft.fft, np.fft.ifft) if np.iscomplexobj(samples) else (np.fft.rfft, np.fft.irfft)
    filtered = back(forward(parts) * forward(taps, length), length)[:, :, t - 1 :]
    return np.asarray(filtered.transpose(0, 2, 1).reshape(-1, channels)[:left])


def filter_gain(taps: RealArray, poles: ComplexArray, rate: float) -> ComplexArray:
    """Complex gain of the filter for a decay at each pole, (m,).

    The delay of the filter is removed: the first filtered sample belongs to the time of the middle tap.
    """
    offsets = (np.arange(taps.size) - (taps.size - 1) / 2) / rate
    return np.asarray(np.exp(-np.outer(poles, offsets)) @ taps)

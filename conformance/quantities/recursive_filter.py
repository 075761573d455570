"""Butterworth filters in second-order sections: design, run over a signal, and frequency response.

`scipy.signal` has the same functions, but its import takes longer than the filters of a run. A test compares both.

Design: the poles of the analogue prototype lie on the unit circle. A low-pass multiplies them by the warped cut-off, a
band-pass maps each to two poles. The bilinear transform z = (1 + s) / (1 - s) gives the digital poles (Oppenheim and
Schafer, Discrete-Time Signal Processing, chapter on the design of filters).
"""

from functools import lru_cache

import numpy as np
import scipy  # loads scipy.linalg when it is used: a list of cases does not wait for it
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray


@lru_cache(maxsize=64)
def design_low_pass(order: int, cutoff: float, rate: float) -> RealArray:
    """Sections of a low-pass.

    Args:
        order: Order.
        cutoff: Frequency with an attenuation of 3 dB [Hz].
        rate: Sampling rate [Hz].

    Returns:
        Coefficients b0, b1, b2, 1, a1, a2 of each section, (sections, 6).
    """
    poles = np.tan(np.pi * cutoff / rate) * _prototype_poles(order)
    pairs = [(pole, pole.conj()) if pole.imag else (pole,) for pole in poles]
    return _join_sections([_build_section(pair, 0.0, [-1.0] * len(pair)) for pair in pairs])


@lru_cache(maxsize=64)
def design_band_pass(order: int, edges: tuple[float, float], rate: float) -> RealArray:
    """Sections of a band-pass.

    Args:
        order: Order of each edge.
        edges: Frequencies with an attenuation of 3 dB [Hz].
        rate: Sampling rate [Hz].

    Returns:
        Coefficients as in `design_low_pass`, (order, 6).
    """
    lower, upper = np.tan(np.pi * np.asarray(edges) / rate)
    middle, pairs = np.sqrt(lower * upper), []
    for pole in (upper - lower) / 2 * _prototype_poles(order):
        root = np.sqrt(complex(pole**2 - middle**2))
        split = (pole + root, pole - root)
        pairs += [(each, each.conj()) for each in split] if pole.imag else [split]
    return _join_sections([_build_section(pair, 1j * middle, [1.0, -1.0]) for pair in pairs])


def _join_sections(sections: list[RealArray]) -> RealArray:
    """Table of sections, which all callers of a design share."""
    table = np.array(sections)
    table.flags.writeable = False
    return table


def _prototype_poles(order: int) -> NDArray[np.complex128]:
    """Poles of the analogue low-pass with the cut-off 1 that have no negative imaginary part."""
    return np.asarray(-np.exp(-0.5j * np.pi * np.arange(1 - order % 2, order, 2) / order))


def _build_section(poles: tuple[complex, ...], unit_gain: complex, zeros: list[float]) -> RealArray:
    """Coefficients of a section.

    Args:
        poles: Analogue poles, one or two.
        unit_gain: Point of the analogue axis with the gain 1.
        zeros: Digital zeros, 1 or -1.
    """
    # z0 - z = 2 (s0 - s) / ((1 - s0) (1 - s)): the difference of the digital poles would lose digits.
    gain = np.prod([abs((unit_gain - pole) / (1 - pole)) for pole in poles]) / abs(unit_gain) ** zeros.count(1.0)
    section = np.zeros(6)
    section[: len(zeros) + 1] = gain * np.poly(zeros)
    section[3 : len(poles) + 4] = np.poly([(1 + pole) / (1 - pole) for pole in poles]).real
    return section


def filter_forwards(sections: RealArray, signal: RealArray) -> RealArray:
    """Filter a signal that had its first value for a long time.

    Args:
        sections: Coefficients as in `design_low_pass`.
        signal: Samples, (n,).

    Returns:
        Filtered samples, (n,).
    """
    for b0, b1, b2, _, a1, a2 in sections:
        first = signal[0]
        driven = b0 * signal
        driven[1:] += b1 * signal[:-1]
        driven[2:] += b2 * signal[:-2]
        rest = first * (b0 + b1 + b2) / (1 + a1 + a2)
        driven[0] += (b1 + b2) * first - (a1 + a2) * rest
        driven[1:2] += b2 * first - a2 * rest
        # The recursion is the solution of a lower triangular system with three diagonals.
        diagonals = np.empty((3, signal.size), order="F")
        diagonals[:] = [[1.0], [a1], [a2]]
        signal = scipy.linalg.lapack.dtbtrs(diagonals, driven, uplo="L", diag="U")[0]
    return signal


def filter_both_ways(sections: RealArray, signal: RealArray, padding: int) -> RealArray:
    """Filter a signal forwards and backwards.

    Args:
        sections: Coefficients as in `design_low_pass`.
        signal: Samples, (n,).
        padding: Samples by which both ends are extended, point-symmetric about the end; less than n.

    Returns:
        Filtered samples, (n,).
    """
    before, after = 2 * signal[0] - signal[padding:0:-1], 2 * signal[-1] - signal[-2 : -padding - 2 : -1]
    forwards = filter_forwards(sections, np.concatenate([before, signal, after]))
    return filter_forwards(sections, forwards[::-1])[::-1][padding : padding + signal.size]


def frequency_response(sections: RealArray, frequency: RealArray, rate: float) -> NDArray[np.complex128]:
    """Response of a single run.

    Args:
        sections: Coefficients as in `design_low_pass`.
        frequency: Frequencies, (n,) [Hz].
        rate: Sampling rate [Hz].

    Returns:
        Complex gains, (n,).
    """
    delay = np.exp(-2j * np.pi * np.asarray(frequency) / rate)
    powers = np.array([np.ones_like(delay), delay, delay**2])
    return np.asarray(np.prod(sections[:, :3] @ powers / (sections[:, 3:] @ powers), axis=0))

"""Low-pass and band-pass filters in second-order sections.

A transfer function in polynomial form overflows at high sampling rates and low cut-offs; sections do not.
"""

from functools import lru_cache
from typing import Annotated, Literal

import numpy as np
import scipy  # loads scipy.linalg when it is used: a list of cases does not wait for it
from numpy.typing import NDArray
from pydantic import Field

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.sourced_table import InputTable, Problems, cross_check, validation_problem
from pantocheck.conformance.quantities.unavailable import AlreadyFiltered, BandNotObservable


# Butterworth filters in second-order sections: design, run over a signal, and frequency response.
#
# `scipy.signal` has the same functions, but its import takes longer than the filters of a run. A test compares both.
#
# Design: the poles of the analogue prototype lie on the unit circle. A low-pass multiplies them by the warped cut-off,
# a band-pass maps each to two poles. The bilinear transform z = (1 + s) / (1 - s) gives the digital poles (Oppenheim
# and Schafer, Discrete-Time Signal Processing, chapter on the design of filters).
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


# Low-pass and band-pass filters in second-order sections.
HIGHEST_SHARE_OF_RATE = 0.4
"""Highest observable frequency over sampling rate [-]; anti-alias filters attenuate higher frequencies."""

CUTOFF_TOLERANCE = 0.001
"""Relative difference up to which two stated cut-offs are the same; they are printed with three digits or more."""


def is_observable(frequency: float, rate: float) -> bool:
    """Whether a record with a sampling rate [Hz] supports a frequency [Hz]."""
    return frequency <= HIGHEST_SHARE_OF_RATE * rate


def check_observable(frequency: float, rate: float, purpose: str) -> None:
    """Refuse a sampling rate that is too low for a frequency.

    Args:
        frequency: Highest frequency that is needed [Hz].
        rate: Sampling rate [Hz].
        purpose: Filter or band that needs the frequency, for the message.

    Raises:
        BandNotObservable: The rate is too low.
    """
    if not is_observable(frequency, rate):
        raise BandNotObservable(
            f"the record has {rate:g} samples per second; "
            f"{purpose} needs at least {frequency / HIGHEST_SHARE_OF_RATE:g}"
        )


HALF_POWER_DB = 3
"""Attenuation to half of the power [dB], as it is printed."""

BandDefinition = Literal["spectral lines", "band-pass"]
"""RMS in a band: of the spectral lines of the unfiltered force, or of the force behind a band-pass."""


class Filter(InputTable):
    """Filter of the graded contact force, and definition of its bands."""

    kind: Literal["butterworth"] = "butterworth"
    """Filter type."""
    order: Annotated[int, Field(ge=1, le=12)] = 6
    """Total order, over both passes of a zero-phase filter; of a band-pass, the order of each edge."""
    cutoff_Hz: Annotated[float, Field(gt=0, le=1000)] = 20.0
    """Frequency at which the whole filter has the attenuation `attenuation_dB` [Hz]."""
    phase: Literal["zero", "causal"] = "zero"
    """zero: forward and backward pass; causal: forward only."""
    attenuation_dB: Annotated[Literal[3, 6], Field(exclude_if=lambda attenuation: attenuation == HALF_POWER_DB)] = 3
    """Attenuation of the whole filter at the cut-off, and at both edges of a band-pass: 3 (half of the power) or 6
    (half of the amplitude) [dB].
    """
    bands: Annotated[BandDefinition, Field(exclude_if=lambda bands: bands == "spectral lines")] = "spectral lines"
    """spectral lines: bands of the unfiltered force, by Parseval; band-pass: bands behind filters of this order, phase
    and attenuation at both edges.
    """

    @cross_check
    def _exists(self) -> Problems:
        if self.phase == "zero" and self.order % 2:
            yield validation_problem(
                "order",
                f"{self.order} is odd",
                'Give an even order: a zero-phase filter divides it between two passes. Or set phase = "causal".',
            )

    def change_cutoff(self, cutoff_Hz: float) -> "Filter":
        """Same kind of filter with another cut-off [Hz]."""
        return self.model_copy(update={"cutoff_Hz": cutoff_Hz})

    def sections(self, rate: float, low: float = 0.0) -> RealArray:
        """Second-order sections of a single run.

        Args:
            rate: Sampling rate [Hz].
            low: Lower edge of a band-pass up to the cut-off [Hz]; 0: low-pass.

        Raises:
            BandNotObservable: The cut-off is too high for the rate.
        """
        check_observable(self.cutoff_Hz, rate, f"a filter at {self.cutoff_Hz:g} Hz")
        order, cutoff = self.single_run(rate)
        if low == 0:
            return design_low_pass(order, cutoff, rate)
        return design_band_pass(order, self._single_band(rate, low), rate)

    @property
    def runs(self) -> int:
        """Runs of the filter over the signal: 2 for zero phase, forwards and backwards; 1 for a causal filter."""
        return 2 if self.phase == "zero" else 1

    @property
    def _edge(self) -> float:
        """Edge of the whole filter over the -3 dB frequency of a single run, both on the axis W of `single_run`."""
        gain = np.sqrt(2) if self.attenuation_dB == HALF_POWER_DB else 2.0
        return float((gain ** (2 / self.runs) - 1) ** (self.runs / (2 * self.order)))

    def single_run(self, rate: float) -> tuple[int, float]:
        """Order and -3 dB frequency [Hz] of a single run, for a sampling rate [Hz].

        A zero-phase filter runs a filter of half the order forwards and backwards. One run of order m has the gain
        1/sqrt(1 + W^2m), two runs have 1/(1 + W^2m), with W = tan(pi f/rate) / tan(pi f0/rate) under the bilinear
        transform. The cut-off f0 of a single run is therefore moved by W(f_c) = (g^(2/r) - 1)^(1/2m), so that all r
        runs together have the gain 1/g at the cut-off, with g = sqrt(2) for -3 dB and g = 2 for -6 dB.
        """
        if self.phase == "causal" and self.attenuation_dB == HALF_POWER_DB:
            return self.order, self.cutoff_Hz
        warped = np.tan(np.pi * self.cutoff_Hz / rate) / self._edge
        return self.order // self.runs, float(rate / np.pi * np.arctan(warped))

    def _single_band(self, rate: float, low: float) -> tuple[float, float]:
        """-3 dB frequencies [Hz] of a single run of a band-pass; parameters as in `sections`.

        The edges keep their geometric mean on the warped axis; their distance is divided by W of `single_run`.
        """
        lower, upper = np.tan(np.pi * np.array([low, self.cutoff_Hz]) / rate)
        width = (upper - lower) / self._edge
        upper = (width + np.sqrt(width**2 + 4 * lower * upper)) / 2
        lower, upper = rate / np.pi * np.arctan([upper - width, upper])
        return float(lower), float(upper)

    def __call__(self, signal: RealArray, rate: float, low: float = 0.0) -> RealArray:
        """Filter a signal; the transients at its ends decay within a few periods of the lowest edge.

        Args:
            signal: Samples of the whole record, so that the transients lie outside the analysis section, (n,).
            rate: Sampling rate [Hz].
            low: Lower edge of a band-pass up to the cut-off [Hz]; 0: low-pass.

        Returns:
            Filtered samples, (n,).
        """
        sections = self.sections(rate, low)
        if self.phase == "causal":
            return filter_forwards(sections, signal)
        padding = min(signal.size - 1, int(np.ceil(2 * rate / (low or self.cutoff_Hz))))
        return filter_both_ways(sections, signal, padding)

    def gain(self, frequency: RealArray, rate: float, low: float = 0.0) -> RealArray:
        """Gain of the whole filter at frequencies [Hz]; other parameters as in `sections`."""
        return np.asarray(np.abs(frequency_response(self.sections(rate, low), frequency, rate)) ** self.runs)


def is_same_cutoff(stated_Hz: float, cutoff_Hz: float) -> bool:
    """Whether a stated cut-off is that of a filter [Hz], up to `CUTOFF_TOLERANCE`."""
    return abs(stated_Hz / cutoff_Hz - 1) <= CUTOFF_TOLERANCE


def needs_filter(low_pass: Filter, filter_applied_Hz: float | None) -> bool:
    """Whether a delivered force must still be filtered.

    A second filter with the same cut-off would attenuate the force at the cut-off once more.

    Args:
        low_pass: Filter of the graded force.
        filter_applied_Hz: Cut-off of the low-pass filter applied before delivery [Hz]; None: unfiltered.

    Returns:
        False if the force was filtered with the same cut-off before delivery.

    Raises:
        AlreadyFiltered: The force was filtered with a lower cut-off.
    """
    if filter_applied_Hz is None or filter_applied_Hz > (1 + CUTOFF_TOLERANCE) * low_pass.cutoff_Hz:
        return True
    if filter_applied_Hz < (1 - CUTOFF_TOLERANCE) * low_pass.cutoff_Hz:
        raise AlreadyFiltered(
            f"the force was low-pass filtered at {filter_applied_Hz:g} Hz before delivery; "
            f"its content up to {low_pass.cutoff_Hz:g} Hz is not known"
        )
    return False

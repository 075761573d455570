"""Low-pass filters in second-order sections.

A transfer function in polynomial form overflows at high sampling rates and low cut-offs; sections do not.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.signal import butter, sosfilt, sosfilt_zi, sosfiltfilt, sosfreqz

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.unavailable import AlreadyFiltered, BandNotObservable

HIGHEST_SHARE_OF_RATE = 0.4
"""A frequency is observable up to this share of the sampling rate: above it the anti-alias filter rules."""


@dataclass(frozen=True)
class LowPass:
    """Butterworth low-pass, -3 dB at its cut-off.

    `order` is the total order, the slope of the whole filter: a zero-phase filter runs a filter of half the order
    forwards and backwards, and the two together fall off with `order` and have -3 dB at the cut-off. One run of order
    m has the gain 1/sqrt(1 + W^2m), two have 1/(1 + W^2m), W = tan(pi f/rate) / tan(pi f0/rate) under the bilinear
    transform; so the cut-off f0 of the single run is moved up by W(f_c) = (sqrt(2) - 1)^(1/2m).

    Parameters
    ----------
    kind : Literal[butterworth]
        Family of the filter.
    order : int
        Total order; even for zero phase.
    cutoff_Hz : float
        Where the whole filter has -3 dB [Hz].
    phase : Literal[zero, causal]
        `zero` (forwards and backwards) or `causal` (forwards only, as an instrument does).
    """

    kind: Literal["butterworth"] = "butterworth"
    order: int = 6
    cutoff_Hz: float = 20.0
    phase: Literal["zero", "causal"] = "zero"

    def __post_init__(self) -> None:
        if self.order < 1 or (self.phase == "zero" and self.order % 2):
            raise ValueError(
                f"order {self.order} does not exist with phase {self.phase}: zero phase needs an even order"
            )

    def sections(self, rate: float) -> RealArray:
        """Second-order sections of a single run at a sampling rate [Hz].

        Raises
        ------
        BandNotObservable
            The cut-off is too high for the rate.
        """
        if self.cutoff_Hz > HIGHEST_SHARE_OF_RATE * rate:
            raise BandNotObservable(
                f"a filter at {self.cutoff_Hz:g} Hz needs at least {self.cutoff_Hz / HIGHEST_SHARE_OF_RATE:g} samples "
                f"per second; the record has {rate:g}"
            )
        if self.phase == "causal":
            return np.asarray(butter(self.order, self.cutoff_Hz, fs=rate, output="sos"))
        half = self.order // 2
        warped = np.tan(np.pi * self.cutoff_Hz / rate) / (np.sqrt(2) - 1) ** (1 / (2 * half))
        return np.asarray(butter(half, rate / np.pi * np.arctan(warped), fs=rate, output="sos"))

    def __call__(self, signal: RealArray, rate: float) -> RealArray:
        """Filter a signal; transients of its two ends decay within a few periods of the cut-off.

        Parameters
        ----------
        signal : (n,) ndarray
            Samples of the whole record, so that the transients lie outside the evaluated stretch.
        rate : float
            Samples per second [Hz].
        """
        sections = self.sections(rate)
        if self.phase == "causal":
            filtered, _ = sosfilt(sections, signal, zi=sosfilt_zi(sections) * signal[0])
            return np.asarray(filtered)
        padding = min(signal.size - 1, int(np.ceil(2 * rate / self.cutoff_Hz)))
        return np.asarray(sosfiltfilt(sections, signal, padlen=padding))

    def gain(self, frequency: RealArray, rate: float) -> RealArray:
        """Magnitude of the whole filter at frequencies [Hz], sampled at a rate [Hz]."""
        _, response = sosfreqz(self.sections(rate), worN=frequency, fs=rate)
        return np.asarray(np.abs(response) ** (2 if self.phase == "zero" else 1))


def filter_force(signal: RealArray, rate: float, low_pass: LowPass, filter_applied_Hz: float | None) -> RealArray:
    """Signal filtered to a cut-off, also when it has been through a filter before.

    A signal delivered with the same cut-off is left as it is: a second pass would take another 3 dB at the cut-off.

    Raises
    ------
    AlreadyFiltered
        The signal was filtered below the cut-off.
    BandNotObservable
        The rate is too low for the cut-off.
    """
    if filter_applied_Hz is None or filter_applied_Hz > 1.001 * low_pass.cutoff_Hz:
        return low_pass(signal, rate)
    if filter_applied_Hz < 0.999 * low_pass.cutoff_Hz:
        raise AlreadyFiltered(
            f"the force was delivered filtered at {filter_applied_Hz:g} Hz; "
            f"nothing is known of it up to {low_pass.cutoff_Hz:g} Hz"
        )
    return signal

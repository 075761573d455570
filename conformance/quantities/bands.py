"""Frequency bands of the contact force, their RMS values and the amplitude spectrum."""

from typing import NamedTuple

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.filters import CUTOFF_TOLERANCE, check_observable
from pantocheck.conformance.quantities.unavailable import AlreadyFiltered, BandNotObservable

MIN_BAND_LINES = 4
"""Smallest number of spectral lines in a band; with fewer lines, leakage at the section ends distorts the RMS."""


class Band(NamedTuple):
    """Frequency band ]low, high] [Hz] and the name of the quantity that states its RMS."""

    low: float
    high: float
    quantity: str


BANDS = (Band(0, 5, "rms_0_5_N"), Band(5, 20, "rms_5_20_N"), Band(20, 50, "rms_20_50_N"))
"""Bands that partition the variance of the contact force up to 50 Hz (Vo Van et al. 2015, Table 1)."""

BAND_QUANTITIES = tuple(band.quantity for band in BANDS)
"""Names of the quantities that state the RMS of each band."""

EXTENDED_BAND = BANDS[-1]
"""Band above the limit of 20 Hz in EN 50318."""


def band_rms(force: RealArray, rate: float, low: float, high: float, filter_applied_Hz: float | None = None) -> float:
    """Root mean square of the force inside a frequency band, by Parseval.

    The bands ]0, 5], ]5, 20], ]20, 50] Hz partition the variance: their squares add up to the variance of the force
    band-limited to 50 Hz (Vo Van et al. 2015, Table 1).

    Args:
        force: Contact force over the analysis section, (n,) [N].
        rate: Sampling rate [Hz].
        low, high: Edges of the band ]low, high] [Hz].
        filter_applied_Hz: Cut-off of the low-pass filter applied before delivery [Hz]; None: unfiltered.

    Returns:
        RMS value [N].

    Raises:
        BandNotObservable: The analysis section is too short for the band, or the rate too low for its upper edge.
        AlreadyFiltered: The force was filtered below the upper edge before delivery.
    """
    check_band(force.size / rate, rate, low, high, filter_applied_Hz)
    return sum_lines(*compute_power(force, rate), low, high)


def sum_lines(frequency: RealArray, power: RealArray, low: float, high: float) -> float:
    """RMS in a band ]low, high] [Hz] from spectral lines of `compute_power` [N]."""
    return float(np.sqrt(power[(frequency > low) & (frequency <= high)].sum()))


def check_band(duration: float, rate: float, low: float, high: float, filter_applied_Hz: float | None) -> None:
    """Refuse an analysis section of a duration [s] that does not support a band; the rest as in `band_rms`."""
    check_observable(high, rate, f"a band up to {high:g} Hz")
    if filter_applied_Hz is not None and filter_applied_Hz < (1 - CUTOFF_TOLERANCE) * high:
        raise AlreadyFiltered(
            f"the force was low-pass filtered at {filter_applied_Hz:g} Hz before delivery, "
            f"which removed the band {low:g}-{high:g} Hz"
        )
    if (high - low) * duration < MIN_BAND_LINES:
        raise BandNotObservable(
            f"the analysis section lasts {duration:.3g} s; "
            f"a band of {high - low:g} Hz needs at least {MIN_BAND_LINES / (high - low):g} s"
        )


def band_part(force: RealArray, rate: float, low: float, high: float) -> RealArray:
    """Part of the force inside a frequency band; its root mean square is `band_rms`.

    Args:
        force: Contact force over the analysis section, (n,) [N].
        rate: Sampling rate [Hz].
        low, high: Edges of the band ]low, high] [Hz].

    Returns:
        Force inside the band, (n,) [N].
    """
    frequency, lines = np.fft.rfftfreq(force.size, 1 / rate), np.fft.rfft(force)
    lines[(frequency <= low) | (frequency > high)] = 0
    return np.asarray(np.fft.irfft(lines, force.size))


def amplitude_spectrum(force: RealArray, rate: float, highest: float) -> tuple[RealArray, RealArray]:
    """Single-sided amplitude spectrum of the force about its mean.

    Args:
        force: Contact force, (n,) [N].
        rate: Sampling rate [Hz].
        highest: Highest frequency of the spectrum [Hz].

    Returns:
        frequency: Frequencies ]0, highest] [Hz].
        amplitude: Amplitudes [N].
    """
    frequency, power = compute_power(force, rate)
    inside = (frequency > 0) & (frequency <= highest)
    return frequency[inside], np.sqrt(2 * power[inside])


def compute_power(force: RealArray, rate: float) -> tuple[RealArray, RealArray]:
    """Frequencies [Hz] and contribution of each spectral line to the variance [N2].

    Each line includes its mirror image. The line at half the rate has none, but lies above every band.
    """
    power = 2 * np.abs(np.fft.rfft(force - force.mean()) / force.size) ** 2
    frequency = np.fft.rfftfreq(force.size, 1 / rate)
    return np.asarray(frequency, dtype=np.float64), np.asarray(power, dtype=np.float64)

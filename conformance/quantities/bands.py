"""Contact-force bands: how the variance of the force is shared out over frequency."""

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE
from pantocheck.conformance.quantities.unavailable import AlreadyFiltered, BandNotObservable

MIN_BAND_LINES = 4
"""Spectral lines a band must hold at least: with fewer, its rms is decided by where the stretch begins and ends."""


def band_rms(force: RealArray, rate: float, low: float, high: float, filter_applied_Hz: float | None = None) -> float:
    """Root mean square of the force inside a frequency band, by Parseval.

    The bands ]0, 5], ]5, 20], ]20, 50] Hz partition the variance: their squares add up to the variance of the force
    band-limited to 50 Hz (Vo Van et al. 2015, Table 1).

    Parameters
    ----------
    force : (n,) ndarray
        Contact force over the evaluated stretch [N].
    rate : float
        Samples per second [Hz].
    low, high : float
        Edges of the band ]low, high] [Hz].
    filter_applied_Hz : float or None
        Cut-off of a low-pass the force has been through [Hz]; None: unfiltered.

    Returns
    -------
    float
        [N].

    Raises
    ------
    BandNotObservable
        The stretch is too short for the band, or the rate too low for its upper edge.
    AlreadyFiltered
        The force was filtered below the upper edge before it was delivered.
    """
    if high > HIGHEST_SHARE_OF_RATE * rate:
        raise BandNotObservable(
            f"a band up to {high:g} Hz needs at least {high / HIGHEST_SHARE_OF_RATE:g} samples per second; "
            f"the record has {rate:g}"
        )
    if filter_applied_Hz is not None and filter_applied_Hz < 0.999 * high:
        raise AlreadyFiltered(
            f"the force was delivered filtered at {filter_applied_Hz:g} Hz; the band {low:g}-{high:g} Hz is gone"
        )
    duration = force.size / rate
    if (high - low) * duration < MIN_BAND_LINES:
        raise BandNotObservable(
            f"a band of {high - low:g} Hz needs at least {MIN_BAND_LINES / (high - low):g} s; "
            f"the evaluated stretch lasts {duration:.3g} s"
        )
    frequency, power = _power(force, rate)
    return float(np.sqrt(power[(frequency > low) & (frequency <= high)].sum()))


def amplitude_spectrum(force: RealArray, rate: float, highest: float) -> tuple[RealArray, RealArray]:
    """Single-sided amplitude spectrum of the force about its mean: frequencies ]0, highest] [Hz], amplitudes [N]."""
    frequency, power = _power(force, rate)
    inside = (frequency > 0) & (frequency <= highest)
    return frequency[inside], np.sqrt(2 * power[inside])


def _power(force: RealArray, rate: float) -> tuple[RealArray, RealArray]:
    """Frequencies [Hz] and the share of the variance at each [N2].

    Each line stands for itself and its mirror image. The one at half the rate has none, but lies above every band.
    """
    power = 2 * np.abs(np.fft.rfft(force - force.mean()) / force.size) ** 2
    frequency = np.fft.rfftfreq(force.size, 1 / rate)
    return np.asarray(frequency, dtype=np.float64), np.asarray(power, dtype=np.float64)

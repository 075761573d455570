"""Velocity and acceleration in a frequency band, from samples of a displacement, velocity or acceleration.

The edges of neighbouring bands are crossfades whose squares add up to one, so that the bands share out the power.
"""

from typing import NamedTuple

import numpy as np
from scipy.fft import next_fast_len
from scipy.signal import periodogram

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.decay_filters import LOWEST_FREQUENCY

RELATIVE_EDGE = 0.1
"""Half-width of the crossfade at the edge of a band over the frequency of the edge [-]."""

NARROWEST_EDGE_HZ = 0.15
"""Smallest half-width of a crossfade [Hz]; a narrower one would ring for more than some seconds."""

TAPER_S = 1.0
"""Length of the fade at the end of the samples, where the decay is cut off [s]."""

PADDING_S = 10.0
"""Rest behind the samples, so that a filter does not carry their end to their start [s]."""


class MotionBand(NamedTuple):
    """Frequency band [Hz] of a motion."""

    low: float
    high: float

    @property
    def text(self) -> str:
        """Edges with their unit."""
        return f"{self.low:g} to {self.high:g} Hz"


MOTION_BANDS = (
    MotionBand(LOWEST_FREQUENCY, 5.0),
    MotionBand(5.0, 20.0),
    MotionBand(20.0, 50.0),
    MotionBand(LOWEST_FREQUENCY, 20.0),
)
"""Compared bands: low, medium and high frequencies (Vo Van et al. 2015), and all up to 20 Hz."""

GRAPHIC_BAND = MOTION_BANDS[-1]
"""Band of curves and residual energies."""


def filter_motion(
    samples: RealArray, rate: float, derivatives: int, band: MotionBand, advance: float = 0.0
) -> RealArray:
    """Part of a motion in a frequency band, differentiated or integrated in time.

    Args:
        samples: Motion of c places, at rest at its start, (n, c).
        rate: Sampling rate [Hz].
        derivatives: Number of derivatives in time; negative: integrals.
        band: Frequency band.
        advance: Time by which the motion is advanced, also a part of a sample [s].

    Returns:
        Motion in the band, (n, c); the last `TAPER_S` is faded.
    """
    n = samples.shape[0]
    fade = min(round(TAPER_S * rate), n)
    tapered = np.array(samples, dtype=np.float64)
    tapered[n - fade :] *= (0.5 + 0.5 * np.cos(np.pi * (np.arange(fade) + 0.5) / fade))[:, None]
    length = next_fast_len(n + round(PADDING_S * rate), real=True)
    frequency: RealArray = np.asarray(np.fft.rfftfreq(length, 1 / rate), dtype=np.float64)
    gain = np.zeros(frequency.size, dtype=np.complex128)
    inside = frequency > 0
    omega = 2j * np.pi * frequency[inside]
    gain[inside] = band_gain(frequency[inside], band) * omega**derivatives * np.exp(omega * advance)
    return np.asarray(np.fft.irfft(gain[:, None] * np.fft.rfft(tapered, length, axis=0), length, axis=0)[:n])


def noise_rms(rest: RealArray, rate: float, derivatives: int, band: MotionBand) -> RealArray:
    """RMS of a motion at rest in a frequency band, by its spectral density.

    Args:
        rest: Samples of c places at rest, (n, c).
        rate: Sampling rate [Hz].
        derivatives: Number of derivatives in time; negative: integrals.
        band: Frequency band.

    Returns:
        RMS in the band, (c,).
    """
    frequency, density = periodogram(rest, rate, "hann", detrend="linear", axis=0)
    inside = frequency > 0
    gain = band_gain(frequency[inside], band) * (2 * np.pi * frequency[inside]) ** derivatives
    return np.asarray(np.sqrt(frequency[1] * (gain**2 @ density[inside])))


def band_gain(frequency: RealArray, band: MotionBand) -> RealArray:
    """Gain of a band at frequencies [Hz]: one inside, with crossfades at its edges."""
    return np.sqrt(_share_above(frequency, band.low) * (1 - _share_above(frequency, band.high)))


def _share_above(frequency: RealArray, edge: float) -> RealArray:
    """Share of the power above an edge: from zero to one across the crossfade."""
    width = max(RELATIVE_EDGE * edge, NARROWEST_EDGE_HZ)
    place = np.clip((frequency - edge) / (2 * width) + 0.5, 0.0, 1.0)
    return np.asarray(np.sin(0.5 * np.pi * place) ** 2)

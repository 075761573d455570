"""Irregularity of a contact wire: heights of its running surface that the statics of the line do not explain.

A pantograph feels the irregularity as an additional height of the wire. It is given as measured heights, or realised
from a power spectral density.
"""

from dataclasses import dataclass

import numpy as np

POINTS_PER_WAVELENGTH = 16
"""Points of a realised irregularity per shortest wavelength: its cubic spline is then accurate to 0.03 %."""


@dataclass(frozen=True)
class Irregularity:
    """Heights added to a contact wire under the pantographs.

    A cubic spline with horizontal ends joins the points; beyond them the height of the nearest end holds.
    """

    position: tuple[float, ...]
    """Positions in increasing order, at least two [m]."""
    height: tuple[float, ...]
    """Additional heights of the wire [m]."""


@dataclass(frozen=True)
class SpectralDensity:
    """One-sided power spectral density of heights along the track."""

    frequency: tuple[float, ...]
    """Spatial frequencies in increasing order, at least two; the density is zero outside of them [1/m]."""
    density: tuple[float, ...]
    """Density at each frequency, log-log interpolated between them [m3]."""


def realise_irregularity(spectrum: SpectralDensity, length: float, seed: int) -> Irregularity:
    """Realise heights over a line as a sum of cosines of the requested spectrum with random phases.

    The frequencies are the multiples of 1 / length; the amplitude of each is sqrt(2 S df), so that the spectrum of the
    realised heights is the requested one in every realisation (spectral representation, Shinozuka and Deodatis 1991).

    Args:
        spectrum: Requested density.
        length: Length of the line [m].
        seed: Seed of the phases; the raw values of the bit generator PCG64, which are the same in every version of
            numpy.

    Returns:
        Heights from 0 to `length`.
    """
    points = point_count(spectrum, length)
    frequency = np.arange(1, points // 2) / length
    requested = np.exp(np.interp(np.log(frequency), np.log(spectrum.frequency), np.log(spectrum.density)))
    inside = (spectrum.frequency[0] <= frequency) & (frequency <= spectrum.frequency[-1])
    amplitude = np.where(inside, np.sqrt(2 * requested / length), 0.0)
    phase = 2 * np.pi * np.random.PCG64(seed).random_raw(frequency.size) / 2.0**64
    height = np.fft.irfft(np.concatenate([[0.0], points / 2 * amplitude * np.exp(1j * phase)]), points)
    position = length * np.arange(points + 1) / points
    return Irregularity(tuple(position.tolist()), (*height.tolist(), float(height[0])))


def point_count(spectrum: SpectralDensity, length: float) -> int:
    """Number of intervals between the points of a realised irregularity over a length [m]; even."""
    return 2 * int(np.ceil(POINTS_PER_WAVELENGTH * spectrum.frequency[-1] * length / 2))

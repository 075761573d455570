"""Classical identification: one pole and residue for each peak of the spectrum, fitted over a few spectral lines.

The transform of a decay is read as a sum of R / (i w - lambda), like a frequency response. A peak is separate if it is
the highest of five spectral lines, the rule of five points in a half-power band. Each peak is fitted on its own, with
one pole for all modes below it and a constant for the others. The method is offered for comparison: users know it from
experimental modal analysis, and its poles are fewer than the modes of a line with groups of span modes.

References:
    [1] E. Balmes, Frequency domain identification of structural dynamics using the pole/residue parametrization, IMAC
        XIV (1996) 540-546.
"""

import numpy as np
import scipy

from pantocheck.conformance.core.array_types import ComplexArray, IntegerArray, RealArray
from pantocheck.conformance.drops.projection import DataBlock

PEAK_LINES = 5
"""Spectral lines of a peak and of its fit: the rule of five points."""
PEAK_OVER_MEDIAN = 10.0
"""Smallest power of a peak over the median of its surroundings [-]."""
SURROUNDINGS_HZ = 0.5
"""Reach of the surroundings on each side [Hz]."""


def find_classical_poles(data: list[DataBlock]) -> ComplexArray:
    """Find the pole of every peak in the spectra of records of one line, in the order of frequency (m,) [1/s].

    The peaks are those of the longest record; every record takes part in the fit of a peak.
    """
    longest = max(data, key=lambda block: block.duration)
    poles = [_fit_peak(data, float(omega)) for omega in longest.omega[find_peaks(longest)]]
    return np.array(sorted((pole for pole in poles if pole is not None), key=lambda pole: pole.imag), dtype=complex)


def find_peaks(block: DataBlock) -> IntegerArray:
    """Find the lines that are the highest of five, and higher than their surroundings, by index in the block."""
    power = spectral_power(block)
    reach = PEAK_LINES // 2
    highest = power == scipy.ndimage.maximum_filter1d(power, PEAK_LINES, mode="nearest")
    width = 2 * int(SURROUNDINGS_HZ * block.duration) + 1
    clear = power > PEAK_OVER_MEDIAN * scipy.ndimage.median_filter(power, min(width, 2 * power.size - 1))
    inside = np.arange(power.size)
    return np.flatnonzero(highest & clear & (inside >= reach) & (inside < power.size - reach))


def spectral_power(block: DataBlock) -> RealArray:
    """Power of all channels at each line, every channel with the same total power, (k,) [-]."""
    power = np.abs(block.spectrum) ** 2
    return np.asarray((power / power.sum(axis=0)).sum(axis=1))


def _fit_peak(data: list[DataBlock], omega: float) -> complex | None:
    """Pole with the least residual over the five lines nearest to a frequency [rad/s]; None if it does not decay."""
    parts = []
    for block in data:
        nearest = np.sort(np.argsort(np.abs(block.omega - omega), kind="stable")[:PEAK_LINES])
        scale = np.linalg.norm(block.spectrum[nearest], axis=0)
        parts.append((block.omega[nearest], block.spectrum[nearest] / np.where(scale > 0, scale, 1.0)))
    spacing = float(parts[0][0][1] - parts[0][0][0])

    def residual(parameters: RealArray) -> RealArray:
        pole = complex(-np.exp(parameters[0]), omega + spacing * parameters[1])
        left = [_remove_pole(spectrum, lines, pole) for lines, spectrum in parts]
        return np.concatenate([np.concatenate([rest.real.ravel(), rest.imag.ravel()]) for rest in left])

    found = scipy.optimize.least_squares(
        residual, [np.log(spacing / 2), 0.0], bounds=([np.log(1e-4 * spacing), -1.5], [np.log(10 * spacing), 1.5])
    )
    at_bound = np.any(found.active_mask != 0)
    return None if at_bound else complex(-np.exp(found.x[0]), omega + spacing * found.x[1])


def _remove_pole(spectrum: ComplexArray, omega: RealArray, pole: complex) -> ComplexArray:
    """Part of the spectra, (k, c), that a pole [1/s] and a constant do not explain."""
    columns = np.column_stack([1 / (1j * omega - pole), np.ones(omega.size)])
    basis, _ = np.linalg.qr(columns)
    return np.asarray(spectrum - basis @ (basis.conj().T @ spectrum))

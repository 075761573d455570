"""Likeness of the contact forces of two records: a measured run with small noise added to it is still a copy.

Two runs of a train differ: in the band from 20 to 50 Hz by the contact and the wear of the wire, and everywhere by more
than the noise of a force measurement. The thresholds are choices of this suite. A computed measurement by another
formulation with other damping, as in examples/dossier, has correlations up to 0.986 and residuals from 1.7 N on.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from pantocheck.conformance.comparison.force_difference import pair_forces
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.grading.assessed_record import AssessedRecord
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable

BAND_HZ = (20.0, 50.0)
"""Band in which independent runs agree least [Hz]."""

COPY_CORRELATION = 0.99
"""Largest correlation of independent runs in the band, at any shift."""

SMALLEST_RESIDUAL_N = 1.0
"""Smallest residual of independent runs up to 50 Hz, about the noise of a force measurement [N]."""


@dataclass(frozen=True)
class ForceLikeness:
    """Likeness of the forces of one pantograph in two records."""

    pantograph: int
    """Number of the pantograph."""
    correlation: float
    """Largest correlation from 20 to 50 Hz, over all shifts."""
    residual_N: float
    """RMS of the part of one force up to 50 Hz that the other one, shifted and scaled, does not explain [N]."""

    @property
    def is_copy(self) -> bool:
        """Whether one record can be made of the other."""
        return self.correlation > COPY_CORRELATION or self.residual_N < SMALLEST_RESIDUAL_N

    def describe(self) -> str:
        """Both numbers in one sentence part."""
        low, high = BAND_HZ
        return (
            f"the contact forces of pantograph {self.pantograph} have the correlation {self.correlation:.4f} from "
            f"{low:g} to {high:g} Hz and the residual {self.residual_N:.3g} N"
        )


def compare_likeness(first: AssessedRecord, second: AssessedRecord) -> ForceLikeness | None:
    """Largest likeness of a pantograph in two records; None if no force of both is known up to 50 Hz."""
    if first.prepared is None or second.prepared is None:
        return None
    found = []
    for number, signals in first.prepared.pantographs.items():
        other = second.prepared.pantographs.get(number)
        if other is None or min(signals.highest_frequency, other.highest_frequency) < BAND_HZ[1]:
            continue
        try:
            pair = pair_forces(signals, other, BAND_HZ[1])
        except QuantityUnavailable:
            continue
        band = scipy.signal.butter(4, BAND_HZ[0], "highpass", fs=pair.rate, output="sos")
        parts = (np.asarray(scipy.signal.sosfiltfilt(band, force)) for force in (pair.first, pair.second))
        whole = correlate_at_best(pair.first, pair.second)
        residual = float(np.std(pair.second)) * float(np.sqrt(max(1 - whole**2, 0.0)))
        found.append(ForceLikeness(number, correlate_at_best(*parts), residual))
    return max(found, key=lambda likeness: (likeness.is_copy, likeness.correlation), default=None)


def correlate_at_best(first: RealArray, second: RealArray) -> float:
    """Largest correlation of two series about their means over all shifts; 0 if one is constant.

    Args:
        first: Samples, (n,).
        second: Samples, (n,).
    """
    deviations = [series - series.mean() for series in (first, second)]
    norm = float(np.prod([np.linalg.norm(deviation) for deviation in deviations]))
    return float(scipy.signal.correlate(*deviations, method="fft").max() / norm) if norm > 0 else 0.0

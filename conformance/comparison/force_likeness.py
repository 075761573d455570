"""Likeness of the contact forces of two records: a measured run with small noise added to it is still a copy.

Two runs of a train differ: in the band from 20 to 50 Hz by the contact and the wear of the wire, and everywhere by more
than the noise of a force measurement. The thresholds are choices of this suite, from simulated passages over an
irregular wire (verification/tables/copy_thresholds.py, docs/validate.md).
"""

from dataclasses import dataclass

import numpy as np
import scipy

from pantocheck.conformance.comparison.force_difference import INTERPOLATION_RATE_HZ, pair_forces
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.grading.assessed_record import AssessedRecord
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.runs.force_content import find_likeness

BAND_HZ = (20.0, 50.0)
"""Band in which independent runs agree least [Hz]."""

COPY_CORRELATION = 0.99
"""Largest correlation of a simulated and a measured run in the band, at the best shift.

The simulated run does not know the irregularity of the measured one. A computed measurement by another formulation with
other damping, as in examples/dossier, has correlations up to 0.986 and residuals from 1.7 N on."""

REPEATED_CORRELATION = 0.9995
"""The same of two runs of one kind: they meet the same irregularity."""

SMALLEST_RESIDUAL_N = 1.0
"""Smallest residual of independent runs up to 50 Hz, about the noise of a force measurement [N]."""

LARGEST_SHIFT = 0.1
"""Largest shift of a copy, over the length of the common stretch."""


@dataclass(frozen=True)
class ForceLikeness:
    """Likeness of the forces of one pantograph in two records."""

    pantograph: int
    """Number of the pantograph."""
    correlation: float
    """Largest correlation from 20 to 50 Hz, over all shifts."""
    residual_N: float
    """RMS of the part of one force up to 50 Hz that the other one, shifted and scaled, does not explain [N]."""

    def exceeds(self, correlation: float) -> bool:
        """Whether one record can be made of the other: the likeness is above a correlation, or the residual small."""
        return self.correlation > correlation or self.residual_N < SMALLEST_RESIDUAL_N

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
    numbers = first.prepared.pantographs.keys() & second.prepared.pantographs.keys()
    pairs = ((n, first.prepared.pantographs[n], second.prepared.pantographs[n]) for n in sorted(numbers))
    found = [likeness for pair in pairs if (likeness := measure_likeness(*pair)) is not None]
    return max(found, key=lambda likeness: (likeness.correlation, -likeness.residual_N), default=None)


def measure_likeness(number: int, signals: PantographSignals, other: PantographSignals) -> ForceLikeness | None:
    """Likeness of the forces of one pantograph; None if they are not known up to 50 Hz, or over no common stretch.

    The middle of one force is searched in the other, so that a shifted copy is compared over its whole length.

    Args:
        number: Number of the pantograph.
        signals: Its signals in one record.
        other: Its signals in the other record.
    """
    if min(signals.highest_frequency, other.highest_frequency) < BAND_HZ[1]:
        return None
    try:
        pair = pair_forces(signals, other, BAND_HZ[1])
    except QuantityUnavailable:
        return None
    factor = int(np.ceil(INTERPOLATION_RATE_HZ / pair.rate))  # the best shift lies between samples
    forces = [scipy.signal.resample_poly(force, factor, 1, padtype="line") for force in (pair.first, pair.second)]
    band = scipy.signal.butter(4, BAND_HZ[0], "highpass", fs=factor * pair.rate, output="sos")
    upper = find_part(*(np.asarray(scipy.signal.sosfiltfilt(band, force)) for force in forces))
    residual = float(np.std(forces[0])) * find_part(*forces)
    return ForceLikeness(number, float(np.sqrt(1 - upper**2)), residual)


def find_part(first: RealArray, second: RealArray) -> float:
    """Remainder of the middle of a series beside the most alike part of another one, over its standard deviation [-].

    Args:
        first: Samples, (n,).
        second: Samples, (n,); shifts of up to a tenth of its length are searched.
    """
    cut = round(LARGEST_SHIFT * first.size)
    likeness = find_likeness(first[cut : first.size - cut], second)
    return 1.0 if likeness is None else min(likeness.remainder, 1.0)

"""Differences of the contact forces of two runs: by frequency band, by frequency, and along the spans."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.comparison.paired_forces import PairedForces
from pantocheck.conformance.quantities.bands import BANDS, band_rms
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.results.comparison_format import BandAgreement, SpanAgreement

SEGMENT_S = 1.0
"""Longest segment of the coherence [s]; it resolves 1 Hz."""

FEWEST_SEGMENTS = 4
"""Smallest number of segments of the coherence; with one segment every coherence is 1."""

PARTS_OF_SPAN = 24
"""Number of parts of a span in the profile along the span, as in the elasticity along a span."""


@dataclass(frozen=True)
class Coherence:
    """Magnitude-squared coherence of two forces."""

    frequency: RealArray
    """Frequencies, (n,) [Hz]."""
    value: RealArray
    """Coherence, 0 to 1, (n,)."""
    segments: int
    """Number of segments without overlap."""

    @property
    def chance_level(self) -> float:
        """Coherence that two independent signals exceed at 5 % of the frequencies.

        The estimate from n independent segments exceeds c with the probability (1 - c)^(n - 1) (Carter, Knapp and
        Nuttall 1973). The segments that overlap by half are not counted, so that the level is too high rather than
        too low.
        """
        return float(1 - 0.05 ** (1 / (self.segments - 1)))


@dataclass(frozen=True)
class SpanProfile:
    """Difference over the place in the span, 0 to 1: mean and RMS over all spans [N]."""

    place: RealArray
    mean: RealArray
    rms: RealArray


def compare_force_bands(forces: PairedForces) -> tuple[BandAgreement, ...]:
    """RMS values of the bands that both forces contain; the bands of `band_rms`."""
    compared = []
    for low, high, _ in BANDS:
        if high > forces.highest_Hz:
            continue
        try:
            first, other, difference = (
                band_rms(force, forces.rate, low, high) for force in (forces.first, forces.second, forces.difference)
            )
        except QuantityUnavailable:
            continue
        compared.append(BandAgreement(low_Hz=low, high_Hz=high, first_N=first, other_N=other, difference_N=difference))
    return tuple(compared)


def coherence(forces: PairedForces) -> Coherence:
    """Coherence from segments of up to 1 s with a Hann window, overlapping by half (Welch 1967)."""
    length = min(int(SEGMENT_S * forces.rate), forces.first.size // FEWEST_SEGMENTS)
    frequency, value = scipy.signal.coherence(
        forces.first, forces.second, fs=forces.rate, nperseg=length, noverlap=length // 2
    )
    inside = (frequency > 0) & (frequency <= forces.highest_Hz)
    return Coherence(frequency[inside], value[inside], forces.first.size // length)


def correlation(forces: PairedForces) -> float:
    """Correlation coefficient of the two forces about their means; 0 if one of them is constant."""
    deviations = [force - force.mean() for force in (forces.first, forces.second)]
    norms = [float(np.linalg.norm(deviation)) for deviation in deviations]
    return float(deviations[0] @ deviations[1] / np.prod(norms)) if min(norms) > 0 else 0.0


def compare_spans(forces: PairedForces, supports: Sequence[float]) -> tuple[SpanAgreement, ...]:
    """Differences in each span between two supports [m] inside the compared stretch."""
    compared = []
    for start, end in _find_spans(forces, supports):
        inside = slice(*np.searchsorted(forces.position, [start, end]))
        difference = forces.difference[inside]
        compared.append(
            SpanAgreement(
                start_m=start,
                end_m=end,
                mean_difference_N=float(difference.mean()),
                rms_difference_N=float(np.sqrt(np.mean(difference**2))),
                first_std_N=float(forces.first[inside].std()),
                other_std_N=float(forces.second[inside].std()),
            )
        )
    return tuple(compared)


def span_profile(forces: PairedForces, supports: Sequence[float]) -> SpanProfile | None:
    """Difference over the place in the span, joined over all spans; None without a complete span.

    A difference at one place of all spans comes from the line, for example from a dropper; a difference in one span
    comes from a disturbance.
    """
    places, differences = [np.zeros(0)], [np.zeros(0)]
    for start, end in _find_spans(forces, supports):
        inside = slice(*np.searchsorted(forces.position, [start, end]))
        places.append((forces.position[inside] - start) / (end - start))
        differences.append(forces.difference[inside])
    place, difference = np.concatenate(places), np.concatenate(differences)
    if place.size < PARTS_OF_SPAN:
        return None
    part = np.minimum((PARTS_OF_SPAN * place).astype(int), PARTS_OF_SPAN - 1)
    count = np.bincount(part, minlength=PARTS_OF_SPAN)
    if not count.all():
        return None
    mean = np.bincount(part, difference, PARTS_OF_SPAN) / count
    square = np.bincount(part, difference**2, PARTS_OF_SPAN) / count
    return SpanProfile((np.arange(PARTS_OF_SPAN) + 0.5) / PARTS_OF_SPAN, mean, np.sqrt(square))


def _find_spans(forces: PairedForces, supports: Sequence[float]) -> list[tuple[float, float]]:
    """Spans that lie completely inside the compared stretch [m]."""
    step = float(np.max(np.diff(forces.position)))
    first, last = forces.position[0] - step, forces.position[-1] + step
    return [(start, end) for start, end in pairwise(sorted(supports)) if start >= first and end <= last and end > start]

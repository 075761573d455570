"""Differences of the contact forces of two runs: by frequency band, by frequency, and along the spans."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import scipy

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.grading.assessed_record import AssessedRecord
from pantocheck.conformance.quantities.bands import BANDS, band_rms
from pantocheck.conformance.quantities.filters import needs_filter
from pantocheck.conformance.quantities.pantograph_signals import EXTENDED_CUTOFF_HZ, SHORTEST_PERIODS, PantographSignals
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable, SectionNotCovered
from pantocheck.conformance.results.comparison_format import BandAgreement, SpanAgreement
from pantocheck.conformance.runs.force_content import find_likeness

# Contact forces of two runs at the same positions along the track.
INTERPOLATION_RATE_HZ = 1000.0
"""Smallest sampling rate of a force that is interpolated [Hz]: a cubic spline through twenty samples per period
reproduces 50 Hz to 0.1 % (test)."""

FEWEST_PAIRED_SAMPLES = 32
"""Smallest number of samples of a record whose force is interpolated."""


@dataclass(frozen=True)
class PairedForces:
    """Contact forces of two runs, low-pass filtered alike, at the same positions; n values each."""

    position: RealArray
    """Positions along the track [m]."""
    first: RealArray
    second: RealArray
    """Contact forces [N]."""
    rate: float
    """Sampling rate of the run whose samples are used [Hz]."""
    highest_Hz: float
    """Frequency up to which both forces are known [Hz]."""

    @property
    def difference(self) -> RealArray:
        """Second minus first force [N]."""
        return self.second - self.first

    def select(self, start: float, end: float) -> "PairedForces":
        """Forces from a position on, and up to another one [m]."""
        inside = slice(*np.searchsorted(self.position, [start, end]))
        return replace(self, position=self.position[inside], first=self.first[inside], second=self.second[inside])


def pair_forces(
    first: PantographSignals, second: PantographSignals, cutoff_Hz: float = EXTENDED_CUTOFF_HZ
) -> PairedForces:
    """Interpolate the force with the lower sampling rate at the positions of the other.

    Args:
        first: Signals of a pantograph in one run.
        second: Signals of the same pantograph in the other run.
        cutoff_Hz: Highest cut-off of the filter of both forces [Hz].

    Returns:
        Forces over the stretch that belongs to both analysis sections.

    Raises:
        SectionNotCovered: The analysis sections have no common stretch of sufficient length.
    """
    highest = min(first.highest_frequency, second.highest_frequency, cutoff_Hz)
    finer, coarser = (first, second) if first.force.rate >= second.force.rate else (second, first)
    start, end = max(first.section[0], second.section[0]), min(first.section[1], second.section[1])
    inside = np.flatnonzero(
        (finer.position >= max(start, coarser.position[0])) & (finer.position < min(end, coarser.position[-1]))
    )
    if inside.size < max(FEWEST_PAIRED_SAMPLES, SHORTEST_PERIODS / highest * finer.force.rate):
        raise SectionNotCovered("the analysis sections have no common stretch of sufficient length")
    position = finer.position[inside]
    sampled = np.interp(position, *_filter(finer, highest))
    interpolated = np.asarray(scipy.interpolate.CubicSpline(*_filter(coarser, highest))(position))
    own, other = (sampled, interpolated) if finer is first else (interpolated, sampled)
    return PairedForces(position, own, other, finer.force.rate, highest)


def _filter(signals: PantographSignals, cutoff_Hz: float) -> tuple[RealArray, RealArray]:
    """Positions [m] and filtered force [N] of the whole record, with at least `INTERPOLATION_RATE_HZ`.

    A force with a lower rate gets more samples before the filter, whose gain near the cut-off depends on the rate.
    """
    delivered, rate = signals.force.delivered, signals.force.rate
    factor = int(np.ceil(INTERPOLATION_RATE_HZ / rate))
    # The last samples of the finer series lie behind the last sample of the record.
    force = scipy.signal.resample_poly(delivered, factor, 1, padtype="line")[: (delivered.size - 1) * factor + 1]
    position = np.interp(np.arange(force.size) / factor, np.arange(delivered.size), signals.position)
    low_pass = signals.force.low_pass.change_cutoff(cutoff_Hz)
    if needs_filter(low_pass, signals.filter_applied_Hz):
        force = low_pass(force, factor * rate)
    return position, force


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
        span = forces.select(start, end)
        compared.append(
            SpanAgreement(
                start_m=start,
                end_m=end,
                mean_difference_N=float(span.difference.mean()),
                rms_difference_N=float(np.sqrt(np.mean(span.difference**2))),
                first_std_N=float(span.first.std()),
                other_std_N=float(span.second.std()),
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
        span = forces.select(start, end)
        places.append((span.position - start) / (end - start))
        differences.append(span.difference)
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


# Likeness of the contact forces of two records: a measured run with small noise added to it is still a copy.
#
# Two runs of a train differ: in the band from 20 to 50 Hz by the contact and the wear of the wire, and everywhere by
# more than the noise of a force measurement. The thresholds are choices of this suite, from simulated passages over an
# irregular wire (verification/tables/copy_thresholds.py, docs/validate.md).


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
    """Likeness of two forces of one pantograph; None below a rate for 50 Hz, or without a common stretch.

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
    upper = measure_remainder(*(np.asarray(scipy.signal.sosfiltfilt(band, force)) for force in forces))
    residual = float(np.std(forces[0])) * measure_remainder(*forces)
    return ForceLikeness(number, float(np.sqrt(1 - upper**2)), residual)


def measure_remainder(first: RealArray, second: RealArray) -> float:
    """Remainder of the middle of a series beside the most alike part of another one, over its standard deviation [-].

    Args:
        first: Samples, (n,).
        second: Samples, (n,); shifts of up to a tenth of its length are searched.
    """
    cut = round(LARGEST_SHIFT * first.size)
    likeness = find_likeness(first[cut : first.size - cut], second)
    return 1.0 if likeness is None else min(likeness.remainder, 1.0)

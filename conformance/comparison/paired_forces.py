"""Contact forces of two runs at the same positions along the track."""

from dataclasses import dataclass, replace

import numpy as np
import scipy

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.filters import needs_filter
from pantocheck.conformance.quantities.force_signals import EXTENDED_CUTOFF_HZ
from pantocheck.conformance.quantities.pantograph_signals import SHORTEST_PERIODS, PantographSignals
from pantocheck.conformance.quantities.unavailable import SectionNotCovered

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
    low_pass = replace(signals.force.low_pass, cutoff_Hz=cutoff_Hz)
    if needs_filter(low_pass, signals.filter_applied_Hz):
        force = low_pass(force, factor * rate)
    return position, force

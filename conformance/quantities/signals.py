"""Signals of a pantograph and of the line, from which quantities are computed."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.bands import EXTENDED_BAND, band_part, band_rms
from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE, LowPass, needs_filter
from pantocheck.conformance.quantities.unavailable import (
    BandNotObservable,
    ChannelMissing,
    SectionNotCovered,
    SupportsMissing,
)

EXTENDED_CUTOFF_HZ = float(EXTENDED_BAND.high)
"""Upper edge of the extended band [Hz]."""

SHORTEST_PERIODS = 4
"""Shortest analysis section, in periods of the cut-off frequency; a shorter one has no meaningful statistics."""

SETTLING_PERIODS = 2.0
"""Periods of the cut-off after which the filter transient at the end of a record has decayed."""

SUPPORT_TOLERANCE_M = 0.5
"""Largest distance between the stated and the real position of a support [m].

Positions are rounded, and surveyed with an accuracy of some decimetres. A span is at least ten times as long, so that
supports are not confused. A support at this distance outside the analysis section still belongs to the section."""

RUN_OUT_M = 5.0
"""Distance that every pantograph runs beyond a support, so that the record contains the largest uplift there [m].

In simulation and measurement, the uplift is largest when a pantograph is within some decimetres of the support."""

UPLIFT_STRETCH_M = 60.0
"""Distance of the last pantograph beyond a support up to which the uplift there counts [m].

Reflections and speeds near the wave speed move the largest uplift by tens of metres. Uplift beyond this distance does
not count, so that it may be missing."""


class ForceSignals(Protocol):
    """Signals of one pantograph over the analysis section; a missing signal raises `QuantityUnavailable`."""

    @property
    def filter_applied_Hz(self) -> float | None:
        """Cut-off of the low-pass filter applied before delivery [Hz]; None: unfiltered."""

    @property
    def delivered(self) -> RealArray:
        """Contact force as delivered [N]."""

    @property
    def graded(self) -> RealArray:
        """Contact force after the filter of the case [N]."""

    @property
    def extended(self) -> RealArray:
        """Contact force after the same kind of filter at 50 Hz [N]."""

    @property
    def height(self) -> RealArray:
        """Height of the contact point [m]."""

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""

    @property
    def has_arcs(self) -> bool:
        """Whether the record has an arc detector for this pantograph."""

    @property
    def arcs(self) -> tuple[RealArray, RealArray] | None:
        """Arcs, and time under load, as 1, 0 or NaN for a missing value; None without an arc detector."""

    @property
    def shortest_loss_s(self) -> float | None:
        """Shortest duration of a long contact loss [s]; None if it is not stated."""

    def band(self, low: float, high: float) -> float:
        """RMS of the contact force in the band ]low, high] Hz [N]."""

    def band_part(self, low: float, high: float) -> RealArray:
        """Contact force in the band ]low, high] Hz [N]."""


@dataclass(frozen=True)
class ForceChannel:
    """Contact force of one pantograph over the whole record, as delivered and filtered.

    The whole record is filtered, so that the filter transients at its ends lie outside the analysis section.

    Parameters
    ----------
    delivered : (n,) ndarray
        Contact force as delivered [N].
    rate : float
        Sampling rate [Hz].
    low_pass : LowPass
        Filter of the graded force.
    filter_applied_Hz : float or None
        Cut-off of the low-pass filter applied before delivery [Hz]; None: unfiltered.
    """

    delivered: RealArray
    rate: float
    low_pass: LowPass
    filter_applied_Hz: float | None = None

    @cached_property
    def graded(self) -> RealArray:
        """Force filtered once by the filter of the case [N]."""
        return self._filter_once(self.low_pass)

    @cached_property
    def extended(self) -> RealArray:
        """Force filtered once by the same kind of filter at 50 Hz [N]."""
        return self._filter_once(replace(self.low_pass, cutoff_Hz=EXTENDED_CUTOFF_HZ))

    def _filter_once(self, low_pass: LowPass) -> RealArray:
        return low_pass(self.delivered, self.rate) if needs_filter(low_pass, self.filter_applied_Hz) else self.delivered


@dataclass(frozen=True)
class PantographSignals:
    """Signals of one pantograph: channels of the whole record, cut to the analysis section.

    Parameters
    ----------
    position : (n,) ndarray
        Contact point along the track [m].
    force : ForceChannel
        Contact force of the whole record.
    section : tuple of float
        Start (included) and end (excluded) of the analysis section [m].
    contact_height : (n,) ndarray or None
        Height of the contact point [m], or None.
    arc_channels : (2, n) ndarray or None
        Arcs, and time under load, as 1, 0 or NaN; None without an arc detector.
    shortest_loss_s : float or None
        Shortest duration of a long contact loss [s]; None if it is not stated.
    """

    position: RealArray
    force: ForceChannel
    section: tuple[float, float]
    contact_height: RealArray | None = None
    arc_channels: RealArray | None = None
    shortest_loss_s: float | None = None

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.force.rate

    @property
    def has_arcs(self) -> bool:
        """Whether the record has an arc detector for this pantograph."""
        return self.arc_channels is not None

    @property
    def arcs(self) -> tuple[RealArray, RealArray] | None:
        """Arcs and time under load over the analysis section, as 1, 0 or NaN; None without an arc detector."""
        if self.arc_channels is None:
            return None
        return self.arc_channels[0][self.inside], self.arc_channels[1][self.inside]

    @property
    def filter_applied_Hz(self) -> float | None:
        """Cut-off of the low-pass filter applied before delivery [Hz]; None: unfiltered."""
        return self.force.filter_applied_Hz

    @property
    def highest_frequency(self) -> float:
        """Frequency up to which the force is known [Hz], at most 50 Hz."""
        return min(EXTENDED_CUTOFF_HZ, HIGHEST_SHARE_OF_RATE * self.force.rate, self.filter_applied_Hz or np.inf)

    @cached_property
    def inside(self) -> slice:
        """Samples inside the analysis section.

        Raises
        ------
        SectionNotCovered
            The record begins after the start or ends before the end of the section.
        """
        start, end = self.section
        # One sample of tolerance: a section that ends with the record ends between two samples.
        step = float(np.max(np.diff(self.position)))
        if self.position[0] > start + step or self.position[-1] < end - step:
            raise SectionNotCovered(
                f"the record covers {self.position[0]:.6g} m to {self.position[-1]:.6g} m, "
                f"but the analysis section extends from {start:g} m to {end:g} m"
            )
        first, last = np.searchsorted(self.position, [start - 1e-9, end - 1e-9])
        return slice(int(first), int(last))

    @property
    def delivered(self) -> RealArray:
        """Contact force as delivered, over the analysis section [N]."""
        return self.force.delivered[self.inside]

    @property
    def graded(self) -> RealArray:
        """Contact force after the filter of the case (0-20 Hz), over the analysis section [N]."""
        self._check_duration(self.force.low_pass.cutoff_Hz)
        return self.force.graded[self.inside]

    @property
    def extended(self) -> RealArray:
        """Contact force after the same kind of filter at 50 Hz, over the analysis section [N]."""
        self._check_duration(EXTENDED_CUTOFF_HZ)
        return self.force.extended[self.inside]

    def band(self, low: float, high: float) -> float:
        """RMS of the contact force in the band ]low, high] Hz, over the analysis section [N]."""
        return band_rms(self.delivered, self.force.rate, low, high, self.filter_applied_Hz)

    def band_part(self, low: float, high: float) -> RealArray:
        """Contact force in the band ]low, high] Hz, over the analysis section [N]."""
        return band_part(self.delivered, self.force.rate, low, high)

    def _check_duration(self, cutoff_Hz: float) -> None:
        duration, shortest = self.delivered.size / self.force.rate, SHORTEST_PERIODS / cutoff_Hz
        if duration < shortest:
            raise BandNotObservable(
                f"the analysis section lasts {duration:.3g} s; "
                f"statistics up to {cutoff_Hz:g} Hz need at least {shortest:g} s"
            )

    @property
    def height(self) -> RealArray:
        """Height of the contact point over the analysis section [m].

        Raises
        ------
        ChannelMissing
            The record has no contact height.
        """
        if self.contact_height is None:
            raise ChannelMissing("the record has no contact height")
        return self.contact_height[self.inside]


def edge_warnings(pantographs: Mapping[int, PantographSignals], speed: float) -> list[str]:
    """Warnings on pantographs whose record is too short for the filter to settle outside the analysis section.

    Parameters
    ----------
    pantographs : mapping of int to PantographSignals
        Signals of the pantographs by number from 1.
    speed : float
        Speed of the train [m/s].
    """
    warnings = []
    for number, signals in pantographs.items():
        settling = SETTLING_PERIODS / signals.force.low_pass.cutoff_Hz * speed
        start, end = signals.section
        if signals.position[0] > start - settling or signals.position[-1] < end + settling:
            warnings.append(
                f"the record of pantograph {number} begins or ends less than {settling:.1f} m outside the analysis "
                "section: transients of the filter reach into the section"
            )
    return warnings


@dataclass(frozen=True)
class LineSignals:
    """Uplift of the contact wire at the supports.

    Parameters
    ----------
    section : tuple of float
        Start and end of the analysis section [m].
    support_position : (s,) ndarray or None
        Positions of the supports along the track [m], or None.
    support_uplift : (s, n) ndarray or None
        Uplift at each support [m], or None; NaN where it is not known.
    line_supports : tuple of float or None
        Positions of all supports of the line [m]; None if they are not known.
    last_position : (n,) ndarray or None
        Positions of the last pantograph [m]; None if they are not known.
    """

    section: tuple[float, float]
    support_position: RealArray | None = None
    support_uplift: RealArray | None = None
    line_supports: tuple[float, ...] | None = None
    last_position: RealArray | None = None

    @property
    def supports(self) -> RealArray:
        """Positions of the k supports of the analysis section, both ends included, (k,) [m]; errors as in `uplift`."""
        return self._at_supports[0]

    @property
    def uplift(self) -> RealArray:
        """Uplift at the k supports of the analysis section, both ends included, (k, n) [m]; NaN after the passage.

        Raises
        ------
        ChannelMissing
            The record has no uplift, none inside the analysis section, or values are missing that count.
        """
        return self._at_supports[1]

    @property
    def largest_uplift(self) -> float:
        """Largest uplift that counts at any of these supports [m]; errors as in `uplift`."""
        return float(self.uplift[self.largest_uplift_index])

    @property
    def largest_uplift_index(self) -> tuple[int, int]:
        """Support and sample of the largest uplift that counts, indices of `uplift`; errors as in `uplift`."""
        counted = counted_samples(self.supports, self.uplift, self.last_position)
        support, sample = np.unravel_index(np.argmax(np.where(counted, self.uplift, -np.inf)), counted.shape)
        return int(support), int(sample)

    def check_supports(self) -> None:
        """Check that every support of the analysis section has an uplift.

        Raises
        ------
        SupportsMissing
            A support has no uplift, the supports of the line are not known, or the record ends too early behind the
            last support: the largest uplift may be missing in the record.
        """
        measured = self.supports
        if self.line_supports is None:
            raise SupportsMissing(
                "the record does not state span_m, the length of the longest span, "
                "so that the supports of the analysis section are not known"
            )
        line = np.asarray(self.line_supports, dtype=np.float64)
        expected = line[supports_inside(line, self.section)]
        distance = np.abs(expected[:, None] - measured).min(axis=1)
        missing = expected[~(distance <= SUPPORT_TOLERANCE_M)]
        if missing.size:
            places = ", ".join(f"{position:g} m" for position in missing[:5])
            raise SupportsMissing(
                f"the record has no uplift at {missing.size} of {expected.size} supports of the analysis section: "
                f"{places}{', ...' if missing.size > 5 else ''}"
            )
        end = np.inf if self.last_position is None else float(self.last_position[-1])
        if not end >= measured.max() + RUN_OUT_M:
            raise SupportsMissing(
                f"the record ends at {end:.6g} m; for the largest uplift of the support at {measured.max():g} m "
                f"it must extend to {measured.max() + RUN_OUT_M:g} m"
            )

    @cached_property
    def _at_supports(self) -> tuple[RealArray, RealArray]:
        if self.support_position is None or self.support_uplift is None:
            raise ChannelMissing("the record has no uplift at supports")
        # A passing pantograph lifts the wire at every support; an exactly constant channel is that of a dead sensor.
        known = np.isfinite(self.support_uplift)
        lowest, highest = (np.where(known, self.support_uplift, limit) for limit in (np.inf, -np.inf))
        moves = highest.max(axis=1) > lowest.min(axis=1)
        inside = supports_inside(self.support_position, self.section) & moves
        if not inside.any():
            start, end = self.section
            raise ChannelMissing(f"the record has no uplift at a support between {start:g} m and {end:g} m")
        supports, uplift = self.support_position[inside], self.support_uplift[inside]
        gaps = has_gaps(supports, uplift, self.last_position)
        if gaps.any():
            places = ", ".join(f"{position:g} m" for position in supports[gaps][:5])
            raise SupportsMissing(
                f"the uplift is incomplete at {gaps.sum()} of {gaps.size} supports of the analysis section: "
                f"{places}{', ...' if gaps.sum() > 5 else ''}; it must be known until the last pantograph is "
                f"{UPLIFT_STRETCH_M:g} m past the support"
            )
        return supports, uplift


def counted_samples(supports: RealArray, uplift: RealArray, last_position: RealArray | None) -> NDArray[np.bool_]:
    """Samples whose uplift counts, (s, n): from the start until the last pantograph is far enough past the support.

    Parameters
    ----------
    supports : (s,) ndarray
        Positions of the supports [m].
    uplift : (s, n) ndarray
        Uplift at the supports [m].
    last_position : (n,) ndarray or None
        Positions of the last pantograph [m]; None: every sample counts.
    """
    if last_position is None:
        return np.ones(uplift.shape, dtype=np.bool_)
    return np.asarray(last_position <= supports[:, None] + UPLIFT_STRETCH_M)


def has_gaps(supports: RealArray, uplift: RealArray, last_position: RealArray | None) -> NDArray[np.bool_]:
    """Whether values that count are missing at each support, (s,); parameters as of `counted_samples`."""
    return np.asarray((~np.isfinite(uplift) & counted_samples(supports, uplift, last_position)).any(axis=1))


def supports_inside(supports: RealArray, section: tuple[float, float]) -> NDArray[np.bool_]:
    """Whether each support lies inside a section, both ends included; positions [m]."""
    start, end = section
    return (supports >= start - SUPPORT_TOLERANCE_M) & (supports <= end + SUPPORT_TOLERANCE_M)

"""Contact force of one pantograph, from which quantities are computed."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.bands import (
    BANDS,
    EXTENDED_BAND,
    band_part,
    check_band,
    compute_power,
    sum_lines,
)
from pantocheck.conformance.quantities.filters import HIGHEST_SHARE_OF_RATE, Filter, needs_filter
from pantocheck.conformance.quantities.unavailable import (
    AlreadyFiltered,
    BandNotObservable,
    ChannelMissing,
    SectionNotCovered,
)

EXTENDED_CUTOFF_HZ = float(EXTENDED_BAND.high)
"""Upper edge of the extended band [Hz]."""


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
    """

    delivered: RealArray
    """Contact force as delivered, (n,) [N]."""
    rate: float
    """Sampling rate [Hz]."""
    low_pass: Filter
    """Filter of the graded force."""
    filter_applied_Hz: float | None = None
    """Cut-off of the low-pass filter applied before delivery [Hz]; None: unfiltered."""
    _bands: dict[tuple[float, float], RealArray] = field(default_factory=dict, init=False, repr=False, compare=False)

    def band_pass(self, low: float, high: float) -> RealArray:
        """Force behind the band-pass of the case from `low` to `high` [Hz], filtered once per band [N].

        Raises:
            AlreadyFiltered: The force was filtered in the band before delivery; a second filter attenuates it twice.
        """
        band_filter = self.low_pass.change_cutoff(high)
        if not needs_filter(band_filter, self.filter_applied_Hz):
            raise AlreadyFiltered(
                f"the force was low-pass filtered at {self.filter_applied_Hz:g} Hz before delivery; "
                f"a band-pass up to {high:g} Hz needs the unfiltered force"
            )
        if (low, high) not in self._bands:
            self._bands[low, high] = band_filter(self.delivered, self.rate, low)
        return self._bands[low, high]

    @cached_property
    def graded(self) -> RealArray:
        """Force filtered once by the filter of the case [N]."""
        return self._filter_once(self.low_pass)

    @cached_property
    def extended(self) -> RealArray:
        """Force filtered once by the same kind of filter at 50 Hz [N]."""
        return self._filter_once(self.low_pass.change_cutoff(EXTENDED_CUTOFF_HZ))

    def _filter_once(self, low_pass: Filter) -> RealArray:
        return low_pass(self.delivered, self.rate) if needs_filter(low_pass, self.filter_applied_Hz) else self.delivered


# Channels of one pantograph, cut to the analysis section.
SHORTEST_PERIODS = 4
"""Shortest analysis section, in periods of the cut-off frequency; a shorter one has no meaningful statistics."""

SETTLING_PERIODS = 2.0
"""Periods of the cut-off after which the filter transient at the end of a record has decayed."""


@dataclass(frozen=True)
class PantographSignals:
    """Signals of one pantograph: channels of the whole record, cut to the analysis section."""

    position: RealArray
    """Contact point along the track, (n,) [m]."""
    force: ForceChannel
    """Contact force of the whole record."""
    section: tuple[float, float]
    """Start (included) and end (excluded) of the analysis section [m]."""
    contact_height: RealArray | None = None
    """Height of the contact point, (n,) [m], or None."""
    arc_channels: RealArray | None = None
    """Arcs, and time under load, as 1, 0 or NaN, (2, n); None without an arc detector."""
    shortest_loss_s: float | None = None
    """Shortest duration of a long contact loss [s]; None if it is not stated."""
    front_strip: RealArray | None = None
    """Contact force of the front strip as delivered, (n,) [N]; the rear one has the rest; None: not recorded."""

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

        Raises:
            SectionNotCovered: The record begins after the start or ends before the end of the section, or the section
                lies between two samples.
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
        if first >= last:
            raise SectionNotCovered(f"no sample lies in the analysis section from {start:g} m to {end:g} m")
        return slice(int(first), int(last))

    @property
    def delivered(self) -> RealArray:
        """Contact force as delivered, over the analysis section [N]."""
        return self.force.delivered[self.inside]

    @property
    def strip_forces(self) -> tuple[RealArray, ...]:
        """Contact forces of front and rear strip over the analysis section [N]; empty if they are not recorded."""
        if self.front_strip is None:
            return ()
        front = self.front_strip[self.inside]
        return front, self.delivered - front

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
        check_band(self.delivered.size / self.force.rate, self.force.rate, low, high, self.filter_applied_Hz)
        if self.force.low_pass.bands == "spectral lines":
            return sum_lines(*self._lines, low, high)
        return float(self.band_part(low, high).std())

    @cached_property
    def _lines(self) -> tuple[RealArray, RealArray]:
        """Frequencies [Hz] and powers [N2] of the spectral lines over the analysis section, for all bands."""
        return compute_power(self.delivered, self.force.rate)

    def band_part(self, low: float, high: float) -> RealArray:
        """Contact force in the band ]low, high] Hz, over the analysis section, without its mean [N]."""
        if self.force.low_pass.bands == "spectral lines":
            return band_part(self.delivered, self.force.rate, low, high)
        part = self.force.band_pass(low, high)[self.inside]
        return np.asarray(part - part.mean())

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

        Raises:
            ChannelMissing: The record has no contact height.
        """
        if self.contact_height is None:
            raise ChannelMissing("the record has no contact height")
        return self.contact_height[self.inside]


def edge_warnings(pantographs: Mapping[int, PantographSignals], speed: float) -> list[str]:
    """Warnings on pantographs whose record is too short for the filter to settle outside the analysis section.

    Args:
        pantographs: Signals of the pantographs by number from 1.
        speed: Speed of the train [m/s].
    """
    warnings = []
    for number, signals in pantographs.items():
        low_pass = signals.force.low_pass
        lowest = low_pass.cutoff_Hz if low_pass.bands == "spectral lines" else min(low_pass.cutoff_Hz, BANDS[0].high)
        settling = SETTLING_PERIODS / lowest * speed
        start, end = signals.section
        if signals.position[0] > start - settling or signals.position[-1] < end + settling:
            warnings.append(
                f"the record of pantograph {number} begins or ends less than {settling:.1f} m outside the analysis "
                "section: transients of the filter reach into the section"
            )
    return warnings

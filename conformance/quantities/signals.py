"""Signals that quantities are computed from: one pantograph's, and the line's."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.bands import EXTENDED_BAND, band_rms
from pantocheck.conformance.quantities.filters import LowPass, filter_force
from pantocheck.conformance.quantities.unavailable import BandNotObservable, ChannelMissing, StretchNotCovered

EXTENDED_CUTOFF_HZ = float(EXTENDED_BAND.high)
"""Upper edge of the extended band [Hz]."""

SHORTEST_PERIODS = 4
"""Periods of the cut-off frequency that the evaluated stretch must last: less is not a statistic."""


class ForceSignals(Protocol):
    """What a quantity of a pantograph is computed from; each raises `QuantityUnavailable` if there is no such thing."""

    @property
    def filter_applied_Hz(self) -> float | None:
        """Cut-off of a low-pass the force has been through [Hz]; None: unfiltered."""

    @property
    def delivered(self) -> RealArray:
        """Force as delivered, over what is evaluated [N]."""

    @property
    def graded(self) -> RealArray:
        """Force through the case's filter [N]."""

    @property
    def extended(self) -> RealArray:
        """Force through the same kind of filter at 50 Hz [N]."""

    @property
    def height(self) -> RealArray:
        """Height of the contact point [m]."""

    def band(self, low: float, high: float) -> float:
        """Rms of the force in the band ]low, high] Hz [N]."""


@dataclass(frozen=True)
class PantographSignals:
    """What one pantograph delivers over the whole record, and the part of it that is evaluated.

    The force is filtered over the whole record and cut to the evaluated stretch afterwards, so that the transients of
    the filter at the ends of the record stay outside the stretch.

    Parameters
    ----------
    rate : float
        Samples per second [Hz].
    position : (n,) ndarray
        Contact point along the track [m].
    force : (n,) ndarray
        Contact force as delivered [N].
    evaluated : tuple[float, float]
        Start and end of the evaluated stretch [m]; the end itself is outside.
    low_pass : LowPass
        Filter of the graded force.
    filter_applied_Hz : float or None
        Cut-off of a low-pass the force has been through [Hz]; None: unfiltered.
    contact_height : (n,) ndarray or None
        Height of the contact point [m], or None.
    """

    rate: float
    position: RealArray
    force: RealArray
    evaluated: tuple[float, float]
    low_pass: LowPass
    filter_applied_Hz: float | None = None
    contact_height: RealArray | None = None

    @cached_property
    def inside(self) -> slice:
        """Samples inside the evaluated stretch.

        Raises
        ------
        StretchNotCovered
            The record starts after the beginning, or stops before the end of the stretch.
        """
        start, end = self.evaluated
        # One sample of tolerance: a stretch that ends with the record ends between two samples.
        step = float(np.max(np.diff(self.position)))
        if self.position[0] > start + step or self.position[-1] < end - step:
            raise StretchNotCovered(
                f"the record covers {self.position[0]:.6g} m to {self.position[-1]:.6g} m; "
                f"the evaluated stretch is {start:g} m to {end:g} m"
            )
        first, last = np.searchsorted(self.position, [start - 1e-9, end - 1e-9])
        return slice(int(first), int(last))

    @property
    def delivered(self) -> RealArray:
        """Force as delivered, over the evaluated stretch [N]."""
        return self.force[self.inside]

    @cached_property
    def graded(self) -> RealArray:
        """Force through the case's filter (0-20 Hz), over the evaluated stretch [N]."""
        return self._through(self.low_pass)

    @cached_property
    def extended(self) -> RealArray:
        """Force through the same kind of filter at 50 Hz, over the evaluated stretch [N]."""
        return self._through(replace(self.low_pass, cutoff_Hz=EXTENDED_CUTOFF_HZ))

    def band(self, low: float, high: float) -> float:
        """Rms of the force in the band ]low, high] Hz, over the evaluated stretch [N]."""
        return band_rms(self.delivered, self.rate, low, high, self.filter_applied_Hz)

    def _through(self, low_pass: LowPass) -> RealArray:
        duration = self.delivered.size / self.rate
        shortest = SHORTEST_PERIODS / low_pass.cutoff_Hz
        if duration < shortest:
            raise BandNotObservable(
                f"statistics up to {low_pass.cutoff_Hz:g} Hz need at least {shortest:g} s; "
                f"the evaluated stretch lasts {duration:.3g} s"
            )
        return filter_force(self.force, self.rate, low_pass, self.filter_applied_Hz)[self.inside]

    @property
    def height(self) -> RealArray:
        """Height of the contact point over the evaluated stretch [m].

        Raises
        ------
        ChannelMissing
            The record has no contact height.
        """
        if self.contact_height is None:
            raise ChannelMissing("the record has no contact height")
        return self.contact_height[self.inside]


@dataclass(frozen=True)
class LineSignals:
    """Uplift of the contact wire at the supports over the whole record.

    Parameters
    ----------
    evaluated : tuple[float, float]
        Start and end of the evaluated stretch [m].
    support_position : (s,) ndarray or None
        [m], or None.
    support_uplift : (s, n) ndarray or None
        [m], or None.
    """

    evaluated: tuple[float, float]
    support_position: RealArray | None = None
    support_uplift: RealArray | None = None

    @property
    def uplift(self) -> RealArray:
        """(k, n) uplift [m] at the k supports of the evaluated spans, the two at its ends included.

        Raises
        ------
        ChannelMissing
            The record has no uplift, or none inside the evaluated stretch.
        """
        if self.support_position is None or self.support_uplift is None:
            raise ChannelMissing("the record has no uplift at supports")
        start, end = self.evaluated
        inside = (self.support_position >= start - 1e-6) & (self.support_position <= end + 1e-6)
        if not inside.any():
            raise ChannelMissing(f"the record has no support between {start:g} m and {end:g} m")
        return self.support_uplift[inside]

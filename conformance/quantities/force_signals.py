"""Contact force of one pantograph, from which quantities are computed."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.bands import EXTENDED_BAND
from pantocheck.conformance.quantities.filters import LowPass, needs_filter

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
    low_pass: LowPass
    """Filter of the graded force."""
    filter_applied_Hz: float | None = None
    """Cut-off of the low-pass filter applied before delivery [Hz]; None: unfiltered."""

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

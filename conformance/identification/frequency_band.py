"""Frequency band of an identification."""

from dataclasses import dataclass


@dataclass(frozen=True)
class FrequencyBand:
    """Band of the reported modes, and the margins that filters and fit need above it.

    Parameters
    ----------
    low, high : float
        Edges of the band of the reported modes [Hz].
    fitted : float
        Upper edge of the fit [Hz]; the margin keeps the effects of the edge away from the reported modes.
    stop : float
        Lower edge of the stop band of the low-pass [Hz].
    """

    low: float = 0.3
    high: float = 10.0
    fitted: float = 11.0
    stop: float = 14.0

    @classmethod
    def up_to(cls, high: float, rate: float, low: float = 0.3) -> "FrequencyBand":
        """Band up to a frequency [Hz], or to a lower one if the sampling rate [Hz] requires it."""
        stop = min(high + 4.0, 0.45 * rate)
        fitted = min(high + 1.0, 0.78 * stop)
        return cls(low, min(high, 0.92 * fitted), fitted, stop)

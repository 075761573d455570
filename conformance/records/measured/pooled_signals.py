"""Signals of several usable sections of a record, evaluated as one."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.signals import PantographSignals
from pantocheck.conformance.quantities.unavailable import SectionNotCovered


class NothingLeft(SectionNotCovered):
    """No section of the record can be evaluated, so that it has no statistics."""


@dataclass(frozen=True)
class PooledSignals:
    """Signals of one pantograph over several sections, each filtered on its own.

    Parameters
    ----------
    parts : tuple of PantographSignals
        Signals of the sections in running order.
    why_none : str
        Reason shown to the reader if there are no sections.
    """

    parts: tuple[PantographSignals, ...]
    why_none: str = ""

    @property
    def filter_applied_Hz(self) -> float | None:
        """Cut-off of the low-pass filter applied before delivery [Hz]; None: unfiltered."""
        return self._present()[0].filter_applied_Hz

    @property
    def delivered(self) -> RealArray:
        """Contact force as delivered, section after section [N]."""
        return np.concatenate([part.delivered for part in self._present()])

    @cached_property
    def graded(self) -> RealArray:
        """Contact force after the filter (0-20 Hz) [N]."""
        return np.concatenate([part.graded for part in self._present()])

    @cached_property
    def extended(self) -> RealArray:
        """Contact force after the same kind of filter at 50 Hz [N]."""
        return np.concatenate([part.extended for part in self._present()])

    @property
    def position(self) -> RealArray:
        """Contact point along the track [m]."""
        return np.concatenate([part.position[part.inside] for part in self._present()])

    @property
    def height(self) -> RealArray:
        """Height of the contact point [m]."""
        return np.concatenate([part.height for part in self._present()])

    def band(self, low: float, high: float) -> float:
        """RMS of the force in a band [N]; differences between the means of the sections belong to the lowest band."""
        sizes = np.array([part.delivered.size for part in self._present()], dtype=np.float64)
        powers = np.array([part.band(low, high) ** 2 for part in self.parts])
        power = float(np.average(powers, weights=sizes))
        if low == 0:
            means = np.array([part.delivered.mean() for part in self.parts])
            power += float(np.average((means - np.average(means, weights=sizes)) ** 2, weights=sizes))
        return float(np.sqrt(power))

    @property
    def seconds(self) -> float:
        """Total duration of the sections [s]."""
        return sum(part.delivered.size / part.force.rate for part in self.parts)

    def _present(self) -> tuple[PantographSignals, ...]:
        if not self.parts:
            raise NothingLeft(self.why_none)
        return self.parts

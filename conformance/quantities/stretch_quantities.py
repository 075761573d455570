"""Quantities outside of the overlaps of tension sections: statements beside those of the whole analysis section.

The force is filtered once over the whole record; the samples inside the overlaps are then left out. Bands and contact
heights need one uninterrupted stretch and have no such statement.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.force_quantities import PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.force_signals import ForceChannel
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.quantities.quantity import Need, Quantity
from pantocheck.conformance.quantities.sampling import WHOLE_RECORD
from pantocheck.conformance.quantities.unavailable import BandNotObservable, ChannelMissing, QuantityUnavailable

Stretch = tuple[float, float]
"""Start and end of a stretch of track [m, m]."""

_STATED = ("mean_force_N", "std_force_N", "std_force_50_N", "max_force_N", "min_force_N", "contact_loss_pct")


def name_outside_overlaps(name: str) -> str:
    """Name of a quantity outside of the overlaps; its unit stays at the end."""
    stem, _, unit = name.rpartition("_")
    return f"{stem}_outside_overlaps_{unit}"


OVERLAP_QUANTITIES: tuple[Quantity, ...] = tuple(
    Quantity(
        name=name_outside_overlaps(quantity.name),
        label=f"{quantity.label}, outside of overlaps",
        unit=quantity.unit,
        definition=f"{quantity.definition}, without the samples inside overlaps of tension sections",
        needs=Need("a line with several tension sections"),
        scope="pantograph",
        never_negative=quantity.never_negative,
    )
    for quantity in PANTOGRAPH_QUANTITIES
    if quantity.name in _STATED
)


@dataclass(frozen=True)
class SignalsOutside:
    """Signals of one pantograph over the analysis section without overlaps or other stretches."""

    whole: PantographSignals
    """Signals over the analysis section."""
    stretches: Sequence[Stretch]
    """Stretches that are left out."""

    @cached_property
    def kept(self) -> NDArray[np.bool_]:
        """Whether each sample of the analysis section lies outside of all stretches, (n,)."""
        position = self.whole.position[self.whole.inside]
        inside = [(start <= position) & (position < end) for start, end in self.stretches]
        kept = ~np.any(inside, axis=0)
        if not kept.any():
            raise ChannelMissing("the whole analysis section lies inside overlaps or excluded stretches")
        return np.asarray(kept)

    @property
    def force(self) -> ForceChannel:
        """Contact force of the whole record."""
        return self.whole.force

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.whole.rate

    @property
    def has_arcs(self) -> bool:
        """Whether the record has an arc detector for this pantograph."""
        return self.whole.has_arcs

    @property
    def arcs(self) -> tuple[RealArray, RealArray] | None:
        """Arcs and time under load, as 1, 0 or NaN; None without an arc detector."""
        arcs = self.whole.arcs
        return None if arcs is None else (arcs[0][self.kept], arcs[1][self.kept])

    @property
    def shortest_loss_s(self) -> float | None:
        """Shortest duration of a long contact loss [s]; None if it is not stated."""
        return self.whole.shortest_loss_s

    @property
    def filter_applied_Hz(self) -> float | None:
        """Cut-off of the low-pass filter applied before delivery [Hz]; None: unfiltered."""
        return self.whole.filter_applied_Hz

    @property
    def delivered(self) -> RealArray:
        """Contact force as delivered [N]."""
        return self.whole.delivered[self.kept]

    @property
    def graded(self) -> RealArray:
        """Contact force after the filter of the case [N]."""
        return self.whole.graded[self.kept]

    @property
    def extended(self) -> RealArray:
        """Contact force after the same kind of filter at 50 Hz [N]."""
        return self.whole.extended[self.kept]

    @property
    def height(self) -> RealArray:
        """Height of the contact point [m]."""
        return self.whole.height[self.kept]

    def band(self, low: float, high: float) -> float:
        """Not available: a band needs one uninterrupted stretch."""
        raise BandNotObservable(f"the band {low:g}-{high:g} Hz needs one uninterrupted stretch")

    def band_part(self, low: float, high: float) -> RealArray:
        """Not available: a band needs one uninterrupted stretch."""
        raise BandNotObservable(f"the band {low:g}-{high:g} Hz needs one uninterrupted stretch")


def evaluate_outside_overlaps(
    pantographs: Mapping[int, PantographSignals], overlaps: Sequence[Stretch]
) -> tuple[dict[int, dict[str, float]], dict[int, dict[str, str]]]:
    """Evaluate the quantities outside of the overlaps.

    Args:
        pantographs: Signals of the pantographs by number from 1.
        overlaps: Overlaps of the line.

    Returns:
        values: Values by pantograph and name; none if no overlap lies in the analysis section.
        skipped: Reasons why the others are not available.
    """
    values: dict[int, dict[str, float]] = {number: {} for number in pantographs}
    skipped: dict[int, dict[str, str]] = {number: {} for number in pantographs}
    for number, whole in pantographs.items():
        if not any(start < whole.section[1] and end > whole.section[0] for start, end in overlaps):
            continue
        outside = SignalsOutside(whole, overlaps)
        for quantity in PANTOGRAPH_QUANTITIES:
            if quantity.name in _STATED:
                try:
                    quantity.needs.check(outside)
                    value = float(quantity.compute(outside, WHOLE_RECORD))
                    values[number][name_outside_overlaps(quantity.name)] = value
                except QuantityUnavailable as reason:
                    skipped[number][name_outside_overlaps(quantity.name)] = str(reason)
    return values, skipped

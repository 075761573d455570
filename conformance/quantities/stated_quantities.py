"""Quantities of a pantograph that need further facts: they are evaluated where these facts are stated.

The arc share NQ after EN 50317 is the time with arcs over the time with a current above 30 % of the nominal current.
The definition is known from secondary sources; the document itself was not read.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.contact_losses import loss_durations
from pantocheck.conformance.quantities.force_quantities import FORCE_50, PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, ForceSignals, PantographSignals
from pantocheck.conformance.quantities.quantity import Need, PantographQuantity, Quantity
from pantocheck.conformance.quantities.statistics import WHOLE_RECORD, Sampling, check_unfiltered
from pantocheck.conformance.quantities.unavailable import BandNotObservable, ChannelMissing, QuantityUnavailable


def _complete_arcs(signals: ForceSignals) -> tuple[RealArray, RealArray]:
    """Arcs and load without missing values, (n,)."""
    if signals.arcs is None:
        raise ChannelMissing("the record has no arc detector")
    arcing, loaded = signals.arcs
    if not np.isfinite(arcing).all():
        raise ChannelMissing("values of the arc detector are missing in the analysis section")
    if not np.isfinite(loaded).all():
        raise ChannelMissing(
            "the current is not known over the whole analysis section: the arc share needs the time with a current "
            "above 30 % of the nominal current"
        )
    return arcing, loaded


ARCS = Need[ForceSignals]("arc detector and current over the whole analysis section", _complete_arcs)


def _arc_share(signals: ForceSignals, sampling: Sampling) -> RealArray:
    arcing, loaded = _complete_arcs(signals)
    if not loaded.any():
        raise ChannelMissing("the current is never above 30 % of the nominal current")
    with np.errstate(divide="ignore", invalid="ignore"):  # replicates without load
        return np.asarray(100 * sampling.mean(arcing * loaded) / sampling.mean(loaded))


def _long_loss(signals: ForceSignals, sampling: Sampling) -> RealArray:
    shortest = signals.shortest_loss_s
    if shortest is None:
        raise ChannelMissing("the profile states no shortest duration of a contact loss")
    # A duration is a multiple of the sampling interval, with rounding.
    check_unfiltered(signals.filter_applied_Hz)
    return sampling.percentage(loss_durations(signals.delivered, signals.rate) >= shortest * (1 - 1e-9))


LONG_LOSS = PantographQuantity(
    name="long_contact_loss_pct",
    label="Contact loss in long losses",
    unit="%",
    definition="share of the samples of the unfiltered force in contact losses of at least the duration that the "
    "profile states (shortest_contact_loss_s)",
    needs=FORCE_50,
    never_negative=True,
    compute=_long_loss,
)

ARC_SHARE = PantographQuantity(
    name="arc_share_pct",
    label="Arc share NQ",
    unit="%",
    definition="time with arcs and a current above 30 % of the nominal current, over the time with such a current",
    needs=ARCS,
    source="EN 50317, by secondary sources",
    never_negative=True,
    compute=_arc_share,
)

STATED_QUANTITIES: tuple[PantographQuantity, ...] = (LONG_LOSS, ARC_SHARE)


def list_stated(signals: ForceSignals) -> Iterator[PantographQuantity]:
    """Quantities of `STATED_QUANTITIES` for which the signals state the facts."""
    if signals.shortest_loss_s is not None:
        yield LONG_LOSS
    if signals.has_arcs:
        yield ARC_SHARE


# Quantities outside of the overlaps of tension sections: statements beside those of the whole analysis section.
#
# The force is filtered once over the whole record; the samples inside the overlaps are then left out. Bands and contact
# heights need one uninterrupted stretch and have no such statement.
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
        raise _build_band_error(low, high)

    def band_part(self, low: float, high: float) -> RealArray:
        """Not available, as `band`."""
        raise _build_band_error(low, high)


def _build_band_error(low: float, high: float) -> BandNotObservable:
    needed = f"the band {low:g}-{high:g} Hz needs one uninterrupted stretch"
    return BandNotObservable(f"{needed}; overlaps or excluded stretches divide this record")


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

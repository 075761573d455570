"""Quantities of a pantograph that need further facts: they are evaluated where these facts are stated.

The arc share NQ after EN 50317 is the time with arcs over the time with a current above 30 % of the nominal current.
The definition is known from secondary sources; the document itself was not read.
"""

from collections.abc import Iterator

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.contact_losses import loss_durations
from pantocheck.conformance.quantities.force_quantities import FORCE_50
from pantocheck.conformance.quantities.force_signals import ForceSignals
from pantocheck.conformance.quantities.quantity import Need, PantographQuantity
from pantocheck.conformance.quantities.sampling import Sampling
from pantocheck.conformance.quantities.statistics import check_unfiltered
from pantocheck.conformance.quantities.unavailable import ChannelMissing


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

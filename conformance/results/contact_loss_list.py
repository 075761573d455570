"""Contact losses of a record in results.json."""

from collections.abc import Mapping

from pantocheck.conformance.quantities.contact_losses import list_losses
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.results.case_facts_format import ContactLossFacts

MOST_LOSSES = 200
"""Largest number of contact losses listed for a pantograph; the longest ones are kept."""


def build_contact_losses(pantographs: Mapping[int, PantographSignals]) -> dict[str, list[ContactLossFacts]] | None:
    """Contact losses of every pantograph with an unfiltered force, in the order of their places; None without any.

    Args:
        pantographs: Signals of the pantographs by number from 1.
    """
    losses = {}
    for number, signals in pantographs.items():
        try:
            position, force = signals.position[signals.inside], signals.delivered
        except QuantityUnavailable:
            continue
        if signals.filter_applied_Hz is not None:
            continue
        found = list_losses(force, position, signals.rate)
        longest = sorted(sorted(found, key=lambda loss: -loss.duration)[:MOST_LOSSES], key=lambda loss: loss.place)
        if longest:
            losses[str(number)] = [
                ContactLossFacts(
                    position_m=loss.place, time_s=loss.time, duration_s=loss.duration, lowest_force_N=loss.lowest_force
                )
                for loss in longest
            ]
    return losses or None

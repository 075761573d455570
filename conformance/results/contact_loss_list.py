"""Contact losses of a record in results.json."""

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from pantocheck.conformance.quantities.contact_losses import list_losses
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.results.results_part import ResultsPart

MOST_LOSSES = 200
"""Largest number of contact losses listed for a pantograph; the longest ones are kept."""


class ContactLossFacts(ResultsPart):
    """Contact loss of a pantograph in its unfiltered force."""

    position_m: Annotated[float, Field(description="position of the pantograph at the start of the loss [m]")]
    time_s: Annotated[float, Field(description="time from the start of the analysis section [s]")]
    duration_s: float
    lowest_force_N: float


def build_contact_losses(pantographs: Mapping[int, PantographSignals]) -> dict[str, list[ContactLossFacts]] | None:
    """Contact losses of every pantograph with an unfiltered force, in the order of their places; None without any.

    Parameters
    ----------
    pantographs : mapping of int to PantographSignals
        Signals of the pantographs by number from 1.
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

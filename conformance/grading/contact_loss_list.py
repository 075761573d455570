"""Contact losses of a record in results.json, and the places of its extremes."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import ExtremePlace
from pantocheck.conformance.quantities.contact_losses import list_losses
from pantocheck.conformance.quantities.line_signals import LineSignals
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


# Places where the extremes of the force and of the uplift occur.
FORCE_EXTREMES: dict[str, Callable[[RealArray], np.intp]] = {"max_force_N": np.argmax, "min_force_N": np.argmin}
"""Quantities that are extremes of the graded force."""

UPLIFT_EXTREME = "max_uplift_at_support_mm"


def find_force_places(pantographs: Mapping[int, PantographSignals]) -> dict[str, dict[str, ExtremePlace]]:
    """Place of each extreme of the graded force, by pantograph and quantity.

    Args:
        pantographs: Signals of the pantographs by number from 1; one without a graded force has no places.
    """
    places = {}
    for number, signals in pantographs.items():
        try:
            force, position = signals.graded, signals.position[signals.inside]
        except QuantityUnavailable:
            continue
        places[str(number)] = {
            name: ExtremePlace(position_m=float(position[find(force)])) for name, find in FORCE_EXTREMES.items()
        }
    return places


def find_uplift_place(line: LineSignals, time: NDArray[np.float64]) -> dict[str, dict[str, ExtremePlace]]:
    """Place of the largest uplift at a support, under the key of the line; empty if the uplift is not known.

    Args:
        line: Uplift at the supports.
        time: Times of the record, (n,) [s].
    """
    try:
        line.check_supports()
        support, sample = line.largest_uplift_index
    except QuantityUnavailable:
        return {}
    place = ExtremePlace(position_m=float(line.supports[support]), time_s=float(time[sample]))
    return {"0": {UPLIFT_EXTREME: place}}

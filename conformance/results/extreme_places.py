"""Places where the extremes of the force and of the uplift occur."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.results.figure_data import ExtremePlace

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

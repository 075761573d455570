"""Description of the search for the model order: which poles are stable from one order to the next."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import ComplexArray
from pantocheck.conformance.identification.identification_format import BandOrders, OrderSearch, SearchStep
from pantocheck.conformance.identification.identify import PoleSearch
from pantocheck.conformance.identification.repeatability import round_curve
from pantocheck.conformance.identification.start_poles import BandTrials

STABLE_FREQUENCY, STABLE_DAMPING = 0.001, 0.1
"""Largest relative changes of frequency and damping ratio of a stable pole from one order to the next [-]."""


def describe_search(search: PoleSearch) -> OrderSearch:
    """Frequencies and stability of the poles of all orders, and the poles after each step."""
    return OrderSearch(
        bands=tuple(_describe_band(band) for band in search.trials),
        steps=tuple(SearchStep(name=name, frequency_Hz=round_curve(_frequency(poles))) for name, poles in search.steps),
    )


def _describe_band(band: BandTrials) -> BandOrders:
    before = (np.zeros(0, dtype=np.complex128), *band.poles)
    stable = [_are_stable(poles, previous) for previous, poles in pairwise(before)]
    return BandOrders(
        from_Hz=band.low,
        to_Hz=band.high,
        selected_order=band.selected,
        order=tuple(order for order, poles in enumerate(band.poles, 1) for _ in poles),
        frequency_Hz=round_curve(_frequency(np.concatenate(before))),
        stable=tuple(bool(value) for values in stable for value in values),
    )


def _are_stable(poles: ComplexArray, previous: ComplexArray) -> NDArray[np.bool_]:
    """Whether each pole has a counterpart among those of the order before."""
    near = np.abs(np.abs(poles)[:, None] / np.abs(previous) - 1) < STABLE_FREQUENCY
    damping, other = (-p.real / np.abs(p) for p in (poles, previous))
    return np.asarray((near & (np.abs(damping[:, None] - other) < STABLE_DAMPING * other)).any(axis=1))


def _frequency(poles: ComplexArray) -> NDArray[np.float64]:
    return np.asarray(np.abs(poles) / (2 * np.pi), dtype=np.float64)

"""Place of a run along its track: a wrong kilometre or clock shifts its force against that of the other passages."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.network.span_comparison import GRID_M

TILE_M, LARGEST_OFFSET_M = 1000.0, 2000.0
"""Stretch that is compared, and largest offset that is searched [m]."""

PLACED_WITHIN_M = 10.0
"""Largest offset that is not a finding [m]."""

SAME_OFFSET_M = 5.0
"""Largest difference of the offsets of neighbouring stretches that are one finding [m]."""

AGREEING, FOREIGN = 0.5, 0.25
"""Correlation from which an offset is believed, and below which a run is that of another place [-].

Without a common cause, the largest correlation of 1 km over all offsets is about 0.2: some 500 independent values.
"""


@dataclass(frozen=True)
class PlaceOffset:
    """Stretch of a passage at another place than the others."""

    first: int
    last: int
    """Samples of the grid."""
    offset_m: float | None
    """Place of the passage less that of the others; None: it agrees with them nowhere."""
    agreement: float
    """Largest correlation [-]."""


def find_offsets(rest: RealArray, others: RealArray, usual: float) -> list[PlaceOffset]:
    """Stretches of a passage that are displaced against the mean of the others; neighbouring ones are joined.

    Args:
        rest: Difference of the passage from its neighbouring spans on the grid; NaN where it is not known.
        others: Mean difference of the other passages.
        usual: Median correlation of the passages with each other [-].
    """
    found: list[PlaceOffset] = []
    for part in _compare_tiles(rest, others):
        displaced = part.offset_m is not None and abs(part.offset_m) > PLACED_WITHIN_M and part.agreement >= AGREEING
        foreign = part.agreement < FOREIGN and usual >= AGREEING
        if not displaced and not foreign:
            continue
        here = PlaceOffset(part.first, part.last, None if foreign else part.offset_m, part.agreement)
        before = found[-1] if found and found[-1].last == here.first else None
        if before is not None and _is_same(before.offset_m, here.offset_m):
            agreement = min(before.agreement, here.agreement)
            found[-1] = PlaceOffset(before.first, here.last, before.offset_m, agreement)
        else:
            found.append(here)
    return found


def measure_agreement(rest: RealArray, others: RealArray) -> float:
    """Median of the largest correlations of the stretches of a passage with the mean of the others [-]; else 0."""
    return float(np.median([part.agreement for part in _compare_tiles(rest, others)] or [0.0]))


def _is_same(one: float | None, other: float | None) -> bool:
    if one is None or other is None:
        return one is other
    return abs(one - other) <= SAME_OFFSET_M


def _compare_tiles(rest: RealArray, others: RealArray) -> Iterator[PlaceOffset]:
    size, reach = round(TILE_M / GRID_M), round(LARGEST_OFFSET_M / GRID_M)
    mean = np.pad(np.nan_to_num(others), reach)
    for first in range(0, rest.size - size // 2, size):
        tile = np.nan_to_num(rest[first : first + size])
        if np.count_nonzero(tile) < size // 2:
            continue
        near = mean[first : first + tile.size + 2 * reach]
        energy = np.maximum(scipy.signal.fftconvolve(near**2, np.ones(tile.size), "valid"), 1e-9)
        least = 0.5 * tile.size * float(np.mean(near[near != 0] ** 2)) if near.any() else 1.0
        product = scipy.signal.correlate(near, tile, "valid")
        correlation = product / np.sqrt(np.maximum(energy, least) * (tile @ tile))
        best = int(np.argmax(correlation))
        yield PlaceOffset(first, first + tile.size, GRID_M * (reach - best), float(correlation[best]))

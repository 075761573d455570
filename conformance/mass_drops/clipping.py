"""Clipping: flat tops of a signal from a saturated amplifier."""

import numpy as np

from pantocheck.conformance.array_types import RealArray

SAME_EXTREMES = 4
"""Number of consecutive samples with exactly the extreme value that make a flat top."""


def find_clipping(signal: RealArray) -> list[tuple[int, int]]:
    """Find the flat tops of a saturated amplifier, as intervals [start, end) of samples.

    A converter repeats its extreme values also in a signal of noise alone; those lie near the median and do not count.
    """
    middle, reach = np.median(signal), 0.2 * np.ptp(signal)
    return [top for top in _find_flat_tops(signal) if abs(signal[top[0]] - middle) > reach]


def _find_flat_tops(signal: RealArray) -> list[tuple[int, int]]:
    """Intervals [start, end) of samples with exactly the maximum or minimum of the signal."""
    tops = []
    for extreme in {float(signal.max()), float(signal.min())}:
        edges = np.flatnonzero(np.diff(np.concatenate([[False], signal == extreme, [False]]).astype(np.int8)))
        tops += [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a >= SAME_EXTREMES]
    return sorted(tops)

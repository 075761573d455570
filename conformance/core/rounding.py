"""Rounding to significant digits."""

import numpy as np

from pantocheck.conformance.core.array_types import RealArray

NEAR_TIE = 1e-3
"""Distance from a tie, or share beyond a power of ten, within which a text decides the last digit [-]."""

LARGEST_EXPONENT = 20
"""Largest power of ten by which numbers are scaled: powers up to 1e22 are exact."""


def round_digits(numbers: RealArray, digits: int) -> list[float]:
    """Numbers with so many significant digits: the floats of their texts.

    An integer times or over an exact power of ten is rounded once, as the float of a text is.
    """
    size = np.abs(numbers)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        place = digits - 1 - np.floor(np.log10(size))
        factor = 10.0 ** np.minimum(np.abs(place), LARGEST_EXPONENT)
        scaled = np.where(place < 0, numbers / factor, numbers * factor)
        whole = np.round(scaled)
        rounded = np.where(place < 0, whole * factor, whole / factor)
        tie = np.abs(np.abs(scaled - whole) - 0.5) < NEAR_TIE
        low, high = 10.0 ** (digits - 1), 10.0**digits
        inside = (np.abs(scaled) > low * (1 + NEAR_TIE)) & (np.abs(whole) < high) & (np.abs(place) <= LARGEST_EXPONENT)
    for i in np.flatnonzero(tie | ~inside):
        rounded[i] = float(f"{float(numbers[i]):.{digits}g}")
    found: list[float] = rounded.tolist()
    return found

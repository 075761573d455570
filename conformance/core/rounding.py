"""Rounding to significant digits."""

from pantocheck.conformance.core.array_types import RealArray


def round_digits(numbers: RealArray, digits: int) -> list[float]:
    """Numbers with so many significant digits: the floats of their texts."""
    return [float(f"{number:.{digits}g}") for number in numbers.tolist()]

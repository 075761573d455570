"""Rounding of derived values."""

from collections.abc import Iterable

DIGITS = 6
"""Significant digits of derived values; the elements leave an error in the sixth."""
DECIMALS = 9
"""Decimals of derived values, so that rounding errors of a zero do not appear."""
POSITION_DECIMALS = 6
"""Decimals of positions along the track in metres."""


def round_number(value: float) -> float:
    """Value with `DIGITS` significant digits."""
    return round(float(f"{value:.{DIGITS}g}"), DECIMALS) + 0.0  # -0.0 becomes 0.0


def round_numbers(values: Iterable[float]) -> tuple[float, ...]:
    """Values with `DIGITS` significant digits."""
    return tuple(map(round_number, values))


def round_positions(positions: Iterable[float]) -> tuple[float, ...]:
    """Positions along the track with `POSITION_DECIMALS` decimals [m]."""
    return tuple(round(float(x), POSITION_DECIMALS) for x in positions)

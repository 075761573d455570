"""Numbers of the derived values: their types and their rounding."""

from collections.abc import Iterable
from typing import Annotated, TypeVar

from pydantic import Field

Entry = TypeVar("Entry")

DIGITS = 6
"""Significant digits of derived values; the elements leave an error in the sixth."""
DECIMALS = 9
"""Decimals of derived values, so that rounding errors of a zero do not appear."""
POSITION_DECIMALS = 6
"""Decimals of positions along the track in metres."""

Numbers = Annotated[tuple[float, ...], Field(strict=False)]
BySpan = Annotated[tuple[Numbers, ...], Field(strict=False)]
BySupport = float | Numbers

MassCoefficient = Annotated[
    float, Field(description="damper to the ground over mass, of every lumped mass of this table [1/s]")
]
StiffnessCoefficient = Annotated[float, Field(description="damper over stiffness, of the springs of this table [s]")]


def join_equal(values: Iterable[Entry]) -> Entry | tuple[Entry, ...]:
    """One value if all are equal, or else all values."""
    listed = tuple(values)
    return listed if len(set(listed)) != 1 else listed[0]


def round_number(value: float) -> float:
    """Value with `DIGITS` significant digits."""
    return round(float(f"{value:.{DIGITS}g}"), DECIMALS) + 0.0  # -0.0 becomes 0.0


def round_numbers(values: Iterable[float]) -> tuple[float, ...]:
    """Values with `DIGITS` significant digits."""
    return tuple(map(round_number, values))


def round_position(position: float) -> float:
    """Position along the track with `POSITION_DECIMALS` decimals [m]."""
    return round(float(position), POSITION_DECIMALS)


def round_positions(positions: Iterable[float]) -> tuple[float, ...]:
    """Positions along the track with `POSITION_DECIMALS` decimals [m]."""
    return tuple(map(round_position, positions))

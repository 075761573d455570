"""Base of every part of results.json, and its numbers."""

from collections.abc import Sequence
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

LARGEST_RESULT = 1e15
"""Largest absolute value of a number in results.json."""

FiniteNumber = Annotated[float, Field(ge=-LARGEST_RESULT, le=LARGEST_RESULT)]

Number = FiniteNumber | list[FiniteNumber]


def select_item(value: float | Sequence[float] | None, item: int | None) -> float | None:
    """Item of a quantity with several values, by default the first; None if there is none."""
    if not isinstance(value, Sequence):
        return value
    index = (item or 1) - 1
    return value[index] if 0 <= index < len(value) else None


def select_single(value: Number | None) -> float | None:
    """Value of a quantity that has one; None for a list of values, and for no value."""
    return None if isinstance(value, list) else value


def is_empty(value: object) -> bool:
    """Whether a list has no item: its key is missing in the file then."""
    return value == []


Owner = Annotated[str, Field(pattern="^[0-9]{1,2}$", description="number of a pantograph, 0: the line")]


class ResultsPart(BaseModel):
    """Part of results.json: numbers are finite, unknown keys are rejected."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)


# Suite in the files that it writes.
class Suite(ResultsPart):
    """Suite that graded the system."""

    version: str
    commit: str | None
    digest: str
    """SHA-256 of the installed files of the suite."""

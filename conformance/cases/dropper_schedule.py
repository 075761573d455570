"""Dropper schedule: positions, planned pre-sags and published lengths of the droppers of one span."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated

from pydantic import Field, model_validator

from pantocheck.conformance.input_files.sourced_table import (
    InputTable,
    NumberList,
    PositiveList,
    validation_problem,
)

DropperPositions = Annotated[PositiveList, Field(description="positions from the start of the span, increasing [m]")]
DropperPresags = Annotated[
    NumberList | None, Field(description="planned pre-sag of the contact wire at each dropper [m]; default: 0")
]
DropperLengths = Annotated[
    PositiveList | None, Field(description="published length of each dropper, for comparison [m]")
]


class DropperSchedule(InputTable):
    """Droppers of one span."""

    x_m: DropperPositions
    presag_m: DropperPresags = None
    length_m: DropperLengths = None

    @model_validator(mode="after")
    def _consistent(self) -> "DropperSchedule":
        check_schedule(self.x_m, {"presag_m": self.presag_m, "length_m": self.length_m})
        return self


def check_schedule(positions: Sequence[float], lists: dict[str, tuple[float, ...] | None]) -> None:
    """Check that positions increase, and that every other list has one value per position.

    Parameters
    ----------
    positions : sequence of float
        Positions of the droppers [m].
    lists : dict of str to tuple of float or None
        Further values of the droppers by key; None: not given.

    Raises
    ------
    PydanticCustomError
        A position does not increase, or a list has another number of values.
    """
    for i, (before, x) in enumerate(pairwise(positions), 2):
        if x <= before:
            raise validation_problem(
                f"x_m[{i}]",
                f"{x:g} m is not greater than the preceding {before:g} m",
                "List the droppers in the direction of travel.",
            )
    for key, values in lists.items():
        if values is not None and len(values) != len(positions):
            raise validation_problem(
                key, f"{len(values)} values for {len(positions)} droppers", "Give one value per dropper of x_m."
            )

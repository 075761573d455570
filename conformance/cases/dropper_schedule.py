"""Dropper schedule: positions, planned pre-sags and published lengths of the droppers of one span."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated

from pydantic import Field

from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
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

    @cross_check
    def _consistent(self) -> Problems:
        yield from find_schedule_problems(self.x_m, {"presag_m": self.presag_m, "length_m": self.length_m})


def find_schedule_problems(positions: Sequence[float], lists: dict[str, tuple[float, ...] | None]) -> Problems:
    """Problems of a schedule: positions increase, and every other list has one value per position.

    Parameters
    ----------
    positions : sequence of float
        Positions of the droppers [m].
    lists : dict of str to tuple of float or None
        Further values of the droppers by key; None: not given.

    Yields
    ------
    PydanticCustomError
        A position that does not increase, or a list with another number of values.
    """
    for i, (before, x) in enumerate(pairwise(positions), 2):
        if x <= before:
            yield validation_problem(
                f"x_m[{i}]",
                f"{x:g} m is not greater than the preceding {before:g} m",
                "List the droppers in the direction of travel.",
            )
    for key, values in lists.items():
        if values is not None and len(values) != len(positions):
            yield validation_problem(
                key, f"{len(values)} values for {len(positions)} droppers", "Give one value per dropper of x_m."
            )

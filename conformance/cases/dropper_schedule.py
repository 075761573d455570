"""Dropper schedule: positions, heights of the contact wire and published lengths of the droppers of one span."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated

import numpy as np
from pydantic import Field

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.features import NO_FEATURE, Feature
from pantocheck.conformance.input_files.sourced_table import (
    InputTable,
    NumberList,
    PositiveList,
    is_absent,
    validation_problem,
)

DropperPositions = Annotated[PositiveList, Field(description="positions from the start of the span, increasing [m]")]
DropperPresags = Annotated[
    NumberList | None,
    Field(description="planned pre-sag of the contact wire at each dropper [m]; default: 0"),
    Feature("presag", lambda heights: any(heights or ())),
]
DropperHeights = Annotated[
    NumberList | None,
    Field(
        description="height of the contact wire at each dropper above the datum of the line, as surveyed, in place of "
        "presag_m [m]",
        exclude_if=is_absent,
    ),
    Feature("surveyed_wire_heights"),
]
DropperLengths = Annotated[
    PositiveList | None, Field(description="published length of each dropper, for comparison [m]"), NO_FEATURE
]


class DropperSchedule(InputTable):
    """Droppers of one span."""

    x_m: DropperPositions
    presag_m: DropperPresags = None
    contact_wire_height_m: DropperHeights = None
    length_m: DropperLengths = None

    @cross_check
    def _consistent(self) -> Problems:
        yield from find_schedule_problems(self.x_m, self.presag_m, self.contact_wire_height_m, self.length_m)

    def prescribed_heights(self, chord: RealArray) -> RealArray:
        """Heights of the contact wire at the droppers [m], above the datum.

        Parameters
        ----------
        chord : (n,) ndarray
            Heights of the straight line between the supports at the droppers [m].
        """
        if self.contact_wire_height_m is not None:
            return np.array(self.contact_wire_height_m)
        return np.asarray(chord - np.array(self.presag_m or (0.0,) * len(self.x_m)))


def find_schedule_problems(
    positions: Sequence[float],
    presags: Sequence[float] | None,
    heights: Sequence[float] | None,
    lengths: Sequence[float] | None,
) -> Problems:
    """Problems of a schedule: positions increase, every list has one value per position, heights are given once.

    Parameters
    ----------
    positions : sequence of float
        Positions of the droppers [m].
    presags, heights, lengths : sequence of float or None
        Further values of the droppers; None: not given [m].

    Yields
    ------
    PydanticCustomError
        A position that does not increase, a list with another number of values, or pre-sags beside heights.
    """
    if presags is not None and heights is not None:
        yield validation_problem(
            "contact_wire_height_m",
            "the height of the contact wire is given twice",
            "Give either presag_m or contact_wire_height_m.",
        )
    lists = {"presag_m": presags, "contact_wire_height_m": heights, "length_m": lengths}
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

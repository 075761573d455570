"""Schedule of the droppers of one span."""

from itertools import pairwise
from typing import Annotated

import numpy as np
from pydantic import Field

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.features import NO_FEATURE, Feature
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NumberList,
    PositiveList,
    Problems,
    cross_check,
    is_absent,
    validation_problem,
)


class DropperSchedule(InputTable):
    """Droppers of one span."""

    x_m: PositiveList
    """Positions from the start of the span, increasing [m]."""
    presag_m: Annotated[NumberList | None, Feature("presag", lambda heights: any(heights or ()))] = None
    """Planned pre-sag of the contact wire at each dropper [m]; default: 0."""
    contact_wire_height_m: Annotated[
        NumberList | None, Field(exclude_if=is_absent), Feature("surveyed_wire_heights")
    ] = None
    """Height of the contact wire at each dropper above the datum of the line, as surveyed, in place of presag_m [m]."""
    length_m: Annotated[PositiveList | None, NO_FEATURE] = None
    """Published length of each dropper, for comparison [m]."""

    @cross_check
    def _check_schedule(self) -> Problems:
        """Positions increase, every list has one value per position, and heights are given once."""
        if self.presag_m is not None and self.contact_wire_height_m is not None:
            yield validation_problem(
                "contact_wire_height_m",
                "the height of the contact wire is given twice",
                "Give either presag_m or contact_wire_height_m.",
            )
        for i, (before, x) in enumerate(pairwise(self.x_m), 2):
            if x <= before:
                yield validation_problem(
                    f"x_m[{i}]",
                    f"{x:g} m is not greater than the preceding {before:g} m",
                    "List the droppers in the direction of travel.",
                )
        for key in ("presag_m", "contact_wire_height_m", "length_m"):
            values, droppers = getattr(self, key), len(self.x_m)
            if values is not None and len(values) != droppers:
                found = f"{len(values)} values for {droppers} droppers"
                yield validation_problem(key, found, "Give one value per dropper of x_m.")

    def list_values(self) -> dict[str, tuple[float, ...]]:
        """Given values by key, one for each dropper; a pre-sag of zero if no heights are given."""
        level = {} if self.contact_wire_height_m is not None else {"presag_m": (0.0,) * len(self.x_m)}
        return level | self.model_dump(exclude_none=True)

    def prescribed_heights(self, chord: RealArray) -> RealArray:
        """Heights of the contact wire at the droppers [m], above the datum.

        Args:
            chord: Heights of the straight line between the supports at the droppers, (n,) [m].
        """
        if self.contact_wire_height_m is not None:
            return np.array(self.contact_wire_height_m)
        return np.asarray(chord - np.array(self.presag_m or (0.0,) * len(self.x_m)))

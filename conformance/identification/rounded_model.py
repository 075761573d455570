"""Base of the JSON files of an identification, whose numbers have eight significant digits."""

import json
import math
from pathlib import Path
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, PlainSerializer

from pantocheck.conformance.input_files.atomic_writing import write_atomically

SIGNIFICANT_DIGITS = 8
"""Digits of a number in a file: more than every uncertainty needs, and equal on all machines."""


def round_significant(value: float) -> float:
    """Round to `SIGNIFICANT_DIGITS`; a value that is not finite becomes 0, because a measured value is never 0."""
    return float(f"{value:.{SIGNIFICANT_DIGITS}g}") if math.isfinite(value) else 0.0


Rounded = Annotated[float, PlainSerializer(round_significant, return_type=float)]
"""Number with full precision in memory and `SIGNIFICANT_DIGITS` in a file."""


class RoundedModel(BaseModel):
    """Part of a JSON file; unknown keys of a newer file are ignored."""

    model_config = ConfigDict(extra="ignore", frozen=True)

    def rounded(self) -> Self:
        """Same model with rounded numbers, so that values in memory and in the file are equal."""
        return type(self).model_validate(self.model_dump())


def write_model(path: Path, model: BaseModel) -> None:
    """Write a model as JSON; equal models give equal bytes.

    Raises:
        InputError: The file cannot be written.
    """
    text = json.dumps(model.model_dump(mode="json", by_alias=True), indent=1, allow_nan=False)
    write_atomically(path, (text + "\n").encode("ascii"))

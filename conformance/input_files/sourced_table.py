"""Base tables of input files: unknown keys are refused, numbers are finite, and a sourced table states its source."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from pantocheck.conformance.input_files.trust import Trust

Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]

# TOML has arrays, and a frozen model needs tuples.
PositiveList = Annotated[tuple[Positive, ...], Field(strict=False, min_length=1, max_length=1000)]
NonNegativeList = Annotated[tuple[NonNegative, ...], Field(strict=False, min_length=1, max_length=1000)]
NumberList = Annotated[tuple[float, ...], Field(strict=False, min_length=1, max_length=1000)]

PROVENANCE = frozenset({"trust", "source", "provisional", "note"})
"""Keys of a sourced table that state the origin of its numbers."""


class InputTable(BaseModel):
    """Table of an input file: unknown keys, NaN and infinity are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class SourcedTable(InputTable):
    """Table whose numbers share one source and one trust; `provisional` lists the exceptions."""

    trust: Annotated[Trust, Field(description="trust in the numbers of this table")]
    source: Annotated[
        str | list[str],
        Field(description="source of the numbers: keys of sources.toml, or free text", max_length=500),
    ]
    provisional: Annotated[
        tuple[str, ...],
        Field(strict=False, description="keys of this table whose numbers have no printed source"),
    ] = ()
    note: Annotated[str | None, Field(description="reason for a number or a choice", max_length=4000)] = None

    @model_validator(mode="after")
    def _exceptions_exist(self) -> "SourcedTable":
        for key in self.provisional:
            if key not in type(self).model_fields:
                raise validation_problem(
                    "provisional", f"{key!r} is not a key of this table", "List keys of the same table."
                )
        return self


def validation_problem(key: str, found: str, hint: str) -> PydanticCustomError:
    """Build the error that a validator raises for keys that contradict each other.

    Parameters
    ----------
    key : str
        Dotted name of the wrong key, relative to the validated table.
    found : str
        Content found there.
    hint : str
        Content expected there.

    Returns
    -------
    PydanticCustomError
        Error with these three parts as context.
    """
    return PydanticCustomError("inconsistent", "{found}. {hint}", {"key": key, "found": found, "hint": hint})

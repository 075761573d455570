"""What all case files share: unknown keys are refused, numbers are finite, and every group names its source."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from pantocheck.conformance.input_files.trust import Trust

Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]

# TOML knows arrays, not tuples; a frozen model holds tuples.
PositiveList = Annotated[tuple[Positive, ...], Field(strict=False, min_length=1, max_length=1000)]
NonNegativeList = Annotated[tuple[NonNegative, ...], Field(strict=False, min_length=1, max_length=1000)]
NumberList = Annotated[tuple[float, ...], Field(strict=False, min_length=1, max_length=1000)]


PROVENANCE = frozenset({"trust", "source", "provisional", "note"})
"""Keys of a sourced table that say where its numbers come from."""


class InputTable(BaseModel):
    """A table of a case file: keys that are not in the schema are refused, NaN and infinity too."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class SourcedTable(InputTable):
    """A table whose numbers come from somewhere: one source and trust for all of them, exceptions named."""

    trust: Annotated[Trust, Field(description="how far the numbers of this table can be trusted")]
    source: Annotated[
        str | list[str],
        Field(description="where they were read: keys of sources.toml, or free text", max_length=500),
    ]
    provisional: Annotated[
        tuple[str, ...],
        Field(strict=False, description="keys of this table that could not be traced to any printed source"),
    ] = ()
    note: Annotated[str | None, Field(description="why a number or a choice is what it is", max_length=4000)] = None

    @model_validator(mode="after")
    def _exceptions_exist(self) -> "SourcedTable":
        for key in self.provisional:
            if key not in type(self).model_fields:
                raise validation_problem(
                    "provisional", f"{key!r} is not a key of this table", "List keys of the same table."
                )
        return self


def validation_problem(key: str, found: str, hint: str) -> PydanticCustomError:
    """An inconsistency between keys, for a validator to raise.

    Parameters
    ----------
    key : str
        The key at fault, dotted, relative to the table that is validated.
    found : str
        What is there.
    hint : str
        What is expected.
    """
    return PydanticCustomError("inconsistent", "{found}. {hint}", {"key": key, "found": found, "hint": hint})

"""Base tables of input files: unknown keys are refused, numbers are finite, and the source of numbers can be stated."""

from typing import Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field, ModelWrapValidatorHandler, model_validator
from pydantic_core import PydanticCustomError

from pantocheck.conformance.input_files.cross_checks import Problems, cross_check, validate_table
from pantocheck.conformance.input_files.trust import Trust

Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]

# TOML has arrays, and a frozen model needs tuples.
PositiveList = Annotated[tuple[Positive, ...], Field(strict=False, min_length=1, max_length=1000)]
NonNegativeList = Annotated[tuple[NonNegative, ...], Field(strict=False, min_length=1, max_length=1000)]
NumberList = Annotated[tuple[float, ...], Field(strict=False, min_length=1, max_length=1000)]

PROVENANCE = frozenset({"trust", "source", "provisional", "note"})
"""Keys of a sourced table that state the origin of its numbers."""

NO_SOURCE = "user data, no source stated"
"""Source of a table without the key `source`."""

NO_TRUST: Trust = "provisional"
"""Trust in a table without the key `trust`: the lowest one."""


def is_absent(value: object) -> bool:
    """Whether an optional key is not given: a later key of a file is left out of its digest then."""
    return value is None or value == ()


class InputTable(BaseModel):
    """Table of an input file: unknown keys, NaN and infinity are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    @model_validator(mode="wrap")
    @classmethod
    def _find_all_problems(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        return validate_table(cls, data, handler)


class SourcedTable(InputTable):
    """Table whose numbers share one source and one trust; `provisional` lists the exceptions."""

    trust: Trust = NO_TRUST
    """Trust in the numbers of this table."""
    source: Annotated[str | list[str], Field(max_length=500)] = NO_SOURCE
    """Source of the numbers: keys of sources.toml, or free text."""
    provisional: Annotated[tuple[str, ...], Field(strict=False)] = ()
    """Keys of this table whose numbers have no printed source."""
    note: Annotated[str | None, Field(max_length=4000)] = None
    """Reason for a number or a choice."""

    @cross_check
    def _check_exceptions(self) -> Problems:
        for key in self.provisional:
            if key not in type(self).model_fields:
                yield validation_problem(
                    "provisional", f"{key[:80]!r} is not a key of this table", "List keys of the same table."
                )

    @cross_check
    def _check_source(self) -> Problems:
        yield from find_missing_source(self.trust, self.source)


def find_missing_source(trust: Trust, source: str | list[str]) -> Problems:
    """Problem of a trust above `provisional` without a source, because nobody could check the trust.

    Args:
        trust: Trust of a table or a limit.
        source: Its source, or `NO_SOURCE`.

    Yields:
        The problem, if there is one.
    """
    if trust != NO_TRUST and source == NO_SOURCE:
        yield validation_problem(
            "source", f"missing, although the trust is {trust!r}", "Name the source, or leave out the key trust."
        )


def validation_problem(key: str, found: str, hint: str) -> PydanticCustomError:
    """Build the error that a cross check yields for keys that contradict each other.

    Args:
        key: Dotted name of the wrong key, relative to the validated table.
        found: Content found there.
        hint: Content expected there.

    Returns:
        Error with these three parts as context.
    """
    return PydanticCustomError("inconsistent", "{found}. {hint}", {"key": key, "found": found, "hint": hint})

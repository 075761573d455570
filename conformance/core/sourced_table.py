"""Base tables of input files: unknown keys are refused, numbers are finite, and the source of numbers can be stated."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from inspect import isfunction
from typing import Annotated, Any, Protocol, Self, TypeVar, cast

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    TypeAdapter,
    ValidationError,
    model_validator,
)
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError

from pantocheck.conformance.core.key_paths import find_members, find_model, key_adapter
from pantocheck.conformance.core.trust import LimitTrust, Trust

# Cross checks: rules on several keys of a table. All problems of a file are found at once.
#
# A rule runs as soon as the keys that it reads are valid, also if other keys of the table are not.
Problems = Iterator[PydanticCustomError]
C = TypeVar("C", bound=Callable[[Any], Problems])
T = TypeVar("T", bound=BaseModel)

_MARK = "is_cross_check"


def cross_check(check: C) -> C:
    """Mark a method of a table as a cross check; it yields a `validation_problem` for each contradiction."""
    setattr(check, _MARK, True)
    return check


def validate_table(model: type[T], data: Any, handler: ModelWrapValidatorHandler[T]) -> T:
    """Validate a table with its cross checks.

    Args:
        model: Model of the table.
        data: Content of the table.
        handler: Validation of the keys, one by one.

    Returns:
        Valid table.

    Raises:
        ValidationError: Keys are invalid, or contradict each other: the error lists all of them.
    """
    try:
        table = handler(data)
    except ValidationError as error:
        details = error.errors(include_url=False)
        part = _build_valid_part(model, data, details)
        problems = [] if part is None else _find_problems(part, complete=False)
        raise _build_error(model, data, [*map(_copy_detail, details), *_problem_details(problems, data)]) from None
    if problems := _find_problems(table, complete=True):
        raise _build_error(model, data, _problem_details(problems, data))
    return table


@cache
def _list_checks(model: type[BaseModel]) -> tuple[str, ...]:
    """Names of the cross checks of a model, those of its base classes first."""
    members = [member for base in reversed(model.__mro__) for member in vars(base).items()]
    return tuple(dict.fromkeys(name for name, item in members if isfunction(item) and hasattr(item, _MARK)))


def _find_problems(table: BaseModel, complete: bool) -> list[PydanticCustomError]:
    """Problems of all cross checks. A check ends at a key that is not valid, or where an earlier problem stops it."""
    problems: list[PydanticCustomError] = []
    for name in _list_checks(type(table)):
        try:
            for problem in getattr(table, name)():
                problems.append(problem)
        except (AttributeError, LookupError, ValueError, ArithmeticError):
            if complete and not problems:
                raise
    return problems


def _build_valid_part(model: type[T], data: Any, details: list[ErrorDetails]) -> T | None:
    """Table with the valid keys only; access to another key is an AttributeError. None if the data are not a table."""
    if not isinstance(data, dict):
        return None
    faults = _group_by_key(details)
    values: dict[str, Any] = {}
    absent = []
    for name, field in model.model_fields.items():
        key = field.alias or name
        if key not in faults:
            if key in data:
                values[name] = key_adapter(model, name).validate_python(data[key])
        elif (part := _build_nested_part(field.annotation, data.get(key), faults[key])) is not None:
            values[name] = part
        else:
            absent.append(name)
    table = model.model_construct(**values)
    for name in absent:
        table.__dict__.pop(name, None)  # a default would hide the invalid value
    return table


def _group_by_key(details: list[ErrorDetails]) -> dict[int | str, list[ErrorDetails]]:
    """Errors below each key, with their locations relative to it."""
    faults: dict[int | str, list[ErrorDetails]] = defaultdict(list)
    for detail in details:
        if detail["loc"]:
            first, *rest = detail["loc"]
            faults[first].append(cast(ErrorDetails, {**detail, "loc": tuple(rest)}))
    return faults


def _build_nested_part(annotation: Any, data: Any, details: list[ErrorDetails]) -> Any:
    """Valid part of a table, or of several tables in a list or by name; None if the key has no tables."""
    members = find_members(annotation, data)
    if members is not None:
        faults = _group_by_key(details)
        parts = {
            key: _build_nested_part(member, value, faults[key])
            if key in faults
            else TypeAdapter(member).validate_python(value)
            for key, (member, value) in members.items()
        }
        if any(part is None for part in parts.values()):
            return None
        return parts if isinstance(data, dict) else tuple(parts.values())
    tags = {detail["loc"][0] if detail["loc"] else None for detail in details}
    model, is_tagged = find_model(annotation, tags)
    if model is None:
        return None
    return _build_valid_part(model, data, _group_by_key(details)[model.__name__] if is_tagged else details)


def _copy_detail(detail: ErrorDetails) -> InitErrorDetails:
    """Detail of an error, as input of a new error."""
    kind: Any = detail["type"]
    context: Mapping[str, Any] = detail.get("ctx", {})
    if kind == "inconsistent":
        kind, context = PydanticCustomError(kind, "{found}. {hint}", dict(context)), {}
    return InitErrorDetails(type=kind, loc=detail["loc"], input=detail["input"], ctx=dict(context))


def _problem_details(problems: list[PydanticCustomError], data: Any) -> list[InitErrorDetails]:
    return [InitErrorDetails(type=problem, loc=(), input=data) for problem in problems]


def _build_error(model: type[BaseModel], data: Any, details: list[InitErrorDetails]) -> ValidationError:
    return ValidationError.from_exception_data(model.__name__, details)


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

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True)

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


def find_missing_source(trust: LimitTrust, source: str | list[str]) -> Problems:
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


class BoundedTable(Protocol):
    """Table with a lower and an upper bound of a quantity."""

    @property
    def quantity(self) -> str: ...
    @property
    def lower(self) -> float | None: ...
    @property
    def upper(self) -> float | None: ...


def find_wrong_bounds(table: BoundedTable, needs_bound: bool = True) -> Problems:
    """Problems of bounds: none is given although one is needed, or the lower one is above the upper one."""
    if table.lower is None and table.upper is None and needs_bound:
        yield validation_problem("", f"the limit of {table.quantity} has no bound", "Give lower, upper or both.")
    if table.lower is not None and table.upper is not None and table.lower > table.upper:
        yield validation_problem(
            "lower", f"{table.lower:g} is above upper = {table.upper:g}", "Give the smaller number as lower."
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

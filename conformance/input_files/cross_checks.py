"""Cross checks: rules on several keys of a table. All problems of a file are found at once.

A rule runs as soon as the keys that it reads are valid, also if other keys of the table are not.
"""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any, TypeVar, cast

from pydantic import BaseModel, ModelWrapValidatorHandler, TypeAdapter, ValidationError
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError

from pantocheck.conformance.input_files.table_models import find_members, find_model, key_adapter

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
    names = [name for base in reversed(model.__mro__) for name, item in vars(base).items() if hasattr(item, _MARK)]
    return tuple(dict.fromkeys(names))


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
    """Table with the valid keys only; access to another key is an AttributeError. None if the data are no table."""
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

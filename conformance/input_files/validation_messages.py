"""Messages for validation errors: file, key, value that was found, and next step."""

import math
import typing
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.suggestions import suggest_names
from pantocheck.conformance.input_files.units import suggest_key

_BOUNDS = {
    "greater_than": ("must be greater than", "gt"),
    "greater_than_equal": ("must be at least", "ge"),
    "less_than": ("must be less than", "lt"),
    "less_than_equal": ("must be at most", "le"),
}

LONGEST_KEY = 80
"""Largest number of characters of a key in a message; all keys of the schemas are shorter."""

_KINDS = {
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "text in quotes",
    "bool_type": "true or false",
    "tuple_type": "a list",
    "list_type": "a list",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "dict_type": "a table",
}


def build_input_error(error: ValidationError, model: type[BaseModel], where: str) -> InputError:
    """Build an `InputError` from the most useful one of the validation errors of a file.

    Parameters
    ----------
    error : ValidationError
        Error of pydantic.
    model : type of BaseModel
        Model that was validated.
    where : str
        Name of the file in messages, e.g. `reference line 'my-line.toml'`.

    Returns
    -------
    InputError
        Error with file, key, value and hint.
    """
    # A key in a wrong unit gives two errors, an unknown and a missing key; the unknown key gives the better hint.
    detail = min(error.errors(), key=lambda item: item["type"] != "extra_forbidden")
    table, field, key = _walk(model, detail["loc"])
    if detail["type"] == "inconsistent":
        context = detail["ctx"]
        key, found, hint = f"{key}.{context['key']}".strip("."), context["found"], context["hint"]
    else:
        found, hint = _explain(detail, table, field)
    return InputError(f"{where}, key {key}" if key else where, found, hint)


def _explain(detail: ErrorDetails, table: type[BaseModel], field: FieldInfo | None) -> tuple[str, str]:
    """Content that was found, and hint, for one error of pydantic."""
    kind, value = detail["type"], detail["input"]
    name = str(detail["loc"][-1]) if detail["loc"] else ""
    known = list(table.model_fields)
    about = f"It is: {field.description}." if field is not None and field.description else "See `pantocheck schema`."
    if kind == "extra_forbidden":
        return "unknown key", suggest_key(name, value, known) or suggest_names(name, known)
    if kind == "missing":
        return "missing", about
    if kind == "finite_number":
        return f"{value} is not a finite number", about
    if kind in _BOUNDS:
        words, bound = _BOUNDS[kind]
        return f"{_show(value)} {words} {detail['ctx'][bound]}", about
    if expected := _KINDS.get(kind) or detail.get("ctx", {}).get("expected"):
        return f"found {_show(value)}, expected {expected}", about
    return f"found {_show(value)}: {detail['msg'][:1].lower()}{detail['msg'][1:]}", about


def _show(value: object) -> str:
    """Value as text of at most 60 characters."""
    if isinstance(value, float) and math.isfinite(value):
        return f"{value:g}"
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _walk(model: type[BaseModel], location: tuple[int | str, ...]) -> tuple[type[BaseModel], FieldInfo | None, str]:
    """Table and field at a location, and the location as a dotted key with list items numbered from 1."""
    table, field, key = model, None, ""
    inner: Any = model
    for part in location:
        if isinstance(part, int):
            key += f"[{part + 1}]"
            continue
        member = next((model for model in _models_in(inner) if part in _names_in_unions(model)), None)
        holder = next(iter(_models_in(inner)), None)
        if member is not None or holder is None:
            inner = member or inner
            continue  # name of a member of a union, not a key
        table, field = holder, holder.model_fields.get(part)
        name = part if len(part) <= LONGEST_KEY else part[:LONGEST_KEY] + "..."
        key += f".{name}" if key else name
        inner = field.annotation if field is not None else None
    return table, field, key


def _names_in_unions(model: type[BaseModel]) -> tuple[str, ...]:
    """Names that pydantic gives to a member of a union: the model, or the tag in its key `kind`."""
    kind = model.model_fields.get("kind")
    return (model.__name__, *(typing.get_args(kind.annotation) if kind is not None else ()))


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    """Models in an annotation, in its order."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for argument in typing.get_args(annotation) for model in _models_in(argument)]

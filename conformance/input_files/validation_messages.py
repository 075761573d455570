"""Messages for validation errors: file, key, value that was found, and next step."""

import math
import re
import typing
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from pantocheck.conformance.input_files.input_error import InputError, join_errors
from pantocheck.conformance.input_files.key_descriptions import describe_key
from pantocheck.conformance.input_files.suggestions import suggest_names
from pantocheck.conformance.input_files.table_models import find_field, list_models, names_in_unions
from pantocheck.conformance.input_files.table_numbers import append_table_number
from pantocheck.conformance.input_files.units import suggest_key

_BOUNDS = {
    "greater_than": ("must be greater than", "gt"),
    "greater_than_equal": ("must be at least", "ge"),
    "less_than": ("must be less than", "lt"),
    "less_than_equal": ("must be at most", "le"),
}

LONGEST_KEY = 80
"""Largest number of characters of a key in a message; all keys of the schemas are shorter."""

MOST_PROBLEMS = 1000
"""Largest number of errors of a file that are described; nobody corrects more at once."""

_PARTS = re.compile(r"[.\[]")

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


def build_input_error(error: ValidationError, model: type[BaseModel], where: str, tree: object = None) -> InputError:
    """Build an `InputError` with one message for each problem of a file.

    Args:
        error: Error of pydantic.
        model: Model that was validated.
        where: Name of the file in messages, e.g. `line 'my-line.toml'`.
        tree: Content of the file; a table of a list that states its number is named by it.

    Returns:
        First error with file, key, value and hint, and all further ones. Unknown keys come first.
    """
    details = sorted(error.errors(include_url=False), key=lambda detail: detail["type"] != "extra_forbidden")
    details = details[:MOST_PROBLEMS]
    problems = [_describe(detail, model) for detail in details]
    return join_errors(
        [
            InputError(
                f"{where}, key {append_table_number(problem.key, tree)}" if problem.key else where,
                problem.found,
                problem.hint,
            )
            for problem in _drop_repetitions(problems)
        ]
    )


@dataclass(frozen=True)
class _Problem:
    """Message on one key: kind of the error of pydantic, dotted key, content found, hint."""

    kind: str
    key: str
    found: str
    hint: str


def _drop_repetitions(problems: list[_Problem]) -> Iterator[_Problem]:
    """Problems of different causes: one per key, none that an unknown key or an error in a part of the key explains."""
    above = {key[: end.start()] for key in {problem.key for problem in problems} for end in _PARTS.finditer(key)}
    unknown = [problem for problem in problems if problem.kind == "extra_forbidden"]
    seen: set[object] = set()
    for problem in problems:
        if problem.kind == "inconsistent":
            repeated = problem in seen
            seen.add(problem)
        else:
            of_union = problem.key in above  # the other member of a union fits better
            misspelt = problem.kind == "missing" and any(_explains(other, problem.key) for other in unknown)
            repeated = of_union or misspelt or problem.key in seen
            seen.add(problem.key)
        if not repeated:
            yield problem


def _explains(problem: _Problem, missing: str) -> bool:
    """Whether the hint on an unknown key of the same table names the missing key, and no other."""
    table, _, name = missing.rpartition(".")
    same_table = problem.key.rpartition(".")[0] == table
    return same_table and f"id you mean {name} " in problem.hint and " or " not in problem.hint


def _describe(detail: ErrorDetails, model: type[BaseModel]) -> _Problem:
    """Key, content found and hint of one error of pydantic."""
    table, name, key = _walk(model, detail["loc"])
    if detail["type"] == "inconsistent":
        context = detail["ctx"]
        return _Problem(detail["type"], f"{key}.{context['key']}".strip("."), context["found"], context["hint"])
    return _Problem(detail["type"], key, *_explain(detail, table, name))


def _explain(detail: ErrorDetails, table: type[BaseModel], field: str | None) -> tuple[str, str]:
    """Content that was found, and hint, for one error of pydantic."""
    kind, value = detail["type"], detail["input"]
    name = str(detail["loc"][-1]) if detail["loc"] else ""
    known = [other.alias or key for key, other in table.model_fields.items()]
    about = describe_key(table, field) if field is not None else "See `pantocheck schema`."
    if kind == "extra_forbidden":
        return "unknown key", suggest_key(name, value, known) or suggest_names(name, known)
    if kind == "missing":
        return "missing", about
    if kind == "finite_number":
        return f"{value} is not a finite number", about
    if kind == "too_short" and not value and field is not None and not table.model_fields[field].is_required():
        return f"found {_show(value)}, which is empty", f"Remove the key, or fill it in. {about}"
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


def _walk(model: type[BaseModel], location: tuple[int | str, ...]) -> tuple[type[BaseModel], str | None, str]:
    """Table and field at a location, and the location as a dotted key with list items numbered from 1."""
    table, name, key = model, None, ""
    inner: Any = model
    for part in location:
        if isinstance(part, int):
            key += f"[{part + 1}]"
            continue
        models = list_models(inner)
        if (member := next((model for model in models if part in names_in_unions(model)), None)) is not None:
            inner = member
            continue  # name of a member of a union, not a key
        if not models:
            continue
        shown = part if len(part) <= LONGEST_KEY else part[:LONGEST_KEY] + "..."
        key += f".{shown}" if key else shown
        if typing.get_origin(inner) is dict:
            inner = typing.get_args(inner)[1]
            continue  # name of a table that the user chooses
        table, name = models[0], find_field(models[0], part)
        inner = None if name is None else table.model_fields[name].annotation
    return table, name, key

"""Messages for validation errors: file, key, value that was found, and next step."""

import ast
import inspect
import math
import re
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from types import ModuleType
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import ErrorDetails, core_schema

from pantocheck.conformance.core.array_types import IntegerArray
from pantocheck.conformance.core.input_error import InputError, join_errors, suggest_names
from pantocheck.conformance.core.key_paths import find_field, key_adapter, list_models, names_in_unions
from pantocheck.conformance.core.units import suggest_key

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


# Numbers of tables in messages: a table of a list that states its number is found by it, not by its place.
_STEP = re.compile(r"([^.\[\]]+)|\[(\d+)\]")


def append_table_number(key: str, tree: Any) -> str:
    """Append the number of the innermost table of a list that states one.

    Args:
        key: Dotted key with the items of lists numbered from 1, e.g. `geometry.support[2].encumbrance_m`.
        tree: Content of the file.

    Returns:
        The key, e.g. `geometry.support[2].encumbrance_m (number 7)`; unchanged without such a table, and for the number
        itself.
    """
    number: object = None
    for step in _STEP.finditer(key):
        name, item = step.groups()
        if item is None:
            tree = tree.get(name) if isinstance(tree, dict) else None
        else:
            tree = tree[int(item) - 1] if isinstance(tree, list) and 0 < int(item) <= len(tree) else None
            stated = tree.get("number") if isinstance(tree, dict) else None
            number = stated if isinstance(stated, int) else number
    return key if number is None or key.endswith(".number") else f"{key} (number {number})"


# Rows of a table in messages.
MOST_NAMED_ROWS = 8
"""Largest number of rows that a message names."""


def name_rows(rows: IntegerArray, most: int = MOST_NAMED_ROWS) -> str:
    """Name rows by their numbers; the first ones of many, `rows 2, 3, ... and 5 more`."""
    names = ", ".join(map(str, rows[:most]))
    further = rows.size - most
    return f"row{'s' if rows.size > 1 else ''} {names}" + (f" and {further} more" if further > 0 else "")


# Descriptions of keys for schemas and messages: their meaning, from the string under the field, and allowed values.
_KEY_DESCRIPTIONS_BOUNDS = {
    "exclusiveMinimum": "greater than",
    "minimum": "at least",
    "exclusiveMaximum": "less than",
    "maximum": "at most",
}
_LENGTHS = {"minItems": "at least", "maxItems": "at most"}
_TYPES = {"boolean": "true or false", "string": "text in quotes", "integer": "a whole number", "number": "a number"}


class DescribedSchema(GenerateJsonSchema):
    """JSON Schema whose keys are described by the strings under the fields."""

    def model_schema(self, schema: core_schema.ModelSchema) -> JsonSchemaValue:
        """Schema of a table with the descriptions of its keys."""
        described = super().model_schema(schema)
        model: type[BaseModel] = schema["cls"]
        texts = read_field_texts(model)
        for name, field in model.model_fields.items():
            key = described.get("properties", {}).get(field.alias or name)
            if key is not None and name in texts:
                key["description"] = texts[name]
        return described


@cache
def read_field_texts(model: type[BaseModel]) -> dict[str, str]:
    """Strings under the fields of a model and its bases, read from the source; empty where there is none.

    Pydantic's `use_attribute_docstrings` reads the source of every model at import, which doubles the time of building
    the models. Schemas and messages are rare.
    """
    texts: dict[str, str] = {}
    for part in reversed(model.__mro__[: model.__mro__.index(BaseModel)]):
        texts |= _parse_module(inspect.getmodule(part)).get(part.__qualname__.replace("<locals>.", ""), {})
    return texts


def describe_field(model: type[BaseModel], name: str) -> str:
    """Meaning of a field as part of a sentence: without capital letter and full stop; empty if it is not described."""
    text = read_field_texts(model).get(name) or model.model_fields[name].description or ""
    return re.sub(r"^[A-Z](?=[a-z]*[ ,;-])", lambda capital: capital[0].lower(), text.removesuffix("."))


@cache
def describe_key(model: type[BaseModel], name: str) -> str:
    """Sentences with the meaning of a key and its allowed values.

    Args:
        model: Table of the key.
        name: Name of the field of the model.
    """
    field = model.model_fields[name]
    nested = list_models(field.annotation)
    meaning = describe_field(model, name)
    about = [f"It is: {meaning}."] if meaning else []
    if nested:
        return " ".join([*about, f"A table: {' or '.join(map(_describe_table, nested))}."])
    allowed = " or ".join(dict.fromkeys(_list_allowed(key_adapter(model, name).json_schema())))
    return " ".join([*about, f"Allowed: {allowed}."])


@cache
def _parse_module(module: ModuleType | None) -> dict[str, dict[str, str]]:
    """Strings under the fields of every class of a module, by its qualified name; empty without a source."""
    try:
        return dict(_list_classes(ast.parse(inspect.getsource(module)), "")) if module is not None else {}
    except (OSError, TypeError):
        return {}


def _list_classes(node: ast.AST, prefix: str) -> Iterator[tuple[str, dict[str, str]]]:
    """Qualified names of the classes below a node, with the strings under their fields."""
    for part in ast.iter_child_nodes(node):
        name = prefix
        if isinstance(part, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            name = f"{prefix}{part.name}."
        if isinstance(part, ast.ClassDef):
            yield f"{prefix}{part.name}", dict(_list_field_texts(part))
        yield from _list_classes(part, name)


def _list_field_texts(definition: ast.ClassDef) -> Iterator[tuple[str, str]]:
    """Names and strings of the described fields of a class."""
    for field, below in pairwise(definition.body):
        match field, below:
            case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(value=ast.Constant(value=str(text))):
                yield name, " ".join(text.split())


def _describe_table(model: type[BaseModel]) -> str:
    """Purpose of a table, with the keys that it must have."""
    required = [field.alias or name for name, field in model.model_fields.items() if field.is_required()]
    purpose = (model.__doc__ or model.__name__).partition(".")[0].partition("\n")[0]
    return f"{purpose}, with the keys {', '.join(required)}" if required else purpose


def _list_allowed(schema: dict[str, Any]) -> Iterator[str]:
    """Allowed values of a JSON Schema in words, one text per alternative."""
    for member in (*schema.get("anyOf", ()), *schema.get("oneOf", ())):
        yield from _list_allowed(member)
    if "enum" in schema or "const" in schema:
        values = schema.get("enum", [schema.get("const")])
        yield " or ".join(f'"{value}"' if isinstance(value, str) else str(value) for value in values)
    elif schema.get("type") == "array":
        counts = [f"{words} {schema[key]}" for key, words in _LENGTHS.items() if key in schema]
        size = f" ({', '.join(counts)} of them)" if counts else ""
        items = schema.get("prefixItems", [schema.get("items", {})])[0]
        yield f"a list{size} with " + (" or ".join(_list_allowed(items)) or "any values")
    elif schema.get("type") in _TYPES:
        pattern = [f"of the form {schema['pattern']}"] if "pattern" in schema else []
        yield " ".join([_TYPES[schema["type"]], ", ".join([*list_bounds(schema), *pattern])]).strip()


def list_bounds(schema: Mapping[str, Any]) -> list[str]:
    """Bounds of a number in words, from its JSON Schema."""
    return [f"{words} {schema[key]:.15g}" for key, words in _KEY_DESCRIPTIONS_BOUNDS.items() if key in schema]

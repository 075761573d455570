"""Paths of keys: parsing of dotted keys, and steps through models and through the content of files."""

import re
import typing
from collections.abc import Iterator, Sequence, Set
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any

from pydantic import BaseModel, Field, TypeAdapter

from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.core.units import suggest_key

KeyPath = tuple[str | int, ...]
"""Names of keys, and indices of list items from 0."""

_PART = re.compile(r"""(?:^|\.)(?:([A-Za-z0-9_-]+)|"([^"]*)")((?:\[[0-9]{1,6}\])*)""")


def parse_key(text: str) -> KeyPath | None:
    """Parse a dotted key with list items numbered from 1, such as `droppers.x_m[3]`; None if it is not one."""
    matches = list(_PART.finditer(text))
    if not matches or "".join(match.group() for match in matches) != text:
        return None
    parts: list[str | int] = []
    for match in matches:
        parts.append(match.group(2) if match.group(1) is None else match.group(1))
        parts += [int(number) - 1 for number in re.findall("[0-9]+", match.group(3))]
    return None if -1 in parts else tuple(parts)


def find_holders(model: type[BaseModel], path: KeyPath) -> list[type[BaseModel] | None]:
    """Model of the table that holds each part of a path; None for list items and freely named tables.

    The list is shorter than the path if a part does not exist.
    """
    return [holder for holder, _ in _follow_model(model, path)]


def _list_values(model: type[BaseModel], path: KeyPath) -> list[Any]:
    """Types of the values of a key; empty if the key does not exist."""
    steps = _follow_model(model, path)
    return _list_alternatives(steps[-1][1]) if path and len(steps) == len(path) else []


def _follow_model(model: type[BaseModel], path: KeyPath) -> list[tuple[type[BaseModel] | None, Any]]:
    """Holder and annotation of each part of a path; shorter than the path if a part does not exist."""
    annotation: Any = model
    followed: list[tuple[type[BaseModel] | None, Any]] = []
    for part in path:
        steps = [step for each in _list_alternatives(annotation) if (step := _step(each, part)) is not None]
        if not steps:
            return followed
        followed.append(steps[0])
        annotation = steps[0][1]
    return followed


def holds_list(models: Sequence[type[BaseModel]], path: KeyPath) -> bool:
    """Whether every model that has a key accepts nothing but a list there."""
    values = [each for model in models for each in _list_values(model, path)]
    return bool(values) and all(typing.get_origin(each) in (tuple, list) for each in values)


def check_path(
    models: Sequence[type[BaseModel]],
    path: KeyPath,
    value: object,
    where: str,
    everywhere: list[str],
    prefix: KeyPath = (),
) -> None:
    """Check that a key exists.

    Args:
        models: Models of the tables that may hold the key.
        path: Path of the key.
        value: New value, for a suggestion in another unit.
        where: Name of the key in messages.
        everywhere: Dotted keys of all files, for a suggestion.
        prefix: Path of these tables in the key of the user, for a suggestion.

    Raises:
        InputError: A part does not exist; the hint suggests keys.
    """
    found = max(len(find_holders(model, path)) for model in models)
    if found == len(path):
        return
    part = path[found]
    if isinstance(part, int):
        raise InputError(where, "is not a list", f"Leave out [{part + 1}].")
    above = join_path(path[:found])
    below = [key for model in models for key in list_dotted_keys(model) if key.startswith(above)]
    names = list(dict.fromkeys(key.removeprefix(f"{above}.").partition(".")[0] for key in below))
    hint = suggest_key(part, value, names) or suggest_names(part, names, _begin_key((*prefix, *path[:found])))
    elsewhere = list(dict.fromkeys(key for key in everywhere if f".{key}".endswith("." + join_path(path))))
    raise InputError(where, "unknown key", f"Did you mean {' or '.join(elsewhere)} ?" if elsewhere else hint)


def _begin_key(path: KeyPath) -> str:
    """Prefix of the keys in a table; empty for the outermost one."""
    return f"{join_path(path)}." if path else ""


def follow_path(tree: dict[str, Any], path: KeyPath, where: str) -> tuple[Any, str | int, Any]:
    """Table or list that holds the last part of a path, this part, and its value (None: not in the file).

    Missing tables are added.

    Raises:
        InputError: A list item does not exist, or a part above the last one is neither a table nor a list.
    """
    node: Any = tree
    for i, part in enumerate(path):
        if isinstance(part, int):
            if not isinstance(node, list) or part >= len(node):
                found = f"has {len(node)} items" if isinstance(node, list) else "is not in the file"
                raise InputError(where, f"{join_path(path[:i])} {found}", "Items are numbered from 1.")
        elif not isinstance(node, dict):
            raise InputError(where, f"{join_path(path[:i])} is not a table in this file", "Set the whole value.")
        if i == len(path) - 1:
            break
        node = node[part] if isinstance(part, int) else node.setdefault(part, {})
    return node, path[-1], node[path[-1]] if isinstance(path[-1], int) else node.get(path[-1])


def join_path(path: KeyPath) -> str:
    """Dotted key of a path, with list items numbered from 1."""
    return "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in path).removeprefix(".")


def list_dotted_keys(model: type[BaseModel], prefix: str = "") -> list[str]:
    """Dotted keys of a file at all levels, without those of tables in lists and of freely named tables."""
    return list(dict.fromkeys(_iterate_keys(model, prefix)))


def _iterate_keys(model: type[BaseModel], prefix: str) -> Iterator[str]:
    for name, field in model.model_fields.items():
        key = f"{prefix}.{field.alias or name}".removeprefix(".")
        yield key
        for member in _list_alternatives(field.annotation):
            if isinstance(member, type) and issubclass(member, BaseModel):
                yield from _iterate_keys(member, key)


def _list_alternatives(annotation: Any) -> list[Any]:
    """Members of a union, without None and annotations."""
    origin = typing.get_origin(annotation)
    if origin is Annotated:
        return _list_alternatives(typing.get_args(annotation)[0])
    if origin in (typing.Union, UnionType):
        return [each for member in typing.get_args(annotation) for each in _list_alternatives(member)]
    return [] if annotation is NoneType else [annotation]


def _step(annotation: Any, part: str | int) -> tuple[type[BaseModel] | None, Any] | None:
    """Holder and annotation of a part of a path; None if the annotation has no such part."""
    origin, arguments = typing.get_origin(annotation), typing.get_args(annotation)
    if isinstance(part, int):
        return (None, arguments[0]) if origin in (tuple, list) else None
    if origin is dict:
        return None, arguments[1]
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        name = find_field(annotation, part)
        return None if name is None else (annotation, annotation.model_fields[name].annotation)
    return None


# Models of nested tables in the annotation of a key.
def list_models(annotation: Any) -> list[type[BaseModel]]:
    """Models in an annotation, in its order."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for argument in typing.get_args(annotation) for model in list_models(argument)]


def find_field(model: type[BaseModel], key: str) -> str | None:
    """Name of the field of a key; None if the model does not have the key."""
    return next((name for name, field in model.model_fields.items() if key == (field.alias or name)), None)


@cache
def key_adapter(model: type[BaseModel], name: str) -> TypeAdapter[Any]:
    """Validation and JSON Schema of one key of a model."""
    field = model.model_fields[name]
    annotation: Any = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    if field.discriminator is not None:
        annotation = Annotated[annotation, Field(discriminator=field.discriminator)]
    return TypeAdapter(annotation)


def names_in_unions(model: type[BaseModel]) -> tuple[str, ...]:
    """Names that pydantic gives to a member of a union: the model, or the tag in its key `kind`."""
    kind = model.model_fields.get("kind")
    return (model.__name__, *(typing.get_args(kind.annotation) if kind is not None else ()))


def find_members(annotation: Any, data: Any) -> dict[int | str, tuple[Any, Any]] | None:
    """Annotation and content of each member of a list or a dictionary, by index or name; None for other data."""
    origin, arguments = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is dict and isinstance(data, dict):
        return {key: (arguments[1], value) for key, value in data.items()}
    if origin is tuple and arguments[-1] is Ellipsis and isinstance(data, list | tuple):
        return {index: (arguments[0], value) for index, value in enumerate(data)}
    return None


def find_model(annotation: Any, tags: Set[object]) -> tuple[type[BaseModel] | None, bool]:
    """Model of a nested table, and whether the locations of its errors begin with the name of the model.

    Args:
        annotation: Annotation of the key.
        tags: First parts of the locations of all errors below the key.

    Returns:
        None: the key has no table, or the errors do not tell its model.
    """
    models = list_models(annotation)
    for model in models:
        if tags == {model.__name__}:
            return model, True
    return (models[0], False) if len(models) == 1 else (None, False)

"""Models of nested tables in the annotation of a key."""

import typing
from collections.abc import Set
from functools import cache
from typing import Annotated, Any

from pydantic import BaseModel, Field, TypeAdapter


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

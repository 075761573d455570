"""Features: names of the optional keys whose neglect would change the result of a simulation.

A key of a table is declared with its feature, beside its unit and range:

    stagger_m: Annotated[float, Field(description="lateral position [m]"), Feature("stagger")] = 0.0

A table uses the feature if the key differs from its default. A key with a default, but without a declaration, is a
feature under its own path, so that a forgotten declaration makes programs skip a case rather than simulate another one.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pantocheck.conformance.core.sourced_table import PROVENANCE


@dataclass(frozen=True)
class Feature:
    """Feature of a key of an input table."""

    name: str
    """Name that a program states if it simulates the key."""
    is_used: Callable[[Any], bool] | None = None
    """Whether a value needs the feature; default: every value except the default of the key."""


NO_FEATURE = Feature("", lambda _: False)
"""Declaration of a key that changes no result, such as a name or a published value for comparison."""


def always(_: object) -> bool:
    """Every value of a key needs its feature."""
    return True


def find_declaration(field: FieldInfo) -> Feature | None:
    """Declared feature of a key; None if it has none."""
    return next((item for item in reversed(field.metadata) if isinstance(item, Feature)), None)


def list_features(table: BaseModel, path: str = "") -> Iterator[str]:
    """Features that a table and the tables inside use, with repetitions.

    Args:
        table: Table of an input file.
        path: Key of the table in its file, for keys without a declaration.

    Yields:
        Name of a feature.
    """
    for name, field in type(table).model_fields.items():
        if name in PROVENANCE:
            continue
        value, key = getattr(table, name), f"{path}.{name}".strip(".")
        feature = find_declaration(field)
        is_changed = not field.is_required() and value != field.get_default(call_default_factory=True)
        if feature is NO_FEATURE:
            continue
        if feature is None:
            if is_changed and not isinstance(field.default, BaseModel):
                yield key
        elif is_changed if feature.is_used is None else feature.is_used(value):
            yield feature.name
        yield from _list_nested(value, key)


def _list_nested(value: object, path: str) -> Iterator[str]:
    """Features of the tables in a value."""
    if isinstance(value, BaseModel):
        yield from list_features(value, path)
    elif isinstance(value, dict | tuple):
        for part in value.values() if isinstance(value, dict) else value:
            yield from _list_nested(part, path)

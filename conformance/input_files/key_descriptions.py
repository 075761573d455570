"""Description of a key for messages: its meaning and its allowed values."""

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from pydantic import BaseModel

from pantocheck.conformance.input_files.table_models import key_adapter, list_models

_BOUNDS = {
    "exclusiveMinimum": "greater than",
    "minimum": "at least",
    "exclusiveMaximum": "less than",
    "maximum": "at most",
}
_LENGTHS = {"minItems": "at least", "maxItems": "at most"}
_TYPES = {"boolean": "true or false", "string": "text in quotes", "integer": "a whole number", "number": "a number"}


@cache
def describe_key(model: type[BaseModel], name: str) -> str:
    """Sentences with the meaning of a key and its allowed values.

    Parameters
    ----------
    model : type of BaseModel
        Table of the key.
    name : str
        Name of the field of the model.
    """
    field = model.model_fields[name]
    nested = list_models(field.annotation)
    about = [f"It is: {field.description}."] if field.description else []
    if nested:
        return " ".join([*about, f"A table: {' or '.join(map(_describe_table, nested))}."])
    allowed = " or ".join(dict.fromkeys(_list_allowed(key_adapter(model, name).json_schema())))
    return " ".join([*about, f"Allowed: {allowed}."])


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
    return [f"{words} {schema[key]:.15g}" for key, words in _BOUNDS.items() if key in schema]

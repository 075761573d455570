"""Descriptions of keys for schemas and messages: their meaning, from the string under the field, and allowed values."""

import ast
import inspect
import re
from collections.abc import Iterator, Mapping
from functools import cache
from itertools import pairwise
from types import ModuleType
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from pantocheck.conformance.input_files.table_models import key_adapter, list_models

_BOUNDS = {
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
    return [f"{words} {schema[key]:.15g}" for key, words in _BOUNDS.items() if key in schema]

"""Bounds of keys: every model accepts a value at a bound of the shipped JSON Schema, and refuses the next one."""

import json
from collections.abc import Iterator
from typing import Annotated, Any

import numpy as np
from jsonschema import Draft202012Validator
from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from pantocheck.conformance.app.schemas import READ_FORMATS
from pantocheck.conformance.line.library_folder import library_folder

STRICT = ConfigDict(strict=True, allow_inf_nan=False)
NUMBERS = ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")


def list_models(base: type[BaseModel] = BaseModel) -> Iterator[type[BaseModel]]:
    """Models of the suite, once every file format is loaded."""
    for model in base.__subclasses__():
        if model.__module__.startswith("pantocheck.conformance"):
            yield model
        yield from list_models(model)


def read_shipped_tables() -> dict[str, dict[str, Any]]:
    """Schemas of the tables of all file formats, by the name of the model."""
    tables = {}
    for path in (library_folder() / "schema").glob("*.json"):
        schema = json.loads(path.read_text(encoding="utf-8"))
        shared = schema.get("$defs", {})
        for name, table in {schema.get("title", ""): schema, **shared}.items():
            if "properties" in table:
                tables[name] = {key: resolve(value, shared) for key, value in table["properties"].items()}
    return tables


def resolve(schema: dict[str, Any], shared: dict[str, Any]) -> dict[str, Any]:
    """Schema of a key with a shared description in its place; of several kinds of value the first, but not null."""
    if kinds := schema.get("anyOf", schema.get("oneOf")):
        schema = next(kind for kind in kinds if kind.get("type") != "null")
    reference = str(schema.get("$ref", "")).removeprefix("#/$defs/")
    if "properties" not in (target := shared.get(reference, {"properties": None})):
        return dict(target)
    return schema


def list_values(schema: dict[str, Any]) -> tuple[list[Any], list[Any]]:
    """Values at the bounds of a number, a text or a list, and the next values beyond them."""
    if schema.get("type") in {"number", "integer"}:
        return list_numbers(schema)
    if schema.get("type") == "string" and "pattern" not in schema and "enum" not in schema:
        return list_sizes(schema.get("minLength"), schema.get("maxLength"), "x".__mul__)
    if schema.get("type") == "array" and "$ref" not in schema.get("items", {"$ref": ""}):
        inner, outer = list_values(schema["items"])
        if inner:
            valid, invalid = list_sizes(schema.get("minItems"), schema.get("maxItems"), ([inner[0]]).__mul__)
            length = max(1, schema.get("minItems", 1))
            return valid + [[value] * length for value in inner], invalid + [[value] * length for value in outer]
    if schema.get("type") == "object" and "type" in (item := schema.get("additionalProperties") or {}):
        inner, outer = list_values(item)
        if inner:
            valid, invalid = list_sizes(schema.get("minProperties"), schema.get("maxProperties"), range)
            tables = [[{f"key_{k}": inner[0] for k in size} for size in sizes] for sizes in (valid, invalid)]
            return tables[0] + [{"key": value} for value in inner], tables[1] + [{"key": value} for value in outer]
    return [], []


def list_numbers(schema: dict[str, Any]) -> tuple[list[Any], list[Any]]:
    """Numbers at the bounds of a schema and beyond them; some number if it has none."""
    whole = schema["type"] == "integer"
    valid: list[Any] = []
    invalid: list[Any] = []
    for name in NUMBERS:
        if name in schema:
            bound, up = schema[name], name.lower().endswith("maximum")
            following = bound + (1 if up else -1) if whole else float(np.nextafter(bound, np.inf if up else -np.inf))
            preceding = bound + (-1 if up else 1) if whole else float(np.nextafter(bound, -np.inf if up else np.inf))
            exclusive = name.startswith("exclusive")
            valid.append(preceding if exclusive else bound)
            invalid.append(bound if exclusive else following)
    return valid or ([1] if whole else [1.0]), invalid


def list_sizes(least: int | None, largest: int | None, make: Any) -> tuple[list[Any], list[Any]]:
    """Texts or lists of the smallest and the largest size, and one item smaller or larger."""
    valid = [make(size) for size in (least, largest) if size is not None]
    invalid = [
        make(size)
        for size in (least - 1 if least else None, None if largest is None else largest + 1)
        if size is not None
    ]
    return valid or [make(1)], invalid


def test_values_at_the_bounds_are_accepted_and_others_refused() -> None:
    """The default of a key is that of its schema, too."""
    shipped, wrong, checked = read_shipped_tables(), list[str](), set[str]()
    assert all(READ_FORMATS.values())
    for model in list_models():
        for name, field in model.model_fields.items():
            schema = shipped.get(model.__name__, {}).get(field.alias or name)
            if schema is None:
                continue
            key = f"{model.__name__}.{name}"
            if isinstance(field.default, str | int | float) and field.default != schema.get("default", field.default):
                wrong.append(f"{key}: default {field.default!r}")
            valid, invalid = list_values(schema)
            if not invalid:
                continue
            adapter = TypeAdapter(Annotated[field.annotation, name, *field.metadata], config=STRICT)
            kept = filter(Draft202012Validator(schema).is_valid, valid)  # A key may have two lower bounds.
            for value, expected in (*((value, True) for value in kept), *((value, False) for value in invalid)):
                if is_accepted(adapter, value) is not expected:
                    wrong.append(f"{key} = {str(value)[:40]}: accepted {not expected}")
            checked.add(model.__name__)
    assert not wrong
    assert len(checked) > 60


def is_accepted(adapter: TypeAdapter[Any], value: object) -> bool:
    """Whether a value is valid."""
    try:
        adapter.validate_python(value)
    except ValidationError:
        return False
    return True

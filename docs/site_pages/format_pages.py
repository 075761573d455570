"""Reference of the file formats, from their JSON Schemas."""

from collections.abc import Iterator
from typing import Any

from pantocheck.conformance.app.schemas import FORMAT_NAMES, READ_FORMATS, build_schema
from site_pages.markdown_table import build_markdown_table, escape_text


def build_format_page() -> str:
    """Page with the keys of every file format."""
    parts = [
        "# File formats",
        "`pantocheck schema NAME` prints the JSON Schema of a format, for editors and validators.",
    ]
    parts += [_build_format(name) for name in FORMAT_NAMES]
    return "\n\n".join(parts) + "\n"


def _build_format(name: str) -> str:
    schema = build_schema(name)
    kind = "TOML file that users write" if name in READ_FORMATS else "JSON that the suite reads or writes"
    parts = [f"## {name}", f"{kind}. {escape_text(schema.get('description', ''))}"]
    parts += _list_tables(schema, schema, name)
    for title, part in schema.get("$defs", {}).items():
        parts += _list_tables(part, schema, title)
    return "\n\n".join(parts)


def _list_tables(part: dict[str, Any], schema: dict[str, Any], title: str) -> Iterator[str]:
    """Table of the keys of one part of a format."""
    if not part.get("properties"):
        return
    required = set(part.get("required", ()))
    rows = [
        (f"`{key}`", _describe_type(value, schema), "yes" if key in required else "", _describe(value, schema))
        for key, value in part["properties"].items()
    ]
    yield f"**{escape_text(title)}**"
    yield build_markdown_table(("key", "type", "required", "meaning"), rows)


def _resolve(value: dict[str, Any], schema: dict[str, Any]) -> dict[str, Any]:
    """The definition that a reference names, with the keys beside the reference."""
    if "$ref" not in value:
        return value
    found: dict[str, Any] = schema["$defs"][value["$ref"].rsplit("/", 1)[1]]
    return {**found, **{key: item for key, item in value.items() if key != "$ref"}}


def _describe(value: dict[str, Any], schema: dict[str, Any]) -> str:
    return escape_text(str(_resolve(value, schema).get("description", "")))


def _describe_type(value: dict[str, Any], schema: dict[str, Any]) -> str:
    """Type of a value in words; a table is named."""
    if "$ref" in value:
        name = value["$ref"].rsplit("/", 1)[1]
        found = schema["$defs"][name]
        return escape_text(name) if "properties" in found else _describe_type(found, schema)
    for word in ("anyOf", "oneOf"):
        if word in value:
            return " or ".join(dict.fromkeys(_describe_type(item, schema) for item in value[word]))
    if "const" in value:
        return f"`{value['const']}`"
    if "enum" in value:
        return ", ".join(f"`{item}`" for item in value["enum"])
    if value.get("type") == "array":
        return f"list of {_describe_type(value.get('items', {}), schema)}"
    return str(value.get("type", "any"))

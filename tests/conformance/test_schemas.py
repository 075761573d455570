"""The JSON Schemas: the shipped files are those of the models, and every file of the library follows its schema."""

import json
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator, validate
from typer.testing import CliRunner

from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.command_line.app import app
from pantocheck.conformance.schemas import FORMAT_NAMES, build_schema, format_schema

FOLDER = library_folder() / "schema"
LIBRARY = [path for path in library_folder().rglob("*.toml") if path.name != "sources.toml"]


@pytest.mark.parametrize("name", FORMAT_NAMES)
def test_shipped_schema_is_that_of_the_model(name: str) -> None:
    schema = build_schema(name)
    Draft202012Validator.check_schema(schema)
    assert json.loads(format_schema(schema)) == schema
    shipped = (FOLDER / f"{name}.schema.json").read_text(encoding="utf-8")
    # Versions of pydantic write 0 or 0.0; both are the same number.
    assert json.loads(shipped) == schema, "run: pantocheck schema --out reference_cases/schema"
    assert CliRunner().invoke(app, ["schema", name]).output == format_schema(schema)


def test_folder_holds_the_schemas_of_all_formats_and_nothing_else() -> None:
    assert {path.name for path in FOLDER.iterdir()} == {f"{name}.schema.json" for name in FORMAT_NAMES}


@pytest.mark.parametrize("name", FORMAT_NAMES)
def test_schema_is_self_contained(name: str) -> None:
    """TOML editors follow references within a file, but not to another file."""
    schema = build_schema(name)
    for reference in _references(schema):
        assert reference.removeprefix("#/$defs/") in schema["$defs"]


@pytest.mark.parametrize("path", LIBRARY, ids=lambda path: str(path.relative_to(library_folder())))
def test_file_of_the_library_follows_the_schema_that_it_names(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    named = re.match(r"#:schema (\S+)\n", text)
    assert named is not None
    validate(tomllib.loads(text), json.loads((path.parent / named[1]).read_text(encoding="utf-8")))


def _references(value: Any) -> Iterator[str]:
    if isinstance(value, dict):
        yield from (target for key, target in value.items() if key == "$ref" and isinstance(target, str))
        for item in value.values():
            yield from _references(item)
    elif isinstance(value, list):
        for item in value:
            yield from _references(item)

"""JSON Schemas: the kept files are those of the models, and the files of the library follow them."""

import json
import re
import tomllib
from collections.abc import Iterator
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from helpers.command_line import pantocheck
from pantocheck.conformance.app.schemas import FORMAT_NAMES, READ_FORMATS, build_schema, format_schema
from pantocheck.conformance.line.library_folder import library_folder

FOLDER = library_folder() / "schema"
COMPUTED = {library_folder() / name for name in ("converged", "resolving-power", "conditions")}
LIBRARY = [
    path
    for path in library_folder().rglob("*.toml")
    if path.name not in ("sources.toml", "model_uncertainty.toml", "places.toml") and COMPUTED.isdisjoint(path.parents)
]


@pytest.mark.parametrize("name", FORMAT_NAMES)
def test_schema_is_valid_and_self_contained(name: str) -> None:
    """TOML editors follow references within a file, but not to another file."""
    schema = build_schema(name)
    Draft202012Validator.check_schema(schema)
    assert json.loads(format_schema(schema)) == schema
    for reference in _references(schema):
        assert reference.removeprefix("#/$defs/") in schema["$defs"]
    assert pantocheck("schema", name).output == format_schema(schema)


def test_kept_schemas_are_those_of_the_models() -> None:
    kept = {path.name.removesuffix(".schema.json"): json.loads(path.read_text("utf-8")) for path in FOLDER.iterdir()}
    # Versions of pydantic write 0 or 0.0; both are the same number.
    stale = {name for name in READ_FORMATS if kept.get(name) != build_schema(name)}
    assert not stale, "run for each: pantocheck schema NAME --out reference_cases/schema"
    assert kept.keys() == READ_FORMATS.keys()


def test_files_of_the_library_follow_the_schema_that_they_name() -> None:
    named = {path: re.match(r"#:schema (\S+)\n", path.read_text("utf-8")) for path in LIBRARY}
    problems = []
    for path, header in named.items():
        if header is None:
            problems.append(f"{path}: names no schema")
            continue
        schema = json.loads((path.parent / header[1]).read_text("utf-8"))
        content = tomllib.loads(path.read_text("utf-8"))
        problems += [f"{path}: {error.message}" for error in Draft202012Validator(schema).iter_errors(content)]
    assert not problems, "\n".join(problems)


def _references(value: Any) -> Iterator[str]:
    if isinstance(value, dict):
        yield from (target for key, target in value.items() if key == "$ref" and isinstance(target, str))
        for item in value.values():
            yield from _references(item)
    elif isinstance(value, list):
        for item in value:
            yield from _references(item)

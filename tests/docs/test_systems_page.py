"""The conversation in docs/systems.md follows the schemas and shows the current case of the library."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.runs.command_system import build_case_message

PAGE = Path(__file__).parents[2] / "docs" / "systems.md"


def test_conversation_follows_the_schemas() -> None:
    example = PAGE.read_text(encoding="utf-8").split("## Example of a conversation")[1].split("```")[1]
    messages = [(line[0], json.loads(line[2:])) for line in example.strip().splitlines()]
    assert [message["message"] for _, message in messages] == ["start", "started", "run", "delivered", "stop"]
    for side, message in messages:
        jsonschema.validate(message, build_schema("command-request" if side == ">" else "command-answer"))
    (case,) = select_cases(["en50318-2002/250"])
    expected = build_case_message(case)
    sent = expected | {"derived": shorten_lists(expected["derived"])}
    shown, current = list_values(messages[2][1]["case"]), list_values(sent)
    assert shown.keys() == current.keys(), f"the page shows an older case: put {json.dumps(sent)} there"
    for key, value in current.items():
        # Derived values are solved, so that their sixth digit depends on the platform.
        assert shown[key] == (pytest.approx(value, rel=1e-5) if isinstance(value, float) else value), key


def test_page_describes_every_derived_key() -> None:
    """Every key of the derived values ends a name in backticks."""
    text = PAGE.read_text(encoding="utf-8")
    tables = {name: table for name, table in build_schema("command-request")["$defs"].items() if "Derived" in name}
    missing = [key for table in tables.values() for key in table["properties"] if f"{key}`" not in text]
    assert missing == []


def shorten_lists(tree: Any) -> Any:
    """Nested tables whose lists keep two entries."""
    if isinstance(tree, dict):
        return {key: shorten_lists(value) for key, value in tree.items()}
    return [shorten_lists(value) for value in tree[:2]] if isinstance(tree, list) else tree


def list_values(tree: Any, path: str = "") -> dict[str, Any]:
    """Values of nested tables and lists by their path."""
    if not isinstance(tree, dict | list):
        return {path: tree}
    items = tree.items() if isinstance(tree, dict) else enumerate(tree)
    return {key: value for name, part in items for key, value in list_values(part, f"{path}.{name}").items()}

"""The conversation in docs/systems.md follows the schemas and shows the current case of the library."""

import json
from pathlib import Path

import jsonschema

from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.runs.command_system import build_case_message

PAGE = Path(__file__).parents[2] / "docs" / "systems.md"


def test_conversation_follows_the_schemas() -> None:
    example = PAGE.read_text(encoding="utf-8").split("## Example of a conversation")[1].split("```")[1]
    messages = [(line[0], json.loads(line[2:])) for line in example.strip().splitlines()]
    assert [message["message"] for _, message in messages] == ["start", "started", "run", "delivered", "stop"]
    (case,) = select_cases(["en50318-2002/250"])
    sent, shown = build_case_message(case), messages[2][1]["case"]
    assert shown.pop("...") == "..."
    assert shown == {key: sent[key] for key in shown}, "the page shows an older case"
    messages[2][1]["case"] = sent
    for side, message in messages:
        jsonschema.validate(message, build_schema("command-request" if side == ">" else "command-answer"))


def test_page_describes_every_derived_key() -> None:
    """Every key of the derived values ends a name in backticks."""
    text = PAGE.read_text(encoding="utf-8")
    tables = {name: table for name, table in build_schema("command-request")["$defs"].items() if "Derived" in name}
    missing = [key for table in tables.values() for key in table["properties"] if f"{key}`" not in text]
    assert missing == []

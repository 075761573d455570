"""The conversation in docs/systems.md follows the schemas and shows the current case of the library."""

import json
from pathlib import Path

import jsonschema

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.schemas import build_schema
from pantocheck.conformance.systems.command.case_message import build_case_message

PAGE = Path(__file__).parents[2] / "docs" / "systems.md"


def test_conversation_follows_the_schemas() -> None:
    example = PAGE.read_text(encoding="utf-8").split("## Example of a conversation")[1].split("```")[1]
    messages = [(line[0], json.loads(line[2:])) for line in example.strip().splitlines()]
    assert [message["message"] for _, message in messages] == ["start", "started", "run", "delivered", "stop"]
    for side, message in messages:
        jsonschema.validate(message, build_schema("command-request" if side == ">" else "command-answer"))
    (case,) = select_cases(["en50318-2002/250"])
    assert messages[2][1]["case"] == build_case_message(case), (
        "the page shows an older case: put json.dumps(build_case_message(case)) there"
    )

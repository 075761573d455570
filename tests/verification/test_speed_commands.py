"""Budgets of the commands: every command has a row, and a row over its budget fails."""

import tomllib

import pytest

from pantocheck.conformance.app.commands.command_list import COMMANDS
from verification.speed import commands

ROWS = tomllib.loads(commands.COMMANDS.read_text("utf-8"))["command"]
WITHOUT_FILES = {"explore", "pantograph check", "runs import", "runs assess", "system rig", "view"}
"""Commands without a row: `explore` has no end, `view` is not measured yet, others need files or a rig."""


def test_every_command_has_a_budget() -> None:
    words = [row["words"] for row in ROWS]
    assert {name for name in COMMANDS if not any(f"{line} ".startswith(f"{name} ") for line in words)} == WITHOUT_FILES


@pytest.mark.parametrize(("excess", "code"), [(0.99, 0), (1.01, 1)])
def test_command_over_its_budget_fails(excess: float, code: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The reference loop takes 0.5 s here, and one row its whole budget, times 0.99 or 1.01."""
    slow = ROWS[len(ROWS) // 2]

    def measure(call: list[str], folder: object) -> tuple[float, float]:
        share = excess if call == commands.build_call(call[0], slow["words"]) else 0.0
        return 1.0, 0.5 if call[2] == commands.LOOP else 0.5 * share * slow["budget"]

    monkeypatch.setattr(commands, "measure", measure)
    monkeypatch.setattr(commands.subprocess, "run", lambda *_, **options: None)
    monkeypatch.setattr("sys.argv", ["commands", "--check"])
    assert commands.main() == code

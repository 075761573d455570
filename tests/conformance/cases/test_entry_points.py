"""Ways to start the command: `python -m pantocheck`, and the completion of a shell."""

import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.cases.library import list_library
from pantocheck.conformance.line.library_folder import library_folder

CHECKOUT = Path(__file__).parents[3]


def complete(*words: str) -> list[str]:
    """Answers to a request of bash to complete the last word."""
    environment = {
        "COMP_WORDS": " ".join(("pantocheck", *words)),
        "COMP_CWORD": str(len(words)),
        "_PANTOCHECK_COMPLETE": "complete_bash",
    }
    return CliRunner().invoke(app, [], env=environment, prog_name="pantocheck").stdout.splitlines()


def test_module_runs_the_command() -> None:
    """A checkout that is not installed finds `pantocheck/__main__.py` in the current folder."""
    command = [sys.executable, "-m", "pantocheck", "--version"]
    ended = subprocess.run(command, cwd=CHECKOUT, capture_output=True, text=True, check=True)
    assert ended.stdout.startswith("pantocheck ")


def test_launcher_leaves_the_name_a_namespace() -> None:
    """An `__init__.py` would hide the packages `pantocheck.*` of a checkout, and of extensions."""
    assert [path.name for path in (CHECKOUT / "pantocheck").glob("*.py")] == ["__main__.py"]


def test_shell_completes_commands() -> None:
    assert complete("comp") == ["compare"]


def test_shell_completes_options() -> None:
    assert complete("simulate", "--o") == ["--out"]


@pytest.mark.parametrize("words", [("show",), ("compare", "a.csv", "--case")])
def test_shell_completes_cases(words: tuple[str, ...]) -> None:
    expected = [name for name in list_library(library_folder()) if name.startswith("en50318-2002/")]
    assert len(expected) == 2
    assert complete(*words, "en50318-2002/") == expected

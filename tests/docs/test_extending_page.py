"""The page on cases from outside: its files are valid and its commands run."""

import re
import shlex
import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from helpers.wave_system import Wave
from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.cases.case_source import GROUP
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.records.record_writing import write_record

PAGE = (Path(__file__).parents[2] / "docs" / "extending.md").read_text(encoding="utf-8")


def find_blocks(heading: str, language: str) -> list[str]:
    """Code blocks of a language in the section with a heading."""
    section = PAGE.split(f"## {heading}\n")[1].split("\n## ")[0]
    return re.findall(rf"```{language}\n(.*?)```", section, re.DOTALL)


def test_commands_for_a_folder_of_cases_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (case,) = find_blocks("A folder of cases", "toml")
    Path("my-cases").mkdir()
    Path("my-cases/fast.toml").write_text(case)
    loaded = load_case(Path("my-cases/fast.toml"))
    write_record(Path("my-records/fast.csv"), Wave().record(loaded), loaded.id)
    (commands,) = find_blocks("A folder of cases", "bash")
    for command in commands.splitlines():
        done = CliRunner().invoke(app, shlex.split(command)[1:])
        # The case has no limits, so that its verdict is informative.
        assert done.exit_code == (3 if " run " in command else 0), (command, done.output, done.stderr)


def test_entry_points_of_the_page_exist() -> None:
    blocks = re.findall(r"```toml\n((?:.*\n)*?)```", PAGE)
    projects = [tomllib.loads(block).get("project", {}) for block in blocks]
    named = {name for project in projects for name in project.get("entry-points", {})}
    assert named == {GROUP}

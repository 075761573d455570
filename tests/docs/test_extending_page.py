"""The page on extensions: its files are valid and its commands run."""

import re
import shlex
import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from helpers.example_plug_in import EXAMPLE, install_example
from helpers.wave_system import Wave
from pantocheck.conformance import extension
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.command_line.app import app
from pantocheck.conformance.plug_ins.plug_in import GROUPS
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
        assert done.exit_code == (1 if " run " in command else 0), (command, done.output, done.stderr)


def test_programs_of_the_page_are_those_of_the_example() -> None:
    """The tests of plug-ins run the files of the example."""
    files = {file.read_text("utf-8") for file in (*EXAMPLE.rglob("*.py"), EXAMPLE / "pyproject.toml")}
    blocks = re.findall(r"```(?:python|toml)\n(.*?)```", PAGE, re.DOTALL)
    programs = [block for block in blocks if "import " in block or "build-system" in block]
    assert len(programs) == 4
    assert set(programs) <= files


def test_command_for_a_system_runs(site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install_example(site)
    monkeypatch.chdir(tmp_path)
    (command,) = find_blocks("A system", "bash")
    done = CliRunner().invoke(app, [*shlex.split(command)[1:], "--formats", "json,md"])
    # The record has no uplift and no height, so that it is unverified.
    assert (done.exit_code, done.output.split()[0]) == (1, "UNVERIFIED"), done.stderr


def test_public_names_of_the_page_exist() -> None:
    named = set(re.findall(r"^\| `pantocheck\.\w+` \|.*\| `(\w+)` \|$", PAGE, re.MULTILINE))
    assert named == {"TableReader", "ForceQuantity", "SystemFactory"}
    assert named <= set(extension.__all__)
    assert all(getattr(extension, name).__doc__ for name in extension.__all__)


def test_entry_points_of_the_page_exist() -> None:
    blocks = re.findall(r"```toml\n((?:.*\n)*?)```", PAGE)
    projects = [tomllib.loads(block).get("project", {}) for block in blocks]
    named = {name for project in projects for name in project.get("entry-points", {})}
    assert named == {*GROUPS.values()}

"""Width of the output: no line is longer than the terminal, and no name of a quantity or case is cut."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from helpers.command_line import pantocheck
from pantocheck.conformance.app.commands.console import LONGEST_WORD
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.records.record_writing import write_record

COMMANDS = {
    "cases": ["cases"],
    "show": ["show", "en50318-2002/*"],
    "static": ["show", "en50318-2018/ac-stitched/static", "--derived"],
    "doctor": ["doctor"],
    "check": ["check", "records"],
    "describe": ["describe", "records/250.csv"],
    "run": ["run", "en50318-2002/*", "--system", "record:records", "--out", "out", "--formats", "json", "-v"],
    "assess": ["assess", "records/250.toml", "--profile", "acceptance-ac", "--out", "out", "--formats", "json"],
    "compare": ["compare", "records/250.csv", "records/300.csv"],
}


@pytest.fixture(scope="module")
def records(wave: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with records of both cases."""
    folder = tmp_path_factory.mktemp("workplace") / "records"
    for case in select_cases(["en50318-2002/*"]):
        write_record(folder / f"{case.file.speed_km_h:g}.csv", wave().record(case), case.id)
    return folder


@pytest.fixture
def workplace(records: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Parent of the records as the current folder: paths of the user are short."""
    monkeypatch.chdir(records.parent)


@pytest.mark.usefixtures("workplace")
@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("width", [60, 80])
def test_no_line_is_longer_than_the_terminal(command: str, width: int) -> None:
    done = pantocheck(*COMMANDS[command], COLUMNS=str(width))
    assert done.exit_code in {0, 1}, done.output
    # Lines of the log are not wrapped outside a terminal, so that a search finds them.
    long = [line for line in done.stdout.splitlines() if len(line) > width]
    assert [line for line in long if not line.startswith("  pantocheck describe ")] == []  # a command to be copied
    assert "…" not in done.output
    assert not re.search(r"\w\.\.\.", done.output)


@pytest.mark.usefixtures("workplace")
def test_names_are_whole() -> None:
    """Every graded quantity and case of a run is found by its name, which a cut or a break would hide."""
    results = json.loads(pantocheck(*COMMANDS["run"][:-1], "--json", COLUMNS="60").stdout)["result"]
    names = {criterion["quantity"] for case in results["cases"] for criterion in case["criteria"]}
    assert len(names) > 5
    for width in ("60", "80"):
        shown = pantocheck(*COMMANDS["run"], COLUMNS=width).output
        assert {name for name in names | {case["id"] for case in results["cases"]} if name not in shown} == set()


def test_output_to_a_file_has_80_columns_and_no_name_is_longer_than_a_whole_word(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert max(map(len, QUANTITIES)) < LONGEST_WORD
    monkeypatch.delenv("COLUMNS", raising=False)
    lines = pantocheck("cases").output.splitlines()
    assert max(map(len, lines)) == 80

"""The page "Your own line": every command runs in the order of the page, and prints what the page shows."""

import csv
import re
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.cases.library import load_case

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "your-own-line.md").read_text(encoding="utf-8")

COARSE = "\n[discretisation]\nelement_m = 2.0\ntime_step_s = 0.004\n"
"""Mesh of the test: the commands of the page then take seconds."""

EXIT_CODES = {"run my-case.toml --out report": (3, 0)}
"""Exit codes of a command at its first and second place; 0 for other commands, and 3 for a run without limits."""


def list_blocks() -> list[tuple[str, str]]:
    """Language and text of all code blocks, in their order."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)


def pantocheck(line: str) -> tuple[int, str]:
    """Exit code and output of a command line of the page; messages belong to the output of an error only."""
    program, *arguments = shlex.split(line)
    assert program == "pantocheck"
    result = CliRunner().invoke(app, arguments)
    return result.exit_code, result.output if result.exit_code == 2 else result.stdout


def replace_spans(line: Path, block: str) -> None:
    """Replace `span_list` of a line file by that of a block."""
    text, count = re.subn(r"^span_list = \[.*?^\]\n", block, line.read_text(), flags=re.DOTALL | re.MULTILINE)
    assert count == 1
    line.write_text(text)


@pytest.fixture(scope="module")
def outputs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[str]]:
    """Outputs of every command of the page, run in a new folder; the edits of the page are made between them."""
    folder = tmp_path_factory.mktemp("own")
    printed: dict[str, list[str]] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for language, text in list_blocks()[1:]:
            if language == "toml" and text.startswith("span_list"):
                replace_spans(folder / "my-line.toml", text)
            elif language == "toml" and text.startswith("[[geometry.support]]"):
                line = (folder / "my-line.toml").read_text()
                (folder / "my-line.toml").write_text(line.replace("\n[contact_wire]", f"\n{text}\n[contact_wire]", 1))
            elif language == "toml":
                with (folder / "my-case.toml").open("a") as file:
                    file.write("\n" + text)
            for line in text.splitlines() if language == "sh" else ():
                code, output = pantocheck(line)
                earlier = printed.setdefault(line, [])
                expected = EXIT_CODES.get(line.removeprefix("pantocheck "), (3 if " run " in line else 0,))
                assert code == expected[len(earlier)], (line, output)
                earlier.append(output)
                if line.startswith("pantocheck new case"):
                    (folder / "my-case.toml").write_text((folder / "my-case.toml").read_text() + COARSE)
    printed["folder"] = [str(folder)]
    return printed


def test_every_command_of_the_page_runs_and_prints_what_it_shows(outputs: dict[str, list[str]]) -> None:
    """The continuous integration runs the installation of the README in a fresh environment."""
    install = list_blocks()[0][1].splitlines()[0]
    assert install in (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(outputs) >= 10
    folder = Path(outputs["folder"][0])
    for name in ("certificate.html", "certificate.pdf", "quantities.csv", "results.json"):
        assert (folder / "report" / name).stat().st_size > 1000
    for name in ("my-line.svg", "records/my-case.csv", "records/my-case.toml", "records/140-N.csv"):
        assert (folder / name).stat().st_size > 500
    (printed,) = outputs["pantocheck check my-line.toml my-pantograph.toml my-case.toml"]
    lines = "".join(f"{line.rstrip()}\n" for line in printed.splitlines())  # a wrapped line may end with a blank
    assert lines in [text for language, text in list_blocks() if language == ""]
    rows = list(csv.DictReader((folder / "report-200" / "quantities.csv").read_text().splitlines()))
    assert {row["changes"] for row in rows} == {
        "speed_km_h = 200 (file: 250.0); line.contact_wire.tension_N = 22000.0 (file: 20000.0)"
    }
    without, with_limit = outputs["pantocheck run my-case.toml --out report"]
    assert without.startswith("INFO")
    assert re.search(r"^mean_force_N +1\d\d", without, re.MULTILINE)
    assert with_limit.startswith("PASS own/my-case  1 of 1 values inside")
    assert "limits of the user" in " ".join(with_limit.split())
    values = {"span_list": "61", "masses_kg": "[14.0, 7.0]", "speed_km_h": "300", "tension_N": "18e3"}
    table = re.findall(r"^\| `([^`]+)` \| (?:a|an|the) ", PAGE, re.MULTILINE)
    assert len(table) == 5
    for key in table:
        value = next((value for name, value in values.items() if name in key), "150")
        case = load_case(Path(outputs["folder"][0]) / "my-case.toml", parse_changes([f"{key}={value}"]))
        assert len(case.changes) == 1
    text = (folder / "my-line.toml").read_text()
    text = text.replace("50.0, droppers = { x_m = [5.0, 15.0, 25.0, 35.0, 45.0] }", '50.0, droppers = "short"')
    text = text.replace("40.2, 49.0]", "40.2, 52.0]").replace("tension_N = 20000.0", "tension_kN = 20", 1)
    (folder / "wrong").mkdir()
    (folder / "wrong" / "my-line.toml").write_text(text)
    code, output = pantocheck(f"pantocheck check {folder}/wrong/my-line.toml")
    assert code == 2
    messages = output.rpartition("2 problems")[0]
    assert messages in [text for language, text in list_blocks() if language == ""]

"""Options -v, -q, --json and --no-color: one meaning for every command, before and after its name."""

import json
import logging
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from helpers.case_fixtures import EditedCase
from helpers.command_line import pantocheck
from pantocheck.conformance.app.commands import console
from pantocheck.conformance.app.commands.output_settings import OutputSettings, combine_flags, use_settings
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.records.record_writing import write_record


@pytest.fixture
def records(wave: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Folder `records` in the current one, with a record of 250 km/h."""
    monkeypatch.chdir(tmp_path)
    (case,) = select_cases(["en50318-2002/250"])
    write_record(Path("records", "250.csv"), wave().record(case), case.id)


OPTIONS = ("--system", "record:records", "--out", "out", "--formats", "json")
run = partial(pantocheck, "run", "en50318-2002/250", *OPTIONS)


@pytest.mark.usefixtures("records")
def test_verbose_prints_all_values_and_quiet_the_verdict_alone() -> None:
    done = run("-q")
    assert done.exit_code == 1
    assert done.stdout.startswith("FAIL ")
    assert "criterion" not in done.stdout
    assert "results.json" not in done.stdout
    assert done.stderr == ""
    failed = pantocheck("-q", "show", "none/250")
    assert (failed.exit_code, failed.stdout) == (2, "")
    assert "none/250" in failed.stderr
    # The quantity has no limit. The log goes to standard error with the name of the module.
    plain, verbose = run(), run("-v")
    assert "contact_height_range_mm" not in plain.stdout
    assert "contact_height_range_mm" in verbose.stdout
    assert plain.stderr == ""
    assert "pantocheck.conformance.execution.runner: en50318-2002/250: fail" in verbose.stderr


@pytest.mark.usefixtures("records")
def test_json_is_one_object_for_results_and_failures() -> None:
    done = run("--json")
    content = json.loads(done.stdout)
    assert (content["schema"], content["command"], content["exit_code"]) == ("pantocheck.output/1", "run", 1)
    assert done.exit_code == 1
    assert content["result"] == json.loads(Path("out", "results.json").read_text())
    assert content["files"] == [str(Path("out", "results.json"))]
    # The message stays on standard error.
    Path("line.toml").write_text("geometry = 3\n")
    done = pantocheck("line", "export", "line.toml", "--out", "tables", "--json")
    content = json.loads(done.stdout)
    assert (done.exit_code, content["exit_code"]) == (2, 2)
    assert content["problems"][0].keys() == {"where", "found", "hint"}
    assert content["problems"][0]["where"] in done.stderr


@pytest.mark.parametrize(
    "command",
    [
        ["cases"],
        ["show", "en50318-2002/250"],
        ["show", "en50318-2018/ac-simple/static", "--derived"],
        ["doctor"],
        ["schema", "case"],
        ["check", "records"],
        ["describe", "records/250.csv"],
        ["new", "line", "new.toml"],
        ["assess", "records/250.toml", "--profile", "acceptance-ac", "--out", "out", "--formats", "json"],
        ["compare", "records/250.csv", "records/250.csv"],
        ["line", "export", "en50318-2002/250", "--out", "tables"],
    ],
    ids=lambda command: command[0],
)
@pytest.mark.usefixtures("records")
def test_every_command_gives_its_result_as_json(command: list[str]) -> None:
    content = json.loads(pantocheck("--json", *command).stdout)
    assert content["command"] == " ".join(command[:2] if command[0] == "line" else command[:1])
    assert content["result"]


@pytest.mark.usefixtures("records")
def test_limit_of_another_pantograph_is_a_problem_of_the_limits() -> None:
    Path("own.toml").write_text('[[limit]]\nquantity = "std_force_N"\npantograph = 3\nupper = 30.0\n')
    done = pantocheck("assess", "records/250.toml", "--profile", "acceptance-ac", "--limits", "own.toml")
    assert (done.exit_code, "limit[1].pantograph: there is no pantograph 3" in done.stderr) == (2, True)


def test_options_count_before_and_after_the_command_and_must_agree() -> None:
    for arguments in (["--json", "cases"], ["cases", "--json"], ["--json", "cases", "--json"]):
        assert json.loads(pantocheck(*arguments).stdout)["command"] == "cases"
    done = pantocheck("-v", "cases", "-q")
    assert done.exit_code == 2
    assert "contradict" in done.stderr


def test_texts_of_a_file_stay_escaped(edited_case: EditedCase) -> None:
    """Neither a control sequence of a terminal, nor a mark that reverses text, reaches standard output."""
    path = edited_case("250.toml", {"title": "\x1b[31m\u202egpj.exe"})
    for form in ((), ("--json",)):
        text = pantocheck("show", path, *form).stdout
        assert ("\x1b" in text, "\u202e" in text, "gpj.exe" in text) == (False, False, True)


def test_no_color_leaves_no_bold_text(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TERM", "xterm-256color")
    assert "\x1b[1" in pantocheck("cases").stdout
    assert "\x1b" not in pantocheck("cases", "--no-color").stdout
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in pantocheck("cases").stdout


def test_library_is_silent_without_a_handler_and_settings_hold_while_a_command_runs(
    capfd: pytest.CaptureFixture[str],
) -> None:
    logging.getLogger("pantocheck.conformance.execution.runner").warning("a step")
    assert capfd.readouterr() == ("", "")
    settings = combine_flags({"quiet", "no_color"})
    assert settings == OutputSettings(detail="quiet", colour="none")
    with use_settings(settings):
        assert console.console().color_system is None
    assert combine_flags(()) == OutputSettings()

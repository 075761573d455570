"""The commands as a user meets them: exit codes, messages, and what is on disk afterwards."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import jsonschema
import pytest
import typer
from typer.testing import CliRunner

from pantocheck.conformance.cases.library import library_folder, select_cases
from pantocheck.conformance.command_line.app import app
from pantocheck.conformance.command_line.guard import guard_command
from pantocheck.conformance.records.record_reading import read_record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.schemas import build_schema
from pantocheck.model.failures import DidNotConverge, ImpossiblePassage, NoEquilibrium, NoInitialState


def pantocheck(*arguments: object):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture
def records(wave, tmp_path) -> Path:
    """Records of both cases: sines, whose extremes fail."""
    for case in select_cases(["en50318-2002/*"]):
        write_record(tmp_path / "records" / f"{case.file.speed_km_h:g}.csv", wave().record(case), case.id)
    return tmp_path / "records"


@pytest.fixture
def lenient(tmp_path) -> Path:
    """Limits that the sine of 250 km/h meets."""
    path = tmp_path / "lenient.toml"
    entry = '[[limit]]\nquantity = "{}"\nlower = 0.0\nupper = 300.0\ntrust = "primary"\nsource = "own"\n'
    path.write_text("".join(entry.format(name) for name in ("max_force_N", "min_force_N")))
    return path


def test_run_grades_records_and_writes_results(records, tmp_path):
    out = tmp_path / "out"
    done = pantocheck("run", "en50318-2002/*", "--system", f"record:{records}", "--out", out, "--formats", "json")
    assert done.exit_code == 1
    assert done.output.startswith("FAIL ")
    assert "16.4 N below the lower limit" in done.output
    assert str(out / "results.json") in done.output
    results = json.loads((out / "results.json").read_text())
    jsonschema.validate(results, build_schema("results"))
    assert [case["id"] for case in results["cases"]] == ["en50318-2002/250", "en50318-2002/300"]
    assert [path.name for path in out.iterdir()] == ["results.json"]


def test_run_passes_with_exit_code_0(records, lenient, tmp_path):
    done = pantocheck(
        "run", "en50318-2002/250", "--system", f"record:{records}", "--out", tmp_path / "out", "--formats", "json",
        "--limits", lenient,
    )  # fmt: skip
    assert (done.exit_code, done.output.split()[0]) == (0, "PASS")


def test_skipped_case_does_not_open_the_gate(records, lenient, tmp_path):
    (records / "300.toml").unlink()
    done = pantocheck(
        "run", "--system", f"record:{records}", "--out", tmp_path / "out", "--formats", "json", "--limits", lenient,
        "en50318-2002/250", "en50318-2002/300",
    )  # fmt: skip
    assert (done.exit_code, done.output.split()[0]) == (1, "SKIP")
    assert "there is no record of this case" in done.output


def test_plan_holds_the_options_and_the_command_line_goes_before_it(records, lenient, tmp_path):
    plan = tmp_path / "plan.toml"
    plan.write_text(
        'cases = ["en50318-2002/250"]\nsystem = "record:records"\nout = "planned"\n'
        'formats = ["json"]\nlimits = "lenient.toml"\n'
    )
    assert pantocheck("run", "--plan", plan).exit_code == 0
    assert (tmp_path / "planned" / "results.json").exists()
    assert pantocheck("run", "--plan", plan, "--out", tmp_path / "asked", "en50318-2002/300").exit_code == 1
    assert json.loads((tmp_path / "asked" / "results.json").read_text())["cases"][0]["id"] == "en50318-2002/300"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "en50318-2002/251"], "there is no such case.\n  Did you mean en50318-2002/250"),
        (["run", "--trust", "absolute"], "key trust: found 'absolute', expected 'primary'"),
        (["run", "--formats", "pdff"], "format 'pdff': there is no such format.\n  Did you mean pdf ?"),
        (["run", "--drift", "0"], "command line, key drift_pct"),
        (["assess", "a.csv", "--profile", "acceptance-ac", "--drift", "0"], "command line, key drift_pct"),
        (["assess", "a.csv", "--profile", "acceptance-ac", "--trust", "absolute"], "key trust: found 'absolute'"),
        (["assess", "a.csv", "--profile", "acceptance-ac", "--formats", "json, pdff"], "format 'pdff'"),
        (["run", "--jobs", "0"], "key jobs: 0 must be at least 1"),
        (["run", "--system", "magic"], "system 'magic': there is no such system"),
        (["run", "--plan", "none.toml"], "plan 'none.toml': cannot be read"),
        (["run", "none.toml"], "case 'none.toml': cannot be read"),
        (["show", "vovan2015/nothing"], "there is no such case"),
        (["schema", "cases"], "schema 'cases': there is no such format.\n  Did you mean case ?"),
        (["simulate", "en50318-2002/*", "--out", "a.csv"], "one case is simulated at a time"),
        (["simulate", "en50318-2002/250", "--out", "a.xls"], "the suffix '.xls' is no format"),
    ],
)
def test_bad_input_ends_with_one_message_and_exit_code_2(arguments, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = pantocheck(*arguments)
    assert done.exit_code == 2
    assert message in done.stderr
    assert done.stdout == ""
    assert list(tmp_path.iterdir()) == []


def test_self_test_of_no_run_at_all_is_not_passed():
    """A static case gives no mutants: 0 of 0 caught says nothing."""
    done = pantocheck("self-test", "en50318-2018/ac-simple/static")
    assert done.exit_code == 2
    assert "none of these is a run" in done.output


def test_self_test_notices_a_folder_that_cannot_be_written_before_it_computes(tmp_path, monkeypatch):
    from pantocheck.conformance.self_test import bench as self_test

    monkeypatch.setattr(self_test, "run_self_test", lambda *_: pytest.fail("computed"))
    (tmp_path / "file").write_text("")
    done = pantocheck("self-test", "--markdown", tmp_path / "file" / "page.md")
    assert done.exit_code == 2
    assert "cannot be written" in done.output


def test_self_test_prints_no_control_characters_of_a_path(tmp_path, monkeypatch):
    from pantocheck.conformance.self_test import bench as self_test

    monkeypatch.setattr(self_test, "run_self_test", lambda *_: self_test.SelfTest({}, (), ()))
    done = pantocheck("self-test", "--markdown", tmp_path / "[red]page\x1b.md")
    assert "[red]page?.md" in done.output


@pytest.mark.parametrize("command", [("show", "--at-rest"), ("show", "--drawing"), ("simulate", "--out")])
def test_line_without_an_equilibrium_ends_with_one_message_and_exit_code_2(command, tmp_path):
    """A contact wire that is to hang 2 m low in every span would have droppers that push."""
    for name in ("line.toml", "250.toml", "pantograph.toml"):
        text = (library_folder() / "en50318-2002" / name).read_text()
        (tmp_path / name).write_text(re.sub(r"presag_m *= .*", f"presag_m = {[2.0] * 9}", text))
    name, option = command
    file = () if option == "--at-rest" else (tmp_path / ("line.svg" if name == "show" else "out.csv"),)
    done = pantocheck(name, tmp_path / "250.toml", option, *file)
    assert done.exit_code == 2
    assert "Check the line's data." in done.output


def test_error_of_the_program_itself_is_not_taken_for_one_of_the_input():
    def broken():
        raise ValueError("a mistake of the program")

    with pytest.raises(ValueError, match="a mistake of the program"):
        guard_command(broken)()


@pytest.mark.parametrize(
    "error",
    [failure("no state") for failure in (NoInitialState, NoEquilibrium, ImpossiblePassage, DidNotConverge)],
    ids=lambda error: type(error).__name__,
)
def test_every_failure_of_the_simulation_is_a_message(error, capsys):
    def fails():
        raise error

    with pytest.raises(typer.Exit) as ended:
        guard_command(fails)()
    assert ended.value.exit_code == 2
    assert capsys.readouterr().err == "no state\n  Check the line's data.\n"


def test_folder_that_cannot_be_written_is_noticed_before_anything_is_computed(records, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setattr("pantocheck.conformance.runner.run_cases", None)  # calling it would be a TypeError
    done = pantocheck("run", "--system", f"record:{records}", "--out", tmp_path / "file" / "out")
    assert done.exit_code == 2
    assert "cannot be written" in done.stderr


def test_interrupted_run_writes_what_was_finished(records, tmp_path, monkeypatch):
    from pantocheck.conformance.systems.record_folder import RecordFolder

    read = RecordFolder.run

    def interrupted(self, case):
        if case.id.endswith("300"):
            raise KeyboardInterrupt
        return read(self, case)

    monkeypatch.setattr(RecordFolder, "run", interrupted)
    done = pantocheck("run", "en50318-2002/*", "--system", f"record:{records}", "--out", tmp_path, "--formats", "json")
    assert done.exit_code == 130
    assert "Interrupted" in done.stderr
    results = json.loads((tmp_path / "results.json").read_text())
    assert [case["verdict"] for case in results["cases"]] == ["fail", "skip"]
    assert len(results["cases"][0]["criteria"]) == 8


def test_simulate_writes_a_record_that_can_be_graded(records, tmp_path):
    out = tmp_path / "again" / "a.h5"
    done = pantocheck("simulate", "en50318-2002/250", "--system", f"record:{records}", "--out", out)
    assert done.exit_code == 0
    record, sidecar = read_record(tmp_path / "again" / "a.h5")
    assert (sidecar.case, record.pantographs) == ("en50318-2002/250", 1)


def test_cases_and_show_tell_trust_and_source():
    listed = pantocheck("cases").output
    assert "en50318-2002/250" in listed
    assert "8 secondary" in listed
    shown = pantocheck("show", "en50318-2002/250").output
    for text in ("provisional", "Wang, Liu, Mu", "max_uplift_at_support_mm", "masses_kg", "15.0, 7.2", "sha256:"):
        assert text in shown


def test_control_characters_of_a_file_do_not_reach_the_terminal(own_case):
    path = own_case("250.toml", 'title = "EN', 'title = "\\u001b[31m[bold]EN')
    shown = pantocheck("show", path).output
    assert "\x1b" not in shown
    assert "[31m[bold]EN" in shown


def test_help_loads_nothing_heavy():
    code = (
        "import sys; from pantocheck.conformance.command_line.app import app\n"
        "try: app(['run', '--help'])\nexcept SystemExit: pass\n"
        "print(sorted({'numpy', 'scipy', 'numba', 'matplotlib', 'typst', 'h5py'} & set(sys.modules)))"
    )
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=True)
    assert done.stdout.splitlines()[-1] == "[]"

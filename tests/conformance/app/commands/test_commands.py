"""Commands: exit codes, messages and files."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import typer

from helpers.case_fixtures import EditedCase
from helpers.command_line import SKIPPER, pantocheck
from pantocheck.conformance.app.commands import line_file_command, run_command, system_self_test_command
from pantocheck.conformance.app.commands.command_list import COMMANDS
from pantocheck.conformance.app.commands.guard import guard_command
from pantocheck.conformance.app.schemas import READ_FORMATS, WRITTEN_FORMATS, build_schema
from pantocheck.conformance.app.self_test.mutants import SelfTest
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import list_library, select_cases
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.record_reading import read_record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.runs.record_folder import RecordFolder
from pantocheck.conformance.runs.system import Outcome
from pantocheck.conformance.runs.uplift_tuning import TuningFailed
from pantocheck.model.description.failures import DidNotConverge, ImpossiblePassage, NoEquilibrium, NoInitialState
from pantocheck.model.dynamics.core_choice import choose_core


@pytest.fixture
def records(wave: Any, tmp_path: Path) -> Path:
    """Records of both cases with a sinusoidal force, which fails the limits of the extremes."""
    for case in select_cases(["en50318-2002/*"]):
        write_record(tmp_path / "records" / f"{case.file.speed_km_h:g}.csv", wave().record(case), case.id)
    return tmp_path / "records"


@pytest.fixture
def lenient(tmp_path: Path) -> Path:
    """Limits that the sinusoidal force at 250 km/h meets."""
    path = tmp_path / "lenient.toml"
    entry = '[[limit]]\nquantity = "{}"\nlower = 0.0\nupper = 300.0\ntrust = "primary"\nsource = "own"\n'
    path.write_text("".join(entry.format(name) for name in ("max_force_N", "min_force_N")))
    return path


def test_run_grades_records_and_writes_results(records: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    result = pantocheck("run", "en50318-2002/*", "--system", f"record:{records}", "--out", out, "--formats", "json")
    assert result.exit_code == 1
    lines = result.output.splitlines()
    assert lines[0].startswith("FAIL en50318-2002/250  6 of 8 values inside")
    assert any(line.startswith("FAIL 0 of 2 cases pass") for line in lines[1:])
    assert "16.4 N below the lower limit" in result.output
    assert str(out / "results.json") in result.output
    results = json.loads((out / "results.json").read_text())
    jsonschema.validate(results, build_schema("results"))
    assert [case["id"] for case in results["cases"]] == ["en50318-2002/250", "en50318-2002/300"]
    assert [path.name for path in out.iterdir()] == ["results.json"]


def test_skipped_case_counts_and_widened_limits_do_not(records: Path, lenient: Path, tmp_path: Path) -> None:
    (records / "300.toml").unlink()
    options = ("--system", f"record:{records}", "--out", tmp_path / "out", "--formats", "json", "--limits", lenient)
    command = ("run", *options, "--verdicts", "criteria", "en50318-2002/250")
    passed, skipped = pantocheck(*command), pantocheck(*command, "en50318-2002/300")
    assert (passed.exit_code, passed.output.split()[0]) == (3, "INFO")  # widened limits of the library
    assert (skipped.exit_code, "\nSKIP 0 of 2 cases" in skipped.output) == (1, True)
    assert "there is no record of this case" in skipped.output


def test_option_of_the_command_line_replaces_that_of_the_plan(records: Path, lenient: Path, tmp_path: Path) -> None:
    plan = tmp_path / "plan.toml"
    plan.write_text(
        'cases = ["en50318-2002/250"]\nsystem = "record:records"\nout = "planned"\n'
        'formats = ["json"]\nlimits = "lenient.toml"\nverdicts = "criteria"\n'
    )
    assert pantocheck("run", "--plan", plan).exit_code == 3  # widened limits of the library
    assert pantocheck("run", "--plan", plan, "--verdicts", "both").exit_code == 1  # a sine is not the solution
    assert (tmp_path / "planned" / "results.json").exists()
    assert pantocheck("run", "--plan", plan, "--out", tmp_path / "replaced", "en50318-2002/300").exit_code == 1
    assert json.loads((tmp_path / "replaced" / "results.json").read_text())["cases"][0]["id"] == "en50318-2002/300"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "en50318-2002/251"], "there is no case with this id.\n  Did you mean en50318-2002/250"),
        (["run", "--trust", "absolute"], "option --trust: found 'absolute', expected 'primary'"),
        (["run", "--formats", "pdff"], "format 'pdff': there is no such format.\n  Did you mean pdf ?"),
        (["run", "--drift", "0"], "option --drift: 0 must be greater than 0"),
        (["assess", "a.csv", "--profile", "acceptance-ac", "--drift", "0"], "option --drift: 0 must be greater than 0"),
        (["assess", "a.csv", "--profile", "acceptance-ac", "--trust", "absolute"], "option --trust: found 'absolute'"),
        (["assess", "a.csv", "--profile", "acceptance-ac", "--formats", "json, pdff"], "format 'pdff'"),
        (["run", "--jobs", "0"], "option --jobs: 0 must be at least 1"),
        (["run", "--system", "magic"], "system 'magic': there is no such system"),
        (["run", "--plan", "none.toml"], "plan 'none.toml': cannot be read"),
        (["run", "none.toml"], "case 'none.toml': cannot be read"),
        (["show", "vovan2015/nothing"], "there is no case with this id"),
        (["schema", "cases"], "schema 'cases': there is no such format.\n  Did you mean case ?"),
        (
            ["simulate", "en50318-2002/*", "--out", "a.csv"],
            "case with a train, found en50318-2002/250, en50318-2002/300",
        ),
        (["simulate", "en50318-2002/250", "--out", "a.xls"], "has the unknown suffix '.xls'"),
    ],
)
def test_bad_input_ends_with_one_message_and_exit_code_2(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = pantocheck(*arguments)
    assert result.exit_code == 2
    assert message in result.stderr
    assert result.stdout == ""
    assert list(tmp_path.iterdir()) == []


def test_self_test_tests_every_selected_case_with_a_train(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both speeds by default. A static case has no mutants, and 0 of 0 detected must not pass: it is left out."""
    result = pantocheck("system", "self-test", "en50318-2018/ac-simple/static")
    assert result.exit_code == 2
    assert "no case with a train is selected" in result.output
    # Both speeds by default; the static case of a selection is left out.
    tested: list[list[str]] = []

    def run(cases: list[Case], _: object) -> SelfTest:
        tested.append([case.id for case in cases])
        return SelfTest({"en50318-2002/300": ("fail", "a limit")} if len(tested) > 1 else {}, (), ())

    monkeypatch.setattr(system_self_test_command, "run_self_test", run)
    monkeypatch.setattr(system_self_test_command, "run_numerical_faults", lambda *_: ())
    assert pantocheck("system", "self-test").exit_code == 0
    assert pantocheck("system", "self-test", "en50318-2018/ac-stitched/*").exit_code == 1, "the reference must pass"
    assert tested == [
        ["en50318-2002/250", "en50318-2002/300"],
        ["en50318-2018/ac-stitched/275", "en50318-2018/ac-stitched/320"],
    ]


@pytest.mark.parametrize(
    "command", [("show", "--at-rest"), ("show", "--derived"), ("line", "draw", "--out"), ("simulate", "--out")]
)
def test_line_without_an_equilibrium_ends_with_one_message_and_exit_code_2(
    command: tuple[str, ...], edited_case: EditedCase, tmp_path: Path
) -> None:
    """A pre-sag of 2 m in every span requires droppers in compression: there is no equilibrium."""
    path = edited_case("line.toml", {"droppers.presag_m": [2.0] * 9})
    *name, option = command
    file = () if option in {"--at-rest", "--derived"} else (tmp_path / ("line.svg" if "draw" in name else "out.csv"),)
    result = pantocheck(*name, path, option, *file)
    assert result.exit_code == 2
    assert "Check the data of the line" in result.output


def fail_with(error: BaseException) -> Callable[[], None]:
    """Command that raises an error."""

    def command() -> None:
        raise error

    return guard_command(command)


def test_internal_error_is_a_message_with_a_traceback_on_request_only(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for requested in (False, True):
        if requested:
            monkeypatch.setenv("PANTOCHECK_TRACEBACK", "1")
        with pytest.raises(typer.Exit) as ended:
            fail_with(ValueError("a mistake\x1b of the program"))()
        assert ended.value.exit_code == 2
        message = capsys.readouterr().err
        assert "internal error: ValueError: a mistake? of the program\n" in message
        assert "PANTOCHECK_TRACEBACK=1" in message
        assert message.startswith("Traceback" if requested else "internal error")


CHECK_DATA = "no state\n  Check the data of the line and of the pantographs.\n"


@pytest.mark.parametrize(
    ("error", "exit_code", "message"),
    [
        *((kind("no state"), 2, CHECK_DATA) for kind in (NoInitialState, NoEquilibrium, ImpossiblePassage)),
        *((kind("no state"), 2, CHECK_DATA) for kind in (DidNotConverge, TuningFailed)),
        (KeyboardInterrupt(), 130, "Interrupted.\n"),
    ],
)
def test_failures_of_the_simulation_and_ctrl_c_are_messages(
    error: BaseException, exit_code: int, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(typer.Exit) as ended:
        fail_with(error)()
    assert ended.value.exit_code == exit_code
    assert capsys.readouterr().err == message


def test_folder_that_cannot_be_written_is_noticed_before_anything_is_computed(
    records: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setattr(run_command, "run_cases", lambda *_: pytest.fail("computed"))
    result = pantocheck("run", "--system", f"record:{records}", "--out", tmp_path / "file" / "out")
    assert result.exit_code == 2
    assert "cannot be written" in result.stderr
    monkeypatch.setattr(line_file_command, "discretise", lambda *_: pytest.fail("drawn"))
    result = pantocheck("line", "draw", "en50318-2002/250", "--out", tmp_path / "file" / "line.svg")
    assert result.exit_code == 2
    assert "cannot be written" in result.stderr


def test_interrupted_run_writes_the_finished_cases(
    records: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read = RecordFolder.run

    def interrupted(self: RecordFolder, case: Case) -> Outcome:
        if case.id.endswith("300"):
            raise KeyboardInterrupt
        return read(self, case)

    monkeypatch.setattr(RecordFolder, "run", interrupted)
    result = pantocheck(
        "run", "en50318-2002/*", "--system", f"record:{records}", "--out", tmp_path, "--formats", "json"
    )
    assert result.exit_code == 130
    assert "Interrupted" in result.stderr
    results = json.loads((tmp_path / "results.json").read_text())
    assert [case["verdict"] for case in results["cases"]] == ["fail", "skip"]
    assert len(results["cases"][0]["criteria"]) == 8


def test_simulate_writes_a_record_that_can_be_graded(records: Path, tmp_path: Path) -> None:
    out = tmp_path / "again" / "a.h5"
    result = pantocheck("simulate", "en50318-2002/250", "--system", f"record:{records}", "--out", out)
    assert result.exit_code == 0
    record, sidecar = read_record(tmp_path / "again" / "a.h5")
    assert (sidecar.case, record.pantographs) == ("en50318-2002/250", 1)
    assert sidecar.case_digest is None  # a record of unknown origin does not become one of this version of the case
    assert sidecar.start is None  # nor does it get a start that its simulator has not stated
    assert sidecar.line.span_m == 60


def test_every_case_of_the_library_is_listed_with_trust_source_and_forces() -> None:
    listed = pantocheck("cases").output
    (case,) = select_cases(["en50318-2002/250"])
    assert case.id in listed
    assert f"{sum(limit.trust == 'secondary' for limit in case.limits)} secondary" in listed
    shown = pantocheck("show", "en50318-2002/250").output
    for text in ("provisional", "Wang, Liu, Mu", "max_uplift_at_support_mm", "masses_kg", "15.0, 7.2", "sha256:"):
        assert text in shown
    shown = " ".join(pantocheck("show", "force-law/300").output.split())
    assert "force law of pantograph 1: applied forces of 155.81 N: static force 70.00 N, aerodynamic" in shown
    assert "pantograph 1.force_law.aerodynamic_force source: wang2016 constant_N -0.2 secondary" in shown
    assert "force law" not in pantocheck("show", "en50318-2002/250").output
    # One row per case; a case without limits has none.
    rows = {line.split()[0]: line for line in pantocheck("cases").output.splitlines()[1:] if line.strip()}
    assert set(list_library(library_folder())) <= set(rows)
    assert rows["en50318-2002/300"].split()[-2:] == ["8", "secondary"]


HEAVY = {f"scipy.{name}" for name in ("signal", "stats", "interpolate", "ndimage", "optimize", "integrate", "spatial")}
PAGES = {"matplotlib", "jinja2", "numba", "typst", "pypdf"}
UNUSED = {"scipy.linalg", "scipy.sparse", "numpy.f2py", "asyncio", "ssl", "multiprocessing", "urllib.request"}


def list_loaded(program: str, *arguments: str, folder: Path) -> list[set[str]]:
    """Modules that are loaded wherever a program in a fresh process calls `show`; it has the function `app`."""
    code = (
        "import sys; from pantocheck.conformance.app.commands.command_list import app, load_command\n"
        "def show(): print('modules', *sys.modules)\n"
    )
    command = [sys.executable, "-c", code + program, *arguments]
    result = subprocess.run(command, check=True, capture_output=True, text=True, timeout=300, cwd=folder)
    return [set(line.split()) for line in result.stdout.splitlines() if line.startswith("modules")]


RUN_COMMANDS = """
for words in sys.argv[1:]:
    try: app(words.split())
    except SystemExit as end: assert end.code in (0, 1), words
    show()
"""
PUBLISHED = "run en50318-2002/250 --system record:en50318-2002/known-passing-code"


def test_commands_load_only_what_they_need(tmp_path: Path) -> None:
    """Imports of other libraries take longer than these commands. Each process keeps what its last commands loaded."""
    words = ["new pantograph a.toml", "check a.toml", "cases", "show en50318-2002/250", "new line b.toml"]
    words += ["new case c.toml --line b.toml", "check b.toml c.toml"]
    words += ["run en50318-2002/250 --formats json --jobs 1 --out values", f"{PUBLISHED} --out out"]
    *loaded, case, checked, computed, drawn = list_loaded(RUN_COMMANDS, *words, folder=tmp_path)
    assert not {name for name in loaded[1] if name.endswith((".case_file", ".line_file", ".force_quantities"))}
    assert case.isdisjoint(UNUSED)
    # Files of an editor load no format of another file; the statics of a line need equation solvers.
    assert checked.isdisjoint(HEAVY | PAGES)
    formats = {place.rpartition(".")[0] for place in {**READ_FORMATS.places, **WRITTEN_FORMATS.places}.values()}
    read = {"pantograph.pantograph_file", "cases.case_file", "cases.limits", "line.line_file", "line.elements.damping"}
    assert {name for name in formats if f"pantocheck.conformance.{name}" in checked} <= read
    # A run without pages needs neither filters of scipy nor plotting.
    assert computed.isdisjoint(HEAVY | {"matplotlib", "typst", "h5py"})
    assert ("numba" in computed) is (choose_core().library is None)
    # A certificate without charts is drawn without matplotlib.
    assert (drawn - computed).isdisjoint(HEAVY | {"matplotlib", "numba"})
    assert (tmp_path / "out" / "certificate.pdf").stat().st_size > 50_000


def test_verification_of_results_loads_no_solver_and_no_network(tmp_path: Path) -> None:
    """Its values follow from numbers that the file holds."""
    pantocheck(*PUBLISHED.split(), "--out", tmp_path / "out", "--formats", "json")
    (loaded,) = list_loaded(RUN_COMMANDS, "verify out/results.json", folder=tmp_path)
    assert loaded.isdisjoint(HEAVY | PAGES | UNUSED | {"pantocheck.conformance.pages.document"})


def test_no_command_loads_a_page_writer_or_a_measurement_format_before_it_needs_one(tmp_path: Path) -> None:
    """`runs assess` grades sections, and `pantograph check` couples an FMU: neither draws before it has results."""
    names = ["pantograph check", "runs import", "runs assess", "run", "assess", "compare"]
    program = "for name in sys.argv[1:]: load_command(name); show()"
    loaded = list_loaded(program, *names, folder=tmp_path)
    heavy = HEAVY | PAGES | {"h5py", "pyarrow", "nptdms", "asammdf"}
    assert {name: found & heavy for name, found in zip(names, loaded, strict=True) if found & heavy} == {}


def test_run_builds_no_schema_of_comparisons() -> None:
    """Building the schemas of files that a command does not read took 16 ms of its start."""
    code = (
        "from pantocheck.conformance.app.commands.command_list import load_command; load_command('run')\n"
        "from pantocheck.conformance.core.json_file import RoundedModel as parent\n"
        "print(len(parent.__subclasses__()), *(c for c in parent.__subclasses__() if c.__pydantic_complete__))"
    )
    result = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, timeout=300)
    assert int(result.stdout) > 5


def test_linear_algebra_has_one_thread_and_programs_of_the_user_keep_their_environment() -> None:
    """More threads wait for each other: they took 4 % of the processor time of a run on two processors."""
    code = (
        "import sys; from pantocheck.conformance.app.main import main\n"
        "sys.argv = ['pantocheck', 'show', 'en50318-2002/250', '--quiet']\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        "import scipy.linalg; from threadpoolctl import threadpool_info\n"
        "from pantocheck.conformance.core.processes import list_user_variables as left\n"
        "print({library['num_threads'] for library in threadpool_info()}, sorted({'OMP_NUM_THREADS'} & {*left()}))"
    )
    environment = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}

    def run(variables: dict[str, str]) -> str:
        command = [sys.executable, "-c", code]
        output = subprocess.run(
            command, check=True, capture_output=True, text=True, timeout=300, env=environment | variables
        )
        return output.stdout.splitlines()[-1]

    assert run({}) == "{1} []"
    assert run({"OMP_NUM_THREADS": "1"}) == "{1} ['OMP_NUM_THREADS']"


def test_process_ends_after_the_functions_of_other_packages() -> None:
    code = (
        "import atexit, os, sys; from pantocheck.conformance.app import main\n"
        "class Released:\n    def __del__(self, write=os.write): write(1, b'released')\n"
        "sys.kept, sys.argv, run = Released(), ['pantocheck', 'show', 'absent'], main.app\n"
        "main.app = lambda **options: (atexit.register(print, 'end'), run(**options)); main.start()"
    )
    result = subprocess.run([sys.executable, "-c", code], check=False, capture_output=True, text=True)
    assert (result.returncode, result.stdout.splitlines()[-1]) == (2, "end")


def test_show_states_requirements_start_and_section() -> None:
    """Both pantographs are 200 m apart; the last one starts at 55 m."""
    name, required = "en50318-2018/ac-simple/320-twin", "en50318-2018/ac-simple/static"
    text = " ".join(pantocheck("show", name).output.split())
    assert "analysis section 1650 m to 2200 m" in text
    assert "start of the pantographs: 255 m, 55 m" in text
    assert f"requires: {required}" in text
    (facts,) = json.loads(pantocheck("show", name, "--json").output)["result"]
    assert (facts["requires"], facts["start_m"]) == ([required], [255.0, 55.0])
    static = pantocheck("show", required).output
    assert "requires" not in static
    assert "start of" not in static

    # An exact id is shown alone, even if other cases require it; a glob shows the cases that it selects.
    def shown(pattern: str) -> list[str]:
        return re.findall(r"^(en50318-\S+) ", pantocheck("show", pattern).output, re.MULTILINE)

    assert shown("en50318-2018/ac-simple/static") == ["en50318-2018/ac-simple/static"]
    assert shown("en50318-2002/*") == ["en50318-2002/250", "en50318-2002/300"]
    assert shown("en50318-2018/ac-stitched/*") == ["en50318-2018/ac-stitched/275", "en50318-2018/ac-stitched/320"]


def test_run_states_the_cases_that_it_adds(tmp_path: Path) -> None:
    """Only cases that no name selects are added, and the line precedes the results."""
    (tmp_path / "skipper.py").write_text(SKIPPER)
    program = f"command:{sys.executable} {tmp_path / 'skipper.py'} {tmp_path / 'log'}"
    name, required = "en50318-2018/ac-simple/320-twin", "en50318-2018/ac-simple/static"
    out = ("--system", program, "--out", tmp_path / "out", "--formats", "json")
    assert pantocheck("run", name, *out).stderr.startswith(f"cases added: {required} (required by {name})\n")
    assert "cases added" not in pantocheck("run", name, required, *out).stderr
    assert "cases added" not in pantocheck("-q", "run", name, *out).stderr


def test_control_characters_of_a_file_do_not_reach_the_terminal(edited_case: EditedCase) -> None:
    path = edited_case("250.toml", {"title": "\x1b[31m[bold]EN 50318"})
    shown = pantocheck("show", path).output
    assert "\x1b" not in shown
    assert "[31m[bold]EN" in shown


def test_help_of_every_command_fits_80_columns() -> None:
    """It takes the options of the output, and refers to the help of `pantocheck`, which lists them."""
    for name, summary in COMMANDS.items():
        result = pantocheck(*name.split(), "-q", "--json", "--no-color", "--help")
        assert (result.exit_code, "see `pantocheck --help`" in result.stdout) == (0, True), name
        assert max(map(len, result.output.splitlines())) <= 80, name
        assert summary in " ".join(result.output.split()), "the summary is the first line of the docstring"
        assert re.search(r"^ +(Example: )?pantocheck " + name, result.output, re.MULTILINE), f"{name}: example"


def test_root_help_fits_66_lines_and_an_unknown_command_suggests_a_known_one() -> None:
    lines = pantocheck("--help", COLUMNS="80").output.splitlines()
    assert len(lines) <= 66
    assert max(map(len, lines)) <= 80
    listed = [line.split("  ")[1] for line in lines if line.startswith("  ") and line.split("  ")[1] in COMMANDS]
    assert sorted(listed) == sorted(COMMANDS)
    result = pantocheck("simulat")
    assert result.exit_code == 2
    assert "Did you mean 'simulate'?" in result.output


def test_help_imports_no_command_and_nothing_heavy() -> None:
    code = (
        "import sys; from pantocheck.conformance.app.commands.command_list import app\n"
        "try: app(['--help'])\nexcept SystemExit: pass\n"
        "heavy = {'numpy', 'scipy', 'numba', 'pydantic', 'matplotlib', 'typst', 'h5py'} & set(sys.modules)\n"
        "print(sorted(heavy), [name for name in sys.modules if name.endswith('_command')])"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.splitlines()[-1] == "[] []"


@pytest.mark.parametrize(
    "command",
    [
        ("assess", "bad.toml", "--profile", "acceptance-ac"),
        ("drop", "identify", "bad.csv"),
        ("drop", "identify", "bad.csv", "--poles", "bad.toml"),
        ("drop", "fit", "bad.json", "--line", "en50318-2002/250"),
        ("run", "bad.toml"),
        ("run", "en50318-2002/250", "--system", "record:absent"),
        ("run", "en50318-2002/250", "--baseline", "bad.json"),
        ("drop", "simulate", "bad.toml"),
        ("simulate", "bad.toml"),
    ],
)
def test_bad_input_leaves_no_folder(command: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("bad.toml", "bad.csv", "bad.json"):
        Path(name).write_text("{")
    out = Path("new") / ("out.csv" if "simulate" in command else "out")
    assert pantocheck(*command, "--out", out).exit_code == 2
    assert not Path("new").exists()


@pytest.mark.skipif(sys.platform != "linux", reason="/dev/full is a device of Linux")
@pytest.mark.parametrize("redirection", ["> /dev/full", "| head -1 > /dev/null"])
def test_output_that_cannot_be_written_gives_no_traceback(redirection: str) -> None:
    command = f"{sys.executable} -c 'from pantocheck.conformance.app.main import start; start()'"
    shell = f"{command} show en50318-2002/250 {redirection}; {command} --help {redirection}"
    result = subprocess.run(["sh", "-c", shell], capture_output=True, text=True, check=False, timeout=60)
    assert "Traceback" not in result.stderr
    assert "internal error" not in result.stderr
    assert ("cannot be written" in result.stderr) == ("full" in redirection)

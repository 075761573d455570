"""Signals after the last case: the results are written; a second signal ends the command at once."""

import importlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from helpers.command_line import pantocheck
from helpers.wave_system import Wave
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.results_reading import read_results

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="signals as on Linux")

TRUST: Trust = "secondary"
GRADING, WRITING = "execution.runner.build_results", "pages.ci_reports.render_junit"
"""Functions that are called after the last case; junit.xml is the last of the reports."""

Interrupt = Callable[..., None]

# The process sends a signal to itself, so the moment does not depend on the speed of the machine.
SCRIPT = """
import os, signal, sys
from pantocheck.conformance.execution import runner
from pantocheck.conformance.app.main import main
signal.signal(signal.SIGTERM, signal.SIG_DFL)  # the parent may ignore it
build_results = runner.build_results
def interrupted(*arguments):
    os.kill(os.getpid(), signal.SIGTERM)
    return build_results(*arguments)
runner.build_results = interrupted
main()
"""


@pytest.fixture
def arguments(wave: type[Wave], tmp_path: Path) -> list[str]:
    """Run of both cases on records."""
    for case in select_cases(["en50318-2002/*"]):
        write_record(tmp_path / "records" / f"{case.file.speed_km_h:g}.csv", wave().record(case), case.id)
    system = f"record:{tmp_path / 'records'}"
    return ["run", "en50318-2002/*", "--system", system, "--out", str(tmp_path / "out"), "--formats", "json,md,junit"]


@pytest.fixture
def interrupt(monkeypatch: pytest.MonkeyPatch) -> Iterator[Interrupt]:
    """Function that lets a function of the suite send signals to this process before it runs."""
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)

    def send(place: str, signals: int = 1, pause_s: float = 0.0) -> None:
        module_name, _, name = place.rpartition(".")
        module = importlib.import_module(f"pantocheck.conformance.{module_name}")
        function = getattr(module, name)

        def interrupted(*arguments: object, **options: object) -> object:
            for _ in range(signals):
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(pause_s)
            return function(*arguments, **options)

        monkeypatch.setattr(module, name, interrupted)

    yield send
    signal.signal(signal.SIGINT, handler)


def test_signal_to_the_process_while_it_grades_keeps_all_results(arguments: list[str], tmp_path: Path) -> None:
    command = [sys.executable, "-c", SCRIPT, *arguments]
    process = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert process.returncode == 143
    assert "A second signal ends the command at once." in process.stderr
    assert [case.verdict for case in read_results(tmp_path / "out" / "results.json").cases] == ["fail", "fail"]


@pytest.mark.parametrize("place", [GRADING, WRITING])
@pytest.mark.parametrize("signals", [1, 2])
def test_signal_after_the_last_case_waits_until_all_reports_are_written(
    place: str, signals: int, arguments: list[str], interrupt: Interrupt, tmp_path: Path
) -> None:
    """A second signal at once is the same interruption: `timeout` of GNU sends its signal twice."""
    interrupt(place, signals)
    assert pantocheck(*arguments).exit_code == 130
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["junit.xml", "results.json", "summary.md"]
    assert [case.verdict for case in read_results(tmp_path / "out" / "results.json").cases] == ["fail", "fail"]


@pytest.mark.parametrize(
    ("place", "remark"),
    [
        (GRADING, "No results are written; {} is of an earlier run.\nInterrupted.\n"),
        (WRITING, "{} has the results. Not all other files are written; those in the folder may be of an earlier run."),
    ],
)
def test_second_signal_ends_at_once_and_names_an_earlier_report(
    place: str, remark: str, arguments: list[str], interrupt: Interrupt, tmp_path: Path
) -> None:
    results = tmp_path / "out" / "results.json"
    results.parent.mkdir()
    results.write_bytes(run_cases([], Wave(), TRUST).to_json())
    interrupt(place, signals=2, pause_s=1.1)
    ended = pantocheck(*arguments)
    assert ended.exit_code == 130
    assert remark.format(results) in ended.stderr
    assert not (tmp_path / "out" / "junit.xml").exists()


def test_signal_before_the_first_case_states_that_no_results_are_written(
    arguments: list[str], interrupt: Interrupt
) -> None:
    interrupt("app.commands.run_command.run_cases")
    ended = pantocheck(*arguments)
    assert ended.exit_code == 130
    assert ended.stderr == "No results are written.\nInterrupted.\n"


def test_signal_while_an_assessment_is_written_waits(wave: type[Wave], interrupt: Interrupt, tmp_path: Path) -> None:
    case = select_cases(["en50318-2002/250"])[0]
    write_record(tmp_path / "record.csv", wave().record(case), case.id)
    interrupt(WRITING)
    command = ["assess", str(tmp_path / "record.csv"), "--profile", "acceptance-ac", "--out", str(tmp_path / "out")]
    assert pantocheck(*command, "--formats", "json,junit").exit_code == 130
    assert (tmp_path / "out" / "junit.xml").is_file()

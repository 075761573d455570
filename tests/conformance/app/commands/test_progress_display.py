"""Progress: task, step, share and remaining time, live on a terminal and as lines elsewhere."""

import io
import logging
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

import pytest
from rich.console import Console

from helpers.short_cases import shorten_case
from pantocheck.conformance.app.commands import progress_display
from pantocheck.conformance.app.commands.command_output import print_log
from pantocheck.conformance.app.commands.output_settings import OutputSettings, use_settings
from pantocheck.conformance.app.commands.progress_display import REDRAWS_PER_S, TaskProgress, follow_steps, show_line
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.step_log import StepSequence, report_remote, use_part
from pantocheck.conformance.drops.drop_simulation import simulate_drop
from pantocheck.conformance.runs import core_requirement, reference_simulator
from pantocheck.conformance.runs.core_requirement import COMPILATION
from pantocheck.conformance.runs.reference_simulator import (
    COARSE_MESH,
    FINE_MESH,
    OTHER_RUNS,
    OWN_MESH,
    ReferenceSimulator,
    estimate_work,
)
from pantocheck.model.description.failures import SimulationError
from pantocheck.model.dynamics.core_choice import Core

LOGGER = logging.getLogger("pantocheck.test")


class Clock:
    """Time that the test sets [s]."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


@contextmanager
def follow(progress: TaskProgress) -> Iterator[None]:
    """Pass the steps of the test on."""
    LOGGER.addHandler(progress)
    try:
        yield
    finally:
        LOGGER.removeHandler(progress)


def test_remaining_time_follows_the_finished_share() -> None:
    """One of two cases and half of the first of two equal steps take 50 s: 62.5 %, so 30 s remain."""
    clock = Clock()
    progress = TaskProgress("running cases", 2, clock)
    steps = StepSequence(LOGGER, "en50318-2002/300", {"mesh of the case": 1.0, "mesh halved": 1.0})
    LOGGER.setLevel(logging.DEBUG)
    with follow(progress):
        progress.finish_task()
        steps.begin("mesh of the case")(0.5)
    clock.now = 50.0
    assert progress.describe() == (
        "62 %, about 0:00:30 remaining, running cases: 1 of 2 finished, en50318-2002/300: mesh of the case"
    )
    # An earlier run has done 20 %; 30 % more take 60 s, so the other half takes 100 s, of which 40 s pass.
    clock = Clock()
    progress = TaskProgress("guide", 4, clock)
    progress.reach("", 1, 0.2)
    clock.now = 60.0
    progress.reach("library/long", 2, 0.5)
    clock.now = 100.0
    assert progress.describe() == "50 %, about 0:01:00 remaining, guide: 2 of 4 finished, library/long"
    clock.now = 160.0  # the estimate is over, but not the work
    assert progress.describe() == "50 %, 0:02:40 elapsed, guide: 2 of 4 finished, library/long"


def test_share_follows_the_work_of_the_cases(caplog: pytest.LogCaptureFixture) -> None:
    """A short case of 10 units and a half of a long one of 90 are 55 %; a part of a case counts for its case."""
    progress = TaskProgress("running cases", 2, Clock(), {"line/short": 10.0, "line/long": 90.0})
    progress.finish_task("line/short")
    assert progress.describe().startswith("10 %, ")
    with follow(progress), caplog.at_level(logging.DEBUG, LOGGER.name):
        StepSequence(LOGGER, "line/long/initial", {"mesh of the case": 1.0}).begin("mesh of the case")(0.5)
    assert progress.describe().startswith("55 %, ")
    progress.finish_task("line/long")
    assert progress.describe().startswith("100 %, ")


def test_work_is_simulated_time_by_pantographs_and_runs() -> None:
    """The twin of a passage has two pantographs and a longer train on the same line, the same meshes and starts."""
    single, twin = (
        case
        for name in ("320", "320-twin")
        for case in select_cases([f"en50318-2018/ac-simple/{name}"])
        if case.id.endswith(name)
    )
    times = [(case.end - case.start) / case.speed for case in (single, twin)]
    assert estimate_work(twin) / estimate_work(single) == pytest.approx(2 * times[1] / times[0])
    rest = [case for case in select_cases(["en50318-2018/ac-simple/320"]) if case.is_static]
    assert all(0 < estimate_work(case) < estimate_work(single) / 5 for case in rest)


def test_live_line_is_cut_to_the_width() -> None:
    """A line that wraps leaves its rests on the terminal, and the share and the time stand first."""
    text = "62 %, about 0:00:30 remaining, running cases: 1 of 2 finished"
    (line,) = Console(width=40, file=io.StringIO()).render_lines(progress_display._LiveLine(lambda: text))
    assert "".join(segment.text for segment in line) == text[:39] + "\N{HORIZONTAL ELLIPSIS}"


def test_compilation_is_announced_at_once_in_a_log(capsys: pytest.CaptureFixture[str]) -> None:
    """The first line of progress comes after ten seconds: a user would wait for the compiler without a word."""
    with follow_steps("running cases"):
        LOGGER.warning(COMPILATION)
        assert capsys.readouterr().err == f"{COMPILATION}\n"
    with use_settings(OutputSettings(detail="verbose")), follow_steps("running cases"):
        LOGGER.warning(COMPILATION)
        assert capsys.readouterr().err == ""  # the log itself prints it


def test_compilation_for_a_mass_drop_is_announced(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A drop has no step of its own for the compiler, so its warning before the simulation is the only word."""

    def stop(*_: object) -> None:
        raise SimulationError(caplog.messages[-1])

    monkeypatch.setattr(core_requirement, "needs_compilation", lambda: True)
    monkeypatch.setattr("pantocheck.model.dynamics.mass_drop.simulate_mass_drop", stop)
    with pytest.raises(SimulationError, match=f"^{COMPILATION}$"):
        simulate_drop(select_cases(["vovan2015/mass-drop/stand-in"])[-1], 1)


def test_remaining_time_is_not_extrapolated_from_nothing() -> None:
    clock = Clock()
    progress = TaskProgress("identification", 5, clock)
    progress.begin_task("T1: release and linear decay")
    clock.now = 75.0
    assert progress.describe() == (
        "0 %, 0:01:15 elapsed, identification: 0 of 5 finished, T1: release and linear decay"
    )
    progress = TaskProgress("guide", 4, clock := Clock())
    progress.reach("", 0, 0.0)
    clock.now = 10.0
    progress.reach("library/short", 1, 0.09)
    assert progress.describe() == "9 %, 0:00:10 elapsed, guide: 1 of 4 finished, library/short"
    progress = TaskProgress("self-test", 4, Clock())
    progress.begin_task("zero force")
    progress.begin_task("late force")
    assert progress.describe().endswith("self-test: 1 of 4 finished, late force")


def test_repeated_tasks_raise_their_number() -> None:
    """Clocks that were corrected, or a later onset, repeat the identification."""
    progress = TaskProgress("identification", 2, Clock())
    for name in ("release", "poles", "poles again"):
        progress.begin_task(name)
    assert progress.describe().startswith("67 %, ")


def test_cases_and_steps_that_are_running_are_named(caplog: pytest.LogCaptureFixture) -> None:
    progress = TaskProgress("running cases", 1, Clock())
    assert progress.describe() == "0:00:00 elapsed, running cases"
    with follow(progress), caplog.at_level(logging.DEBUG, "pantocheck"):
        StepSequence(LOGGER, "line/250", {"mesh of the case": 1.0}).begin("mesh of the case")(0.5)
    assert progress.describe().startswith("50 %, ")
    caplog.set_level(logging.INFO, LOGGER.name)
    progress = TaskProgress("running cases", 4, Clock())
    with follow(progress):
        for case in ("line/250", "line/300", "line/320"):
            report_remote(LOGGER, case)
    progress.finish_task("line/300")
    assert progress.describe().endswith(
        "running cases: 1 of 4 finished, line/250: in a process of its own, line/320: in a process of its own"
    )
    # A case may take a further step after its end; no more than all of the work is done.
    progress = TaskProgress("running cases", 1, Clock())
    progress.finish_task()
    with follow(progress), caplog.at_level(logging.DEBUG, LOGGER.name):
        StepSequence(LOGGER, "line/250", {"report": 1.0}).begin("report")(0.5)
    assert progress.describe().startswith("100 %, ")
    # A part such as the self-test runs many cases, which end without a message.
    progress = TaskProgress("guide", 4, Clock())
    progress.reach("", 0, 0.0)
    with follow(progress):
        for case in ("line/250", "line/300"):
            StepSequence(LOGGER, case, {"mesh of the case": 1.0, "mesh halved": 1.0}).begin("mesh halved")
    assert progress.describe() == "0 %, 0:00:00 elapsed, guide: 0 of 4 finished, line/300: mesh halved"


def test_parts_of_a_study_continue_the_share_of_their_case(caplog: pytest.LogCaptureFixture) -> None:
    """A second part from 60 to 100 % whose only step is half finished: 80 %."""
    with caplog.at_level(logging.DEBUG, "pantocheck"), use_part(0.6, 1.0):
        StepSequence(LOGGER, "line/250", {"mesh of the case": 2.0}).begin("mesh of the case")(0.5)
    assert [record.__dict__["step"].completed for record in caplog.records] == pytest.approx([0.6, 0.8])


@pytest.mark.parametrize(("detail", "lines"), [("normal", True), ("quiet", False)])
def test_line_is_printed_periodically_outside_of_a_terminal(
    detail: str, lines: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The display asks for the second line after it has printed the first; with -q, it never asks."""
    monkeypatch.setattr(progress_display, "LOG_INTERVAL_S", 0.01)
    asked, second = [], threading.Event()

    def describe() -> str:
        asked.append(1)
        if len(asked) == 2:
            second.set()
        return "case 1\x1b of 2"

    with use_settings(OutputSettings(detail=detail)), show_line(describe):  # type: ignore[arg-type]
        assert second.wait(10.0 if lines else 0.05) == lines
    captured = capsys.readouterr()
    assert captured.out == ""
    assert ("case 1? of 2" in captured.err) == lines


@pytest.mark.parametrize("prepare", [print_log, lambda: follow_steps("running cases")])
def test_long_lines_of_a_log_stay_whole(
    prepare: Callable[[], AbstractContextManager[object]],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """120 characters: more than the 80 columns of a pipe, so a search for the end of the line finds it."""
    monkeypatch.setattr(progress_display, "LOG_INTERVAL_S", 0.01)
    text = "word " * 24 + "end"
    with use_settings(OutputSettings(detail="verbose")), prepare():
        StepSequence(LOGGER, "line/250", {text: 1.0}).begin(text)
        limit, printed = time.monotonic() + 10.0, ""
        while f"line/250: {text}" not in printed and time.monotonic() < limit:
            time.sleep(0.01)
            printed += capsys.readouterr().err
    assert f"line/250: {text}" in printed


def test_levels_and_handlers_are_restored() -> None:
    assert 2 <= REDRAWS_PER_S <= 4
    root = logging.getLogger("pantocheck")
    before = root.level, list(root.handlers)
    with follow_steps("anything") as progress:
        assert progress.describe().startswith("0:00:0")
        assert root.isEnabledFor(logging.DEBUG)
    assert (root.level, root.handlers) == before


def test_threads_change_no_bit_and_report_their_steps_together(caplog: pytest.LogCaptureFixture) -> None:
    case = select_cases(["en50318-2002/300"])[-1]
    short = shorten_case(case, 200.0, 0.5, 2)
    alone = ReferenceSimulator().run(short)
    with caplog.at_level(logging.INFO, "pantocheck"):
        together = ReferenceSimulator(threads=3).run(short)
    steps = [record.__dict__["step"] for record in caplog.records if "step" in record.__dict__]
    assert [step.name for step in steps] == [OWN_MESH, OTHER_RUNS]
    assert len(alone.starts) == len(together.starts) == 7
    for one, other in zip((alone, *alone.starts), (together, *together.starts), strict=True):
        assert one.record.force.tobytes() == other.record.force.tobytes()
    assert alone.refined.record.force.tobytes() == together.refined.record.force.tobytes()
    assert alone.coarse.record.force.tobytes() == together.coarse.record.force.tobytes()


def test_failure_of_one_run_ends_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """The fine mesh would take long: the first report of its progress ends it."""
    short = shorten_case(select_cases(["en50318-2002/300"])[-1], 200.0, 0.5, 2)
    ended = []

    def fail(*_: object) -> None:
        raise SimulationError("no initial state")

    def wait(*given: object) -> None:
        try:
            while True:
                given[-1](0.5)
                time.sleep(0.01)
        except SimulationError as reason:
            ended.append(str(reason))
            raise

    monkeypatch.setattr(reference_simulator, "_deliver_starts", fail)
    monkeypatch.setattr(reference_simulator, "_deliver_again", wait)
    monkeypatch.setattr(reference_simulator, "_deliver_coarse", fail)
    with pytest.raises(SimulationError):
        ReferenceSimulator(threads=2).run(short)
    assert ended == ["another run of the case has failed, or the user has stopped the run"]


@pytest.mark.parametrize("kept", [True, False])
def test_reference_simulator_reports_its_steps(
    kept: bool, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The completed share never decreases, although the tuning of two uplift forces repeats the passage."""
    monkeypatch.setattr(core_requirement, "has_kept_kernels", lambda: kept)
    monkeypatch.setattr(core_requirement, "choose_core", lambda: Core("numba", None))
    case = select_cases(["en50318-2018/ac-simple/275-twin"])[-1]
    short = shorten_case(case, 200.0, 0.5, 2)
    with caplog.at_level(logging.DEBUG, "pantocheck"):
        ReferenceSimulator().run(short)
    steps = [record.__dict__["step"] for record in caplog.records if "step" in record.__dict__]
    names, first = list(dict.fromkeys(step.name for step in steps)), [] if kept else [COMPILATION]
    assert names[: 3 + len(first)] == [OWN_MESH, *first, FINE_MESH, COARSE_MESH]
    assert {step.task for step in steps} == {case.id}
    completed = [step.completed for step in steps]
    assert completed == sorted(completed)
    assert completed[-1] <= 1
    assert len({step.completed for step in steps if step.name == OWN_MESH}) > 3

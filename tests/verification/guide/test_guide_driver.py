"""Driver and command of the guide: finished parts are kept, failed ones are named and repeated."""

import json
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
import typer

from pantocheck.conformance.core.results_part import ResultsPart
from verification.guide import __main__ as guide_command
from verification.guide.guide_driver import compute_parts
from verification.guide.guide_format import Guide, Topic
from verification.guide.guide_tasks import GuideStore, GuideTask, list_tasks


def _write_topic(title: str, log: Path) -> Topic:
    with log.open("a", encoding="utf-8") as file:
        file.write(f"{title}\n")
    if title == "broken":
        raise ValueError("no value")
    if title == "stop":
        raise KeyboardInterrupt
    return Topic(title=title, theory="", setting="")


def _tasks(log: Path, *titles: str) -> list[GuideTask]:
    return [GuideTask(f"verification/{title}", Topic, partial(_write_topic, title, log)) for title in titles]


def _ignore(part: str, finished: Sequence[str]) -> None:
    pass


def test_interrupted_guide_keeps_its_finished_parts(tmp_path: Path) -> None:
    log, store = tmp_path / "log", GuideStore(tmp_path, "this suite")
    with pytest.raises(KeyboardInterrupt):
        compute_parts(_tasks(log, "first", "stop", "last"), store, 1, _ignore)
    parts = compute_parts(_tasks(log, "first", "last"), store, 1, _ignore)
    assert [*parts.contents] == ["verification/first", "verification/last"]
    assert log.read_text("utf-8").split() == ["first", "stop", "last"]


def test_part_of_another_version_of_a_peer_is_computed_again(tmp_path: Path) -> None:
    log, store = tmp_path / "log", GuideStore(tmp_path, "this suite")
    for version in ("", "1.0", "1.0"):
        tasks = [replace(task, subject=version) for task in _tasks(log, "first")]
        compute_parts(tasks, store, 1, _ignore)
    assert log.read_text("utf-8").split() == ["first", "first"]


def test_parts_of_another_suite_and_damaged_parts_are_computed_again(tmp_path: Path) -> None:
    log = tmp_path / "log"
    for identity in ("one suite", "another suite", "another suite"):
        compute_parts(_tasks(log, "first"), GuideStore(tmp_path, identity), 1, _ignore)
    assert log.read_text("utf-8").split() == ["first", "first"]
    (tmp_path / "parts" / "verification--first.json").write_text("{", "utf-8")
    compute_parts(_tasks(log, "first"), GuideStore(tmp_path, "another suite"), 1, _ignore)
    assert log.read_text("utf-8").split() == ["first", "first", "first"]


@pytest.mark.parametrize("jobs", [1, pytest.param(2, marks=pytest.mark.thorough)])
def test_failed_part_is_named_and_repeated(tmp_path: Path, jobs: int) -> None:
    log, store, seen = tmp_path / "log", GuideStore(tmp_path, "this suite"), []
    for _ in range(2):
        parts = compute_parts(
            _tasks(log, "broken", "first"), store, jobs, lambda part, finished: seen.append(len(finished))
        )
        assert [(part.part, part.reason) for part in parts.failed] == [("verification/broken", "ValueError: no value")]
        assert [*parts.contents] == ["verification/first"]
    assert sorted(log.read_text("utf-8").split()) == ["broken", "broken", "first"]
    assert seen == [0, 1, 2, 1, 2]


def test_tasks_have_distinct_names_and_cover_the_library() -> None:
    names = [task.name for task in list_tasks()]
    assert len(names) == len(set(names))
    assert {"verification/waves", "library/en50318-2002/250", "library/vovan2015/contact-force"} <= set(names)


# The command on few parts; `.ci/thorough guide` runs it on all of them.
CHEAP = ("verification/wire-sag", "verification/wire-frequencies")


def _fail() -> ResultsPart:
    raise ValueError("no value")


def _interrupt() -> ResultsPart:
    raise KeyboardInterrupt


@pytest.fixture
def tasks(monkeypatch: pytest.MonkeyPatch) -> list[GuideTask]:
    """Parts that the command computes; a test may change the list."""
    chosen = [task for task in list_tasks() if task.name in CHEAP]
    monkeypatch.setattr(guide_command, "list_tasks", lambda: chosen)
    monkeypatch.setattr(guide_command, "list_timings", list)
    return chosen


def _run(out: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    try:
        code = guide_command.main(["--out", str(out)])
    except typer.Exit as ended:
        code = ended.exit_code
    return code, capsys.readouterr().out


def test_guide_is_written_and_a_second_run_computes_nothing(
    tmp_path: Path, tasks: list[GuideTask], capsys: pytest.CaptureFixture[str]
) -> None:
    code, output = _run(tmp_path, capsys)
    assert code == 0, output
    guide = Guide.model_validate(json.loads((tmp_path / "guide.json").read_text("utf-8")))
    assert [*guide.verification] == ["wire-sag", "wire-frequencies"]
    values = json.loads((tmp_path / "guide-values.json").read_text("utf-8"))["values"]
    assert values["verification/wire-sag/string/expected"] == -0.29797875  # m g L^2 / 8 T of 1.35 kg/m, 60 m, 20 kN
    assert (tmp_path / "guide.pdf").read_bytes().startswith(b"%PDF")
    assert "Sag of a wire under its weight" in (tmp_path / "guide.html").read_text("utf-8")
    tasks[:] = [replace(task, compute=_fail) for task in tasks]
    assert _run(tmp_path, capsys)[0] == 0
    again = Guide.model_validate(json.loads((tmp_path / "guide.json").read_text("utf-8")))
    assert again.model_copy(update={"created": guide.created}) == guide


def test_part_that_fails_ends_with_1_and_a_folder_that_cannot_be_written_with_2(
    tmp_path: Path, tasks: list[GuideTask], capsys: pytest.CaptureFixture[str]
) -> None:
    tasks[1] = replace(tasks[1], compute=_fail)
    code, output = _run(tmp_path, capsys)
    assert code == 1
    assert "1 results outside their tolerance, or not computed\n  verification/wire-frequencies" in output
    assert "ValueError: no value" in (tmp_path / "guide.html").read_text("utf-8")
    (tmp_path / "file").write_text("", "utf-8")
    assert _run(tmp_path / "file", capsys)[0] == 2


def test_interrupted_command_keeps_finished_parts(
    tmp_path: Path, tasks: list[GuideTask], capsys: pytest.CaptureFixture[str]
) -> None:
    last = tasks[1]
    tasks[1] = replace(last, compute=_interrupt)
    assert _run(tmp_path, capsys)[0] == 130
    assert not (tmp_path / "guide.json").exists()
    tasks[:] = [replace(tasks[0], compute=_fail), last]
    assert _run(tmp_path, capsys)[0] == 0

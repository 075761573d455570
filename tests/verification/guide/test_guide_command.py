"""The command on few parts; `.ci/thorough guide` runs it on all of them."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
import typer

from pantocheck.conformance.core.results_part import ResultsPart
from verification.guide import __main__ as guide_command
from verification.guide.guide_format import Guide
from verification.guide.guide_tasks import GuideTask, list_tasks

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

"""Driver of the guide: finished parts are kept, failed ones are named and repeated."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from verification.guide.guide_driver import compute_parts
from verification.guide.guide_format import Topic
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

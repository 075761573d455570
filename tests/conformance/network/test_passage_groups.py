"""Groups of passages by class, the speed of a passage, and the reasons of incomplete ones."""

import datetime
from pathlib import Path

import numpy as np
import pytest

from helpers.measured_runs import FORCE_PROFILE, write_run
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.network.network_assessment import _group
from pantocheck.conformance.network.run_collection import import_files, list_runs, open_collection
from pantocheck.conformance.network.section_grading import _mean_speed, grade_run, list_grid
from pantocheck.conformance.results.network_format import SectionPassage, TrackSection

SECTION = TrackSection(line="1", track="1", name="", from_km=10.0, to_km=11.0)


def build_passage(run: str, speed: float | None, verdict: str = "pass", whole: bool = True) -> SectionPassage:
    return SectionPassage.model_validate(
        {
            "section": SECTION,
            "run": run,
            "date": datetime.date(2026, 5, 1),
            "direction": "increasing",
            "pantograph": "1",
            "speed_km_h": speed,
            "whole": whole,
            "verdict": verdict,
            "reason": "",
            "values": {},
        }
    )


def list_groups(*passages: SectionPassage) -> dict[float | None, tuple[list[str], str, int]]:
    """Runs, verdict and incomplete passages by the lower end of the class of speed."""
    return {
        group.speed_km_h and group.speed_km_h[0]: ([x.run for x in members], group.verdict, group.partial)
        for group, members in _group(passages, [SECTION], ("section", "speed"))
    }


def test_a_passage_without_a_speed_counts_in_every_class_wherever_it_stands() -> None:
    lost = build_passage("lost", None, "skip")
    slow, fast = build_passage("slow", 209.9), build_passage("fast", 250.0)
    for order in ((lost, slow, fast), (slow, lost, fast), (slow, fast, lost)):
        assert list_groups(*order) == {200.0: (["slow", "lost"], "skip", 0), 250.0: (["fast", "lost"], "skip", 0)}
    assert list_groups(lost) == {None: (["lost"], "skip", 0)}


def test_passages_over_a_part_are_counted_and_decide_nothing() -> None:
    part = build_passage("part", None, "fail", whole=False)
    assert list_groups(part, build_passage("whole", 210.0)) == {210.0: (["whole"], "pass", 1)}
    assert list_groups(part, part) == {None: ([], "skip", 2)}


def test_the_speed_is_the_mean_over_the_section_to_a_tenth() -> None:
    """1 km in 18.3 s, with a faster half: 196.7 km/h; the record may miss 1 m at either end."""
    time, position = np.array([0.0, 10.0, 18.3, 20.0]), np.array([0.0, 500.0, 1000.0, 1100.0])
    assert _mean_speed(position, time, 0.0, 1000.0) == 196.7
    assert _mean_speed(position, time, -1.0, 1101.0) is not None
    assert _mean_speed(position, time, -1.1, 1000.0) is None
    assert _mean_speed(position, time, 0.0, 1101.1) is None


def test_an_incomplete_passage_says_why(tmp_path: Path) -> None:
    """The run states 10.2 to 11.9 km, and its samples end at 11.4 km."""
    pytest.importorskip("pyarrow")
    path = write_run(tmp_path, "run", ends_km=(10.2, 11.9))
    head, *rows = path.read_text(encoding="utf-8").splitlines()
    km = np.linspace(10.2, 11.9, len(rows))
    path.write_text("\n".join([head, *np.array(rows)[km < 11.4]]) + "\n", encoding="utf-8")
    sidecar = path.with_suffix(".toml")
    sidecar.write_text("evaluated_km = [10.2, 11.9]\n" + sidecar.read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "force.toml").write_text(FORCE_PROFILE, encoding="utf-8")
    with open_collection(tmp_path / "runs"):
        list(import_files([path], tmp_path / "runs", None))
    (run,) = list_runs(tmp_path / "runs")
    grid = list_grid("1700", "2", [(10.2, 11.9)], 0.5)
    found = {
        x.passage.section.from_km: x.passage
        for x in grade_run(run, grid, load_profile(str(tmp_path / "force.toml")), "provisional")
    }
    assert {km: (x.whole, x.speed_km_h, x.reason) for km, x in found.items()} == {
        10.0: (False, None, "the run passes a part of the section"),
        10.5: (True, 250.0, ""),
        11.0: (True, None, "the record does not reach both ends of the section"),
        11.5: (False, None, "the run passes a part of the section"),
    }

"""Sections graded by uplift, arcs and several pantographs, from files with clocks of their own."""

from pathlib import Path

import numpy as np
import pytest

from helpers.measured_pairs import STATED, MeasuredPair, write_german, write_masts
from pantocheck.conformance.cases.profile_file import Profile, load_profile
from pantocheck.conformance.network.network_assessment import AssessmentTask, assess_tracks, combine_tracks
from pantocheck.conformance.network.run_collection import import_files, list_refused, list_runs, open_collection
from pantocheck.conformance.network.section_grading import GradedPassage, grade_run
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.network_page import build_run_page
from pantocheck.conformance.pages.words import quantity_label
from pantocheck.conformance.results.network_format import NetworkResults, TrackSection

pytest.importorskip("pyarrow")

PLACE = """
[measurement]
line = "1700"
track = "2"
date = 2026-05-03
pantograph_names = ["front", "rear"]

[track]
zero_km = 0.0
kilometres = "increasing"
"""

ARC = """
[[arc]]
pantograph = 1
detector = "Kraft 1 [N]"
above = 150.0
current = { column = "Kraft 2 [N]", unit = "A" }
nominal_current_A = 1.0
"""
"""Arcs where the force exceeds a level, so that their share is known; the current is never low."""

SECTIONS = [
    TrackSection(line="1700", track="2", name="", from_km=low, to_km=high) for low, high in [(0.30, 0.36), (0.36, 0.42)]
]


def write_profile(folder: Path, rule: str, verification: str = "shown") -> Profile:
    path = folder / "own.toml"
    text = f'schema = "pantocheck.profile/1"\nname = "own"\ntitle = "Own"\nverification = "{verification}"\n'
    path.write_text(f"{text}rule = [{{ {rule} }}]\n", encoding="utf-8")
    return load_profile(str(path))


def collect(pair: MeasuredPair, folder: Path, further: str = "", raised_N: float = 0.0, zero_mm: float = 0.0) -> Path:
    folder.mkdir(exist_ok=True)
    sidecar = pair.write(folder, STATED)
    rows = pair.train()
    rows[:, 3] += raised_N
    write_german(folder / "zug.csv", ["Zeit [s]", "Weg [m]", "Kraft 1 [N]", "Kraft 2 [N]"], rows)
    if zero_mm:
        write_masts(folder, pair.masts() + np.array([0.0, *[zero_mm] * 3]))
    sidecar.write_text(sidecar.read_text(encoding="utf-8") + PLACE + further, encoding="utf-8")
    with open_collection(folder / "runs"):
        (item,) = import_files([sidecar], folder / "runs", None)
    assert item.state == "imported", item.remarks
    return folder / "runs"


def grade(runs: Path, profile: Profile) -> list[GradedPassage]:
    (run,) = list_runs(runs)
    return list(grade_run(run, SECTIONS, profile, "provisional"))


def judge(graded: list[GradedPassage]) -> list[tuple[str, str]]:
    return [(item.passage.pantograph, item.passage.verdict) for item in graded]


def assess(runs: Path, profile: Profile, by: tuple[str, ...] = ("section", "pantograph")) -> NetworkResults:
    task = AssessmentTask(profile, "provisional", by, 0.06)  # type: ignore[arg-type]
    return combine_tracks([track for track, _ in assess_tracks(list_runs(runs), task)], list_refused(runs), task)


def test_the_uplift_is_graded_with_its_own_clock(tmp_path: Path) -> None:
    """Pulses of 50 mm at every mast: a limit of 45 mm fails, 60 mm passes, and a clock 1 s off is skipped."""
    strict = write_profile(tmp_path, 'quantity = "max_uplift_at_support_mm", upper = 45.0')
    runs = collect(MeasuredPair(), tmp_path / "a")
    graded = grade(runs, strict)
    assert judge(graded) == [("front", "fail"), ("rear", "fail")] * 2
    # The noise of 0.5 mm and the pulse of the second pantograph on the wave of the first one.
    assert graded[0].passage.values["max_uplift_at_support_mm"] == pytest.approx(50.0, abs=3.0)
    wide = write_profile(tmp_path, 'quantity = "max_uplift_at_support_mm", upper = 60.0')
    assert judge(grade(runs, wide)) == [("front", "pass"), ("rear", "pass")] * 2
    assert [item.passage.clocks for item in graded] == ["source-1.parquet confirmed"] * 4
    (group, _) = assess(runs, wide, ("section",)).groups
    assert group.clocks == "source-1.parquet confirmed"
    page = render_html(build_run_page("x", [item.passage for item in graded]))
    assert "Clocks" in page
    assert quantity_label("max_uplift_at_support_mm") in page
    wrong = collect(MeasuredPair(offset=2.217), tmp_path / "b")
    skipped = grade(wrong, wide)
    assert judge(skipped) == [("front", "skip"), ("rear", "skip")] * 2
    assert "mast" in skipped[0].passage.reason or "source-1" in skipped[0].passage.reason
    assert assess(wrong, wide).verdict == "skip"


def test_a_faulty_sensor_is_skipped_as_by_assess(tmp_path: Path) -> None:
    runs = collect(MeasuredPair(), tmp_path / "a", zero_mm=-8.0)
    graded = grade(runs, write_profile(tmp_path, 'quantity = "max_uplift_at_support_mm", upper = 45.0'))
    assert judge(graded) == [("front", "skip"), ("rear", "skip")] * 2
    assert "mm at rest, before the passage, and not 0 within 2 mm" in graded[0].passage.reason


def test_a_criterion_of_one_pantograph_is_not_that_of_the_other(tmp_path: Path) -> None:
    """Only the rear pantograph has 40 N too much."""
    runs = collect(MeasuredPair(), tmp_path / "a", raised_N=40.0)
    profile = write_profile(tmp_path, 'quantity = "mean_force_N", upper = 140.0')
    assert judge(grade(runs, profile)) == [("front", "pass"), ("rear", "fail")] * 2
    verdicts = {(group.section.from_km, group.pantograph): group.verdict for group in assess(runs, profile).groups}
    assert verdicts == {(x, name): y for x in (0.3, 0.36) for name, y in (("front", "pass"), ("rear", "fail"))}
    together = assess(runs, profile, ("section",))
    assert [(group.pantograph, group.verdict) for group in together.groups] == [(None, "fail")] * 2


def test_arcs_are_graded_and_one_pantograph_without_a_detector_is_skipped(tmp_path: Path) -> None:
    runs = collect(MeasuredPair(), tmp_path / "a", ARC)
    profile = write_profile(tmp_path, 'quantity = "arc_share_pct", upper = 0.1')
    graded = grade(runs, profile)
    force = MeasuredPair().train()
    for item, low, high in ((graded[0], 300.0, 360.0), (graded[2], 360.0, 420.0)):
        inside = (force[:, 1] >= low) & (force[:, 1] < high)
        expected = 100 * float((force[inside, 2] > 150.0).mean())
        assert item.passage.values["arc_share_pct"] == pytest.approx(expected, abs=0.2)  # one sample of 857
    assert judge(graded)[1::2] == [("rear", "skip")] * 2


def test_a_profile_that_demands_a_confirmed_record_passes_no_section(tmp_path: Path) -> None:
    """A measured record of a network is never confirmed: its checks need the pantograph."""
    runs = collect(MeasuredPair(), tmp_path / "a")
    profile = write_profile(tmp_path, 'quantity = "mean_force_N", upper = 140.0', "demanded")
    assert {verdict for _, verdict in judge(grade(runs, profile))} == {"unconfirmed"}
    assert assess(runs, profile).verdict == "unconfirmed"


def test_a_second_force_file_with_its_own_clock_is_one_run(tmp_path: Path) -> None:
    pair = MeasuredPair()
    sidecar = pair.write(tmp_path, STATED)
    write_german(tmp_path / "rear.csv", ["Zeit [s]", "Kraft [N]"], pair.train()[:, [0, 3]] - [5.0, 0.0])
    text = sidecar.read_text(encoding="utf-8").replace('force_2_N = { column = "Kraft 2 [N]" }\n', "")
    rear = '[source.columns]\ntime_s = { column = "Zeit [s]" }\nforce_2_N = { column = "Kraft [N]" }\n'
    join = 'join = { kind = "time", offset_s = 5.0, uncertainty_s = 0.002 }\n'
    sidecar.write_text(f'{text}[[source]]\nfile = "rear.csv"\n{join}{rear}{PLACE}', encoding="utf-8")
    with open_collection(tmp_path / "runs"):
        (item,) = import_files([sidecar], tmp_path / "runs", None)
    assert item.state == "imported", item.remarks
    graded = grade(tmp_path / "runs", write_profile(tmp_path, 'quantity = "mean_force_N", upper = 140.0'))
    assert judge(graded) == [("front", "pass"), ("rear", "pass")] * 2

"""Assessment of a collection: equal to the assessment of each record, and no section passes without full cover."""

import datetime
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomli_w

from helpers.measured_runs import FORCE_PROFILE, write_run
from pantocheck.conformance.cases.profile_file import Profile, load_profile
from pantocheck.conformance.comparison.profile_grading import grade_record
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.network.network_assessment import (
    AssessmentTask,
    assess_tracks,
    combine_tracks,
    judge_network,
)
from pantocheck.conformance.network.run_collection import import_files, list_refused, list_runs, open_collection
from pantocheck.conformance.network.section_grading import grade_run, list_grid
from pantocheck.conformance.network.track_places import read_places
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.network_page import build_network_page, build_run_page
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.results.network_format import NetworkResults, SectionGroup

pytest.importorskip("pyarrow")


@pytest.fixture(scope="module")
def profile(tmp_path_factory: pytest.TempPathFactory) -> Profile:
    path = tmp_path_factory.mktemp("profile") / "force.toml"
    path.write_text(FORCE_PROFILE, encoding="utf-8")
    return load_profile(str(path))


def assess(files: list[Path], folder: Path, profile: Profile, **changes: object) -> NetworkResults:
    with open_collection(folder):
        list(import_files(files, folder, None))
    task = AssessmentTask(profile, "provisional", ("section", "speed", "direction", "pantograph"), 0.5)
    task = replace(task, **changes)  # type: ignore[arg-type]
    return combine_tracks([track for track, _ in assess_tracks(list_runs(folder), task)], list_refused(folder), task)


def judge_sections(results: NetworkResults) -> dict[float, str]:
    return {group.section.from_km: group.verdict for group in results.groups}


def remove_samples(path: Path, kept: object) -> None:
    head, *rows = path.read_text(encoding="utf-8").splitlines()
    path.write_text("\n".join([head, *np.array(rows)[kept]]) + "\n", encoding="utf-8")  # type: ignore[index]


@pytest.mark.parametrize("damage", ["none", "gap", "uneven"])
def test_sections_equal_the_assessment_of_the_record(damage: str, tmp_path: Path, profile: Profile) -> None:
    """A section is graded from its own stretch of the record; the sums of floats agree to 1e-12."""
    path = write_run(tmp_path, "a", ends_km=(13.1, 9.9), dip_km=11.7)
    n = len(path.read_text(encoding="utf-8").splitlines()) - 1
    kept = np.ones(n, dtype=bool)
    if damage == "gap":
        kept[n // 3 : n // 3 + 300] = False
    elif damage == "uneven":
        kept[::7] = False
    remove_samples(path, kept)
    with open_collection(tmp_path / "runs"):
        list(import_files([path], tmp_path / "runs", None))
    (run,) = list_runs(tmp_path / "runs")
    compared = 0
    for graded in grade_run(run, list_grid("1700", "2", [(9.9, 13.1)], 0.5), profile, "provisional"):
        passage = graded.passage
        if not passage.whole:
            assert passage.verdict == "skip"
            continue
        ends = sorted(1000 * (13.1 - km) for km in (passage.section.from_km, passage.section.to_km))
        tree = read_toml(path.with_suffix(".toml"), "sidecar")
        tree |= {"evaluated_m": ends, "speed_km_h": passage.speed_km_h}
        path.with_suffix(".toml").write_text(tomli_w.dumps(tree), encoding="utf-8")
        record = load_assessed_record(path, profile, LineTable())
        assert passage.verdict == grade_record(record, profile, "provisional").verdict
        assert graded.all_values.keys() == record.values.values.keys()
        for owner, values in record.values.values.items():
            assert graded.all_values[owner].keys() == values.keys()
            for name, value in values.items():
                assert graded.all_values[owner][name] == pytest.approx(value, rel=1e-12, abs=1e-10), name
                compared += 1
    assert compared > 60


def test_a_section_without_full_cover_does_not_pass(tmp_path: Path, profile: Profile) -> None:
    whole = write_run(tmp_path, "whole", ends_km=(10.0, 12.0))
    results = assess([whole], tmp_path / "runs", profile)
    assert judge_sections(results) == {10.0: "pass", 10.5: "pass", 11.0: "pass", 11.5: "pass"}
    assert (results.verdict, results.measured_km, results.total_km) == ("pass", 2.0, 2.0)

    gap = write_run(tmp_path, "gap", ends_km=(10.0, 12.0), day=2, seed=1)
    km = np.linspace(10.0, 12.0, len(gap.read_text(encoding="utf-8").splitlines()) - 1)
    remove_samples(gap, (km < 11.2) | (km > 11.21))
    results = assess([gap], tmp_path / "gapped", profile)
    assert judge_sections(results)[11.0] == results.verdict == "skip"
    results = assess([whole, gap], tmp_path / "both", profile)
    assert judge_sections(results)[11.0] == "skip"  # a passage with a gap may hide the worst place

    cut = write_run(tmp_path, "cut", ends_km=(10.0, 12.0), day=3, seed=2)
    sidecar = cut.with_suffix(".toml")
    sidecar.write_text("evaluated_m = [0.0, 1999.0]\n" + sidecar.read_text(encoding="utf-8"), encoding="utf-8")
    remove_samples(cut, km < 11.3)
    results = assess([cut], tmp_path / "cut-runs", profile)
    assert judge_sections(results) == {10.0: "pass", 10.5: "pass", 11.0: "skip", 11.5: "skip"}


def test_a_section_that_no_run_measured_is_skipped(tmp_path: Path, profile: Profile) -> None:
    """The runs leave the track from 10.5 to 11 km; another one ends inside the section from 11.5 km."""
    ends = [(10.0, 10.5), (11.0, 11.5), (11.5, 11.8)]
    files = [write_run(tmp_path, f"run{i}", ends_km=pair, seed=i) for i, pair in enumerate(ends)]
    results = assess(files, tmp_path / "runs", profile)
    assert judge_sections(results) == {10.0: "pass", 10.5: "skip", 11.0: "pass", 11.5: "skip"}
    assert {group.reason for group in results.groups if group.verdict == "skip"} == {
        "no run measured the whole section"
    }
    assert [group.partial for group in results.groups] == [0, 0, 0, 1]
    assert (results.verdict, results.measured_km, results.total_km) == ("skip", 1.0, 2.0)
    assert results.reason == "2 of 4 sections pass; 2 of 4 sections skip"


@pytest.mark.parametrize(
    ("verdicts", "refused", "expected"),
    [
        (["pass", "info"], 0, "pass"),
        (["info"], 0, "info"),
        (["pass", "skip"], 0, "skip"),
        (["skip", "fail"], 0, "fail"),
        (["pass", "pass"], 1, "skip"),
        (["info"], 1, "skip"),
        (["unconfirmed"], 1, "skip"),
        (["pass", "fail"], 1, "fail"),
        (["error"], 1, "error"),
    ],
)
def test_a_refused_file_lowers_the_verdict_and_hides_no_failure(
    verdicts: list[str], refused: int, expected: str
) -> None:
    groups = [SectionGroup.model_construct(verdict=verdict) for verdict in verdicts]
    verdict, reason = judge_network(groups, [object()] * refused)
    assert verdict == expected
    assert ("1 files refused" in reason) == bool(refused)


def test_a_verdict_counts_for_its_class_and_an_incomplete_passage_for_every_speed(
    tmp_path: Path, profile: Profile
) -> None:
    """One run ends early: it has no speed, and is skipped in both classes of speed, but in its own direction only."""
    fast = write_run(tmp_path, "fast", ends_km=(10.0, 11.0))
    slow = write_run(tmp_path, "slow", ends_km=(11.0, 10.0), day=2, speed_km_h=200.0, seed=1)
    cut = write_run(tmp_path, "cut", ends_km=(10.0, 11.0), day=3, seed=2)
    sidecar = cut.with_suffix(".toml")
    sidecar.write_text("evaluated_m = [0.0, 999.0]\n" + sidecar.read_text(encoding="utf-8"), encoding="utf-8")
    km = np.linspace(10.0, 11.0, len(cut.read_text(encoding="utf-8").splitlines()) - 1)
    remove_samples(cut, km < 10.7)
    found: dict[tuple[str, ...], dict[object, str]] = {}
    for by in [(), ("speed",), ("direction",), ("speed", "direction")]:
        results = assess([fast, slow, cut], tmp_path / "runs", profile, by=by)
        later = [group for group in results.groups if group.section.from_km == 10.5]
        found[by] = {(group.speed_km_h and group.speed_km_h[0], group.direction): group.verdict for group in later}
    assert found[()] == {(None, None): "skip"}
    assert found["speed",] == {(200.0, None): "skip", (250.0, None): "skip"}
    assert found["direction",] == {(None, "increasing"): "skip", (None, "decreasing"): "pass"}
    assert found["speed", "direction"] == {(200.0, "decreasing"): "pass", (250.0, "increasing"): "skip"}


def test_less_information_improves_no_verdict(tmp_path: Path, profile: Profile) -> None:
    """The bad run fails by the contact loss of its dip; without its force, its file is refused, and nothing passes."""
    good = write_run(tmp_path, "good", ends_km=(10.0, 11.0))
    bad = write_run(tmp_path, "bad", ends_km=(10.0, 11.0), day=2, seed=1, dip_km=10.7)
    results = assess([good, bad], tmp_path / "runs", profile)
    assert judge_sections(results) == {10.0: "pass", 10.5: "fail"}
    assert results.groups[1].reason.startswith("contact_loss_pct")
    bad.write_text(bad.read_text(encoding="utf-8").replace("Kraft", "Strom"), encoding="utf-8")
    results = assess([good, bad], tmp_path / "less", profile)
    assert judge_sections(results) == {10.0: "pass", 10.5: "pass"}
    assert results.verdict == "skip"
    assert [Path(item.file).name for item in results.refused] == ["bad.csv"]
    slow = write_run(tmp_path, "slow", ends_km=(10.0, 11.0), day=3, speed_km_h=200.0, mean=130.0, seed=3)
    results = assess([good, slow], tmp_path / "speeds", profile)
    found = {(group.section.from_km, group.speed_km_h): group.verdict for group in results.groups}
    # 0.00097 v^2 + 70 N: 108.8 N at 200 km/h, 130.6 N at 250 km/h.
    assert found[10.5, (200.0, 210.0)] == "fail"
    assert found[10.5, (250.0, 260.0)] == "pass"


def test_repeats_have_a_range_and_a_drift(tmp_path: Path, profile: Profile) -> None:
    """Means of 100, 102, 104, 106 N on four days: drift 6 N, and a mean range of t(0.975, 3) s / 2 = 4.11 N."""
    days = (1, 2, 3, 4)
    files = [
        write_run(tmp_path, f"run{day}", ends_km=(10.0, 10.5), day=day, mean=98.0 + 2 * day, seed=day) for day in days
    ]
    (group,) = assess(files, tmp_path / "runs", profile).groups
    value = group.values["mean_force_N"]
    # The noise of 3 N gives the mean of 3600 samples a deviation of 0.05 N.
    assert (value.passages, value.drifts, group.dates[1]) == (4, True, datetime.date(2026, 5, 4))
    assert value.drift == pytest.approx(6.0, abs=0.3)
    assert value.mean_range == pytest.approx(3.182 * np.std([0, 2, 4, 6], ddof=1) / 2, rel=0.05)
    assert not group.values["std_force_N"].drifts


def test_a_section_and_a_passage_that_differ_are_named(tmp_path: Path, profile: Profile) -> None:
    """Of ten sections, the force of one swings by 42 N instead of 28 N in all runs; one run has 10 N too much."""
    files = []
    for day in (1, 2, 3):
        mean = 110.0 if day == 3 else 100.0
        path = write_run(
            tmp_path, f"run{day}", ends_km=(10.0, 15.0), day=day, seed=day, mean=mean, wide_km=(12.0, 12.5)
        )
        files.append(path)
    unusual = assess(files, tmp_path / "runs", profile).unusual
    lines = {(x.section.from_km, x.quantity) for x in unusual if x.run is None}
    assert lines == {(12.0, "std_force_N")}
    runs = [x for x in unusual if x.run is not None]
    assert {(x.quantity, round(x.value - x.expected)) for x in runs} == {("mean_force_N", 10)}
    assert len(runs) == 10
    assert any(x.deviation != round(x.deviation, 1) for x in runs)  # two decimals
    assert not assess(files[:2], tmp_path / "two", profile).unusual[1:]  # two passages do not tell which is wrong


def test_a_place_has_a_name_and_the_page_escapes_it(tmp_path: Path, profile: Profile) -> None:
    files = [
        write_run(tmp_path, f"run{day}", ends_km=ends, day=day, seed=day, dip_km=10.733)
        for day, ends in enumerate([(10.0, 12.5), (12.5, 10.0), (10.0, 12.5)], 1)
    ]
    table = tmp_path / "places.csv"
    rows = ["kind,name,x_km,from_km,to_km", "support,<b>17</b>,10.72,,", "overlap,U7,,10.2,10.25"]
    table.write_text("\n".join([*rows, "tension_section,N4,,10.0,12.5"]) + "\n", encoding="utf-8")
    known = tuple(read_places(table, "1700", "2"))
    results = assess(files, tmp_path / "runs", profile, known_places=known)
    assert {group.section.name for group in results.groups} == {"N4"}
    (place,) = results.places
    assert place.km == pytest.approx(10.733, abs=0.002)  # the samples are 0.5 m apart, the mean is over 3 m or more
    assert place.deviation < -place.threshold
    assert (place.found, place.passages, place.place, place.explained) == (3, 3, "support <b>17</b>", False)
    (alone,) = assess(files[:1], tmp_path / "one", profile).places
    assert alone.km == pytest.approx(10.733, abs=0.002)
    at_overlap = tuple(x.model_copy(update={"from_km": 10.7, "to_km": 10.73}) if x.name == "U7" else x for x in known)
    assert assess(files, tmp_path / "runs", profile, known_places=at_overlap).places[0].explained
    page = render_html(build_network_page(results))
    assert "&lt;b&gt;17&lt;/b&gt;" in page
    assert "<b>17" not in page
    assert f'href="runs/{place.run}.html"' in page
    assert not [part for part in ("http://", "https://", "//cdn") if f'src="{part}' in page]
    graded = grade_run(
        next(iter(list_runs(tmp_path / "runs"))), list_grid("1700", "2", [(10, 11)], 1.0), profile, "provisional"
    )
    page = render_html(build_run_page(place.run, [item.passage for item in graded]))
    assert "10.000 to 11.000" in page


@pytest.mark.parametrize(
    ("row", "fault"),
    [("17;10,5;47,25;8,5", None), ("17;10,5;47,25;", "longitude None"), ("17;10,5;147,0;8,5", "latitude 147.0")],
)
def test_coordinates_of_a_place_are_both_given_or_none(row: str, fault: str | None, tmp_path: Path) -> None:
    (tmp_path / "places.csv").write_text(f"name;x_km;latitude_deg;longitude_deg\n{row}\n", encoding="utf-8")
    with nullcontext() if fault is None else pytest.raises(InputError, match=fault):
        (place,) = read_places(tmp_path / "places.csv", "1700", "2")
        assert (place.from_km, place.latitude_deg, place.longitude_deg) == (10.5, 47.25, 8.5)


def test_a_run_with_wrong_kilometres_is_named_and_passes_nothing(tmp_path: Path, profile: Profile) -> None:
    """Of four runs over a rough line, one has kilometres that are 120 m too high, or 1.73 s late at 250 km/h."""
    files = [
        write_run(
            tmp_path, f"run{day}", ends_km=(10.0, 13.0), day=day, seed=day, rough_N=8.0, shift_km=0.12 * (day == 2)
        )
        for day in (1, 2, 3, 4)
    ]
    results = assess(files, tmp_path / "runs", profile)
    (run,) = [run.facts.run for run in list_runs(tmp_path / "runs") if run.facts.date.day == 2]
    assert {part.run for part in results.misplaced} == {run}
    assert sum(part.to_km - part.from_km for part in results.misplaced) == pytest.approx(3.0, abs=0.01)
    for part in results.misplaced:
        assert part.offset_m == pytest.approx(120.0, abs=0.5)  # one sample of the grid
        assert part.offset_s == pytest.approx(1.728, abs=0.01)
    assert {(group.verdict, group.run) for group in results.groups} == {("skip", run)}
    assert {group.reason for group in results.groups} == {"the force is that of another place"}
    assert not assess([files[0], *files[2:]], tmp_path / "right", profile).misplaced
    page = render_html(build_network_page(results))
    assert "Misplaced runs" in page
    # Two runs do not tell which of them is misplaced.
    assert not assess(files[:2], tmp_path / "two", profile).misplaced


def test_results_do_not_depend_on_the_order_of_the_import(tmp_path: Path, profile: Profile) -> None:
    files = [write_run(tmp_path, f"run{i}", ends_km=(10.0, 10.6), seed=i) for i in range(2)]
    first = assess(files, tmp_path / "runs", profile)
    assert first == assess(files[::-1], tmp_path / "others", profile)

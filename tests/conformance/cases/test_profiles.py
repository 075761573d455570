"""Profiles: published rules, records that break one of them, and the command `pantocheck assess`."""

import hashlib
import json
import re
import shutil
import tomllib
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jsonschema
import numpy as np
import pytest

from helpers.command_line import pantocheck
from helpers.record_keys import record_keys
from helpers.toml_edit import edit_toml, write_toml
from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.cases.profile_file import BoundMissing, SpeedFormula, load_profile, resolve_bounds
from pantocheck.conformance.comparison.profile_grading import assess_record
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.pages.ci_reports import render_junit
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.results.results_format import Results

NAMES = ("acceptance-ac", "acceptance-dc-3kv", "acceptance-dc-1500v", "line-test")
PASSING = library_folder() / "en50318-2002" / "known-passing-code"

LINE = {"span_m": 60.0, "wave_speed_m_s": 120.0, "uplift_space_mm": 80.0}
SIDECAR = record_keys(speed_km_h=250.0, pantographs=1, line=LINE) | {"file": "train.csv"}

Train = Callable[..., Path]
"""Writes a record with the given mean, sigma, speed, wave speed, uplift space, number of spans and supports."""


@pytest.fixture
def train(tmp_path: Path) -> Train:
    """Writes a record of time and distance with known mean and sigma, and returns its path.

    The run-in of 150 m holds the rest of the first support, and the run-out of 60 m the passage of the last one.
    """

    def write(
        mean: float = 125.0, sigma: float = 30.0, speed: float = 250.0, wave: float = 120.0, space: float = 80.0,
        spans: int = 20, supports: Sequence[float] = tuple(np.arange(30.0, 1200, 60)),
    ) -> Path:  # fmt: skip
        random = np.random.default_rng(11)
        position = np.arange(-150, 60.0 * spans + 60, 0.4)
        span = np.clip(np.floor(position / 60 + 1e-9), 0, spans - 1).astype(int)
        amplitude = (1 + 0.05 * random.standard_normal(spans))[span]
        wave_form = np.sqrt(2) * amplitude * np.sin(2 * np.pi * position / 60)
        force = mean + sigma * wave_form + 3 * np.sin(2 * np.pi * position / 2)
        uplift = [55.0 * np.exp(-(((position - support) / 5) ** 2)) for support in supports]
        table = np.column_stack([3.6 * (position + 150) / speed, position, force, *uplift])
        names = ",".join(["time_s", "position_1_m", "force_1_N", *(f"uplift_{i + 1}_mm" for i in range(len(supports)))])
        np.savetxt(tmp_path / "train.csv", table, "%.9g", ",", header=names, comments="")
        line = LINE | {"wave_speed_m_s": wave, "uplift_space_mm": space}
        keys = {"speed_km_h": speed, "support_position_m": list(map(float, supports)), "line": line}
        return write_toml(tmp_path / "train.toml", SIDECAR | keys | {"evaluated_m": [15.0, 60.0 * spans - 15]})

    return write


def complete_record(
    train: Train, *, section: Sequence[float] = (15.0, 285.0), braking: bool = False, height: float = 0.05,
    without: Sequence[str] = (), **facts: float,
) -> Path:  # fmt: skip
    """Record of 5 spans with every channel and every key of a sidecar; the other facts are those of `train`.

    Args:
        train: Writer of the record.
        section: Analysis section [m].
        braking: Whether the train is 10 % slower inside the section.
        height: Range of the contact height [m].
        without: Keys to leave out.
        **facts: Arguments of `train`.
    """
    path = train(spans=5, supports=tuple(np.arange(30.0, 300, 60)), **facts)
    rows = [line.split(",") for line in path.with_suffix(".csv").read_text().splitlines()]
    table = np.array(rows[1:], dtype=np.float64)
    position = table[:, 1]
    speed = np.where(braking & (position > 100) & (position < 200), 0.9, 1.0) * 250 / 3.6
    table[:, 0] = np.concatenate([[0.0], np.cumsum(np.diff(position) / speed[1:])])
    columns = np.column_stack([speed, height / 2 * np.sin(2 * np.pi * position / 60), table])
    names = ",".join(["speed_m_s", "contact_height_1_m", *rows[0]])
    np.savetxt(path.with_suffix(".csv"), columns, "%.9g", ",", header=names, comments="")
    added = {
        "case": "own/case",
        "case_digest": f"sha256:{'0' * 64}",
        "start_m": -150.0,
        "sha256": hashlib.sha256(path.with_suffix(".csv").read_bytes()).hexdigest(),
        "system": {"name": "train", "version": "1"},
        "run": {"simulated_s": 10.0, "wall_s": 1.0, "dt_s": 0.001, "element_m": 0.5},
        "evaluated_m": list(section),
    }
    edit_toml(path, added)
    return edit_toml(path, dict.fromkeys(without))


def height_profile(folder: Path) -> str:
    """Profile of an acceptance with a rule on the contact height, which the library only compares."""
    text = (library_folder() / "profiles" / "acceptance-ac.toml").read_text()
    rule = '\n[[rule]]\nquantity = "contact_height_range_mm"\nupper = 100.0\ntrust = "primary"\nsource = "own"\n'
    (folder / "height.toml").write_text(text + rule)
    return str(folder / "height.toml")


def graded(path: Path, name: str = "acceptance-ac", **keys: Any) -> Results:
    profile = load_profile(name)
    return assess_record(load_assessed_record(path, profile, LineTable()), profile, **keys)


def by_quantity(results: Results) -> dict[str, Criterion]:
    return {criterion.quantity: criterion for criterion in results.cases[0].criteria}


@pytest.mark.parametrize("name", NAMES)
def test_shipped_profiles_follow_their_schema(name: str) -> None:
    text = (library_folder() / "profiles" / f"{name}.toml").read_text()
    jsonschema.validate(tomllib.loads(text), build_schema("profile"))
    assert load_profile(name).name == name


@pytest.mark.parametrize(
    ("name", "speed", "limit"),
    [("acceptance-ac", 300.0, 157.3), ("acceptance-dc-3kv", 200.0, 148.8), ("acceptance-dc-1500v", 250.0, 200.625)],
)
def test_mean_force_follows_the_speed(train: Train, name: str, speed: float, limit: float) -> None:
    """0.00097 v^2 + 70, 110 and 140 N, by hand."""
    row = by_quantity(graded(train(speed=speed), name))["mean_force_N"]
    assert row.upper == pytest.approx(limit)
    assert row.lower is None


def test_good_line_is_accepted_with_its_uncertainty(train: Train) -> None:
    results = graded(train())
    assert results.verdict == "pass"
    rows = by_quantity(results)
    assert set(rows) == {
        "mean_force_N", "cov_20", "statistical_min_N", "speed_over_wave_speed", "max_uplift_at_support_mm",
    }  # fmt: skip
    assert rows["speed_over_wave_speed"].value == pytest.approx(250 / 3.6 / 120)
    assert rows["max_uplift_at_support_mm"].value == pytest.approx(55, abs=0.1)
    assert 0 < rows["cov_20"].uncertainty < 0.02
    assert results.cases[0].uncertainty["1"]["cov_20"] == rows["cov_20"].uncertainty
    assert find_discrepancies(results) == []
    jsonschema.validate(results.to_dict(), build_schema("results"))


@pytest.mark.parametrize(
    ("verification", "verdict", "junit"), [("shown", "pass", "skipped"), ("demanded", "unconfirmed", "failure")]
)
def test_profile_decides_whether_an_unconfirmed_record_passes(
    train: Train, tmp_path: Path, verification: str, verdict: str, junit: str
) -> None:
    """A profile names no case, so the state is unconfirmed; it is shown by either profile."""
    profile = tmp_path / "own.toml"
    text = (library_folder() / "profiles" / "acceptance-ac.toml").read_text()
    profile.write_text(text.replace("speed_tolerance_pct", f'verification = "{verification}"\nspeed_tolerance_pct', 1))
    results = graded(train(), str(profile))
    record = results.cases[0].record
    assert (results.verdict, record.state, record.demanded) == (verdict, "unconfirmed", verification == "demanded")
    assert "need the pantograph and the line of a case, and a profile has none" in record.reason
    assert {row.verdict for row in results.cases[0].criteria} == {"pass"}
    assert find_discrepancies(results) == []
    test = ElementTree.fromstring(render_junit(results)).find(".//testcase[@name='record']")
    assert test[0].tag == junit
    accepted = graded(train(), str(profile), participation=Participation(accepted_unconfirmed=("train",)))
    assert accepted.verdict == "pass"
    if verification == "demanded":
        assert graded(train(sigma=40.0), str(profile)).verdict == "fail"
        result = pantocheck("assess", train(), "--profile", profile, "--out", tmp_path / "out", "--formats", "json")
        assert (result.exit_code, result.output.split()[0]) == (1, "UNCONFIRMED")


@pytest.mark.parametrize(
    ("change", "quantity"),
    [
        ({"mean": 131.0}, "mean_force_N"),
        ({"sigma": 40.0}, "cov_20"),
        ({"wave": 95.0}, "speed_over_wave_speed"),
        ({"space": 54.0}, "max_uplift_at_support_mm"),
    ],
)
def test_line_that_breaks_one_rule_fails_only_that_rule(train: Train, change: dict[str, float], quantity: str) -> None:
    results = graded(train(**change))
    assert results.verdict == "fail"
    assert [row.quantity for row in results.cases[0].criteria if row.verdict == "fail"] == [quantity]


def test_negative_force_or_statistical_minimum_never_passes(train: Train) -> None:
    """A wrong sign gives a low mean and a negative coefficient of variation; neither may pass."""
    rows = by_quantity(graded(train(mean=-125.0)))
    assert rows["cov_20"].verdict == "skip"
    assert "is -125 N" in rows["cov_20"].reason
    assert rows["statistical_min_N"].verdict == "fail"
    rows = by_quantity(graded(train(sigma=45.0)))
    assert rows["statistical_min_N"].verdict == "fail"


def test_rule_outside_its_range_is_skipped_and_reversed_bounds_refused(train: Train) -> None:
    results = graded(train(speed=180.0))
    assert results.verdict == "skip"
    reason = "the speed of the record is 180 km/h; the rule is valid above 200 km/h"
    assert by_quantity(results)["mean_force_N"].reason == reason
    assert find_discrepancies(results) == []
    rule = load_profile("acceptance-ac").rule[0].model_copy(update={"lower": 10.0, "upper": 5.0})
    with pytest.raises(BoundMissing, match="the lower bound of the rule, 10, is above its upper bound, 5"):
        resolve_bounds(rule, 250.0, {}, None)
    first, second = graded(train()), graded(train())
    assert first.model_copy(update={"started": None}) == second.model_copy(update={"started": None})


def test_rule_without_its_fact_of_the_line_is_skipped(train: Train) -> None:
    """The record must not decide which rules apply to it: without these facts, it would pass by the other rules."""
    results = graded(edit_toml(train(), {"line": None}))
    assert results.verdict == "skip"
    reasons = {row.quantity: row.reason for row in results.cases[0].criteria if row.verdict == "skip"}
    assert reasons == {
        "speed_over_wave_speed": "the wave speed of the line is not known: add wave_speed_m_s",
        "max_uplift_at_support_mm": "the record does not state span_m, the length of the longest span, so that the "
        "supports of the analysis section are not known; the record does not state uplift_space_mm in its table [line]",
    }
    assert find_discrepancies(results) == []


def test_uplift_needs_its_channel_and_the_length_of_a_span(train: Train) -> None:
    path = train()
    table = path.with_suffix(".csv")
    table.write_text("\n".join(",".join(line.split(",")[:3]) for line in table.read_text().splitlines()))
    rows = by_quantity(graded(path))
    assert rows["max_uplift_at_support_mm"].verdict == "skip"
    assert rows["max_uplift_at_support_mm"].reason == "the record has no uplift at supports"
    without_space = by_quantity(graded(edit_toml(path, {"line": {"wave_speed_m_s": 122.0, "span_m": 60.0}})))
    assert without_space["max_uplift_at_support_mm"].reason == (
        "the record has no uplift at supports; the record does not state uplift_space_mm in its table [line]"
    )
    path = edit_toml(train(), {"line.span_m": None})
    row = by_quantity(graded(path))["max_uplift_at_support_mm"]
    assert row.verdict == "skip"
    assert "state span_m" in row.reason


FAILING: dict[str, dict[str, Any]] = {
    "mean force": {"mean": 131.0},
    "variation": {"sigma": 40.0},
    "wave speed": {"wave": 95.0},
    "uplift space": {"space": 54.0},
    "section longer than the record": {"section": [15.0, 2500.0]},
    "braking": {"braking": True},
    "height": {"height": 0.2},
    "two missing facts": {"without": ["line.wave_speed_m_s", "line.uplift_space_mm"]},
}
"""Records with all channels that fail in one fact."""


@pytest.mark.parametrize("share", [4, pytest.param(1, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("fault", FAILING)
def test_removing_a_key_or_a_channel_gives_no_pass(train: Train, tmp_path: Path, fault: str, share: int) -> None:
    """A record that cannot be read without the key or channel is refused, which is no pass either.

    Every fourth key and channel, from another one for each fault, so that each is removed from two records.
    """
    profile = height_profile(tmp_path)
    assert graded(complete_record(train), profile).verdict == "pass"
    path = complete_record(train, **FAILING[fault])
    assert graded(path, profile).verdict in {"skip", "fail"}
    sidecar, table = path.read_text(), path.with_suffix(".csv").read_text()
    content = tomllib.loads(sidecar)
    rows = [line.split(",") for line in table.splitlines()]
    graded_without = []
    keys = [*content, *(f"line.{key}" for key in content["line"]), *(f"run.{key}" for key in content["run"])]
    chosen = slice(list(FAILING).index(fault) % share, None, share)
    for key in keys[chosen]:
        edit_toml(path, {key: None})
        with suppress(InputError):
            assert graded(path, profile).verdict != "pass", key
            graded_without.append(key)
        path.write_text(sidecar)
    edit_toml(path, {"sha256": None})
    for number, name in list(enumerate(rows[0]))[chosen]:
        path.with_suffix(".csv").write_text("\n".join(",".join(row[:number] + row[number + 1 :]) for row in rows))
        with suppress(InputError):
            assert graded(path, profile).verdict != "pass", name
            graded_without.append(name)
    optional = {"evaluated_m", "line", "system", "time_s", "speed_m_s", "position_1_m", "uplift_1_mm"}
    assert optional & {*keys[chosen], *rows[0][chosen]} <= {*graded_without}


def test_record_without_a_section_or_a_speed_is_skipped(train: Train) -> None:
    """A record that was cut short could not be told from a complete one."""
    results = graded(edit_toml(train(), {"evaluated_m": None}))
    assert results.verdict == "skip"
    reason = "the analysis section is not stated: add evaluated_m to the sidecar"
    assert by_quantity(results)["cov_20"].reason == reason
    assert find_discrepancies(results) == []
    # A record that ran at another speed could not be told from one at the stated speed.
    path = train()
    rows = [line.split(",") for line in path.with_suffix(".csv").read_text().splitlines()]
    path.with_suffix(".csv").write_text("\n".join(",".join(row[1:]) for row in rows))
    results = graded(path)
    assert results.verdict == "skip"
    reason = "the speed of the train is not recorded: add speed_m_s, or both time_s and position_1_m"
    assert by_quantity(results)["cov_20"].reason == reason


def remove_support(path: Path, number: int) -> Path:
    """Remove the uplift of a support from the table of a record; its sidecar still lists the support."""
    table = path.with_suffix(".csv")
    rows = [line.split(",") for line in table.read_text().splitlines()]
    column = rows[0].index(f"uplift_{number}_mm")
    table.write_text("\n".join(",".join(row[:column] + row[column + 1 :]) for row in rows))
    return path


def test_uplift_is_graded_only_if_every_support_has_one(train: Train) -> None:
    """The uplift of 55 mm stands at every support, so a rest of the supports would pass the limit of 80 mm."""
    assert by_quantity(graded(train()))["max_uplift_at_support_mm"].verdict == "pass"
    for number in (1, 10, 20):
        row = by_quantity(graded(remove_support(train(), number)))["max_uplift_at_support_mm"]
        assert (row.verdict, row.value) == ("skip", None)
        assert f"no uplift at 1 of 20 supports of the analysis section: {60 * number - 30} m" in row.reason
    for missing in (0, 9, 19):  # the record does not list the support either
        supports = np.delete(np.arange(30.0, 1200, 60), missing)
        row = by_quantity(graded(train(supports=supports)))["max_uplift_at_support_mm"]
        # At the ends of the record, 90 m without a support hold a further one within a span of 60 m.
        assert row.verdict == "skip"
        assert "supports of the analysis section" in row.reason


def test_every_pantograph_of_a_record_is_placed_and_graded(tmp_path: Path) -> None:
    """The rear pantograph alone has too low a force; without its distance, the record is refused."""
    time = np.arange(0, 30, 0.005)
    force = [125 + 30 * np.sqrt(2) * np.sin(2 * np.pi * time), 60 + 30 * np.sqrt(2) * np.sin(2 * np.pi * time)]
    names = ["time_s", "speed_km_h", "force_1_N", "force_2_N"]
    write_csv_table(tmp_path / "train.csv", names, np.column_stack([time, np.full(time.size, 250.0), *force]), 9)
    sidecar = tmp_path / "train.toml"
    two = SIDECAR | {"pantographs": 2, "evaluated_m": [10.0, 1900.0]}
    write_toml(sidecar, two | {"spacing_m": [100.0], "start_m": 0.0})
    verdicts = {(row.quantity, row.pantograph): row.verdict for row in graded(sidecar).cases[0].criteria}
    assert (verdicts["statistical_min_N", 1], verdicts["statistical_min_N", 2]) == ("pass", "fail")
    assert verdicts["max_uplift_at_support_mm", 0] == "skip"
    write_toml(sidecar, two)
    with pytest.raises(InputError, match="channel position: missing, and the sidecar does not state spacing_m"):
        graded(sidecar)
    write_toml(sidecar, two | {"spacing_m": [100.0]})
    with pytest.raises(InputError, match="channel position: missing, and the sidecar does not state start_m"):
        graded(sidecar)


def test_value_closer_to_a_limit_than_its_uncertainty_is_marked(train: Train) -> None:
    value = by_quantity(graded(train()))["cov_20"]
    reach = value.uncertainty
    for upper, warned in ((value.value + 0.5 * reach, True), (value.value + 2 * reach, False)):
        limit = Limit(quantity="cov_20", pantograph=1, upper=upper, trust="primary", source="own")
        results = graded(train(), limits=[limit])
        criterion = by_quantity(results)["cov_20"]
        assert any("a longer record could reverse the verdict" in remark for remark in criterion.close) == warned
        assert criterion.source == "own"


def test_line_test_compares_with_the_measured_record(train: Train, tmp_path: Path) -> None:
    profile = load_profile("line-test")
    shutil.copy(PASSING / "250.toml", tmp_path)
    stated = edit_toml(tmp_path / "250.toml", {"evaluated_m": [15.0, 1185.0]})
    measured = load_assessed_record(stated, profile, LineTable())
    simulated = load_assessed_record(train(mean=119.0, sigma=28.0), profile, LineTable())
    informative = assess_record(simulated, profile, "secondary", measured)
    assert informative.verdict == "info"  # every tolerance is provisional
    results = assess_record(simulated, profile, "provisional", measured)
    rows = by_quantity(results)
    assert results.verdict == "skip"
    height = rows["contact_height_range_mm"]
    assert height.verdict == "skip"
    assert height.reason == "the record has no contact height; the measured record does not have this quantity"
    assert (rows["mean_force_N"].lower, rows["mean_force_N"].upper) == pytest.approx((115.7, 120.7))
    assert (rows["std_force_N"].lower, rows["std_force_N"].upper) == pytest.approx((0.8 * 27.6, 1.2 * 27.6))
    assert "around the measured value 27.6 of 250" in rows["std_force_N"].source
    rules = tuple(rule for rule in profile.rule if rule.quantity != "contact_height_range_mm")
    without_height = profile.model_copy(update={"rule": rules})
    assert assess_record(simulated, without_height, "provisional", measured).verdict == "pass"
    worse = load_assessed_record(train(mean=119.0, sigma=34.0), profile, LineTable())
    assert assess_record(worse, profile, "provisional", measured).verdict == "fail"


def test_rule_without_a_bound_for_this_speed_is_skipped(train: Train) -> None:
    """One rule compares, so that the measured record's uncertainty is there; the other holds above 260 km/h only."""
    profile = load_profile("line-test")
    rule = next(rule for rule in load_profile("acceptance-ac").rule if isinstance(rule.upper, SpeedFormula))
    above = rule.model_copy(update={"upper": rule.upper.model_copy(update={"above_km_h": 260.0}), "lower": None})
    mixed = profile.model_copy(update={"rule": (*profile.rule, above)})
    subject = load_assessed_record(train(), mixed, LineTable())
    measured = load_assessed_record(train(mean=126.0), mixed, LineTable())
    rows = assess_record(subject, mixed, "provisional", measured).cases[0].criteria
    assert any(row.verdict == "skip" and "above 260 km/h" in (row.reason or "") for row in rows)


def test_line_test_needs_two_comparable_records(train: Train) -> None:
    profile = load_profile("line-test")
    simulated = load_assessed_record(train(), profile, LineTable())
    with pytest.raises(InputError, match="compares with a measured record, but there is none"):
        assess_record(simulated, profile)
    faster = load_assessed_record(PASSING / "300.toml", profile, LineTable())
    with pytest.raises(InputError, match="its speed is 300 km/h, that of train is 250 km/h"):
        assess_record(simulated, profile, measured=faster)
    with pytest.raises(InputError, match="does not compare"):
        assess_record(simulated, load_profile("acceptance-ac"), measured=simulated)


def test_peak_of_a_long_record_is_drawn(train: Train) -> None:
    """The peak is one sample of 18 000; a curve of every k-th sample would not show it."""
    path = train(spans=120, supports=[600.0])
    lines = path.with_suffix(".csv").read_text().splitlines()
    values = lines[4_501].split(",")
    lines[4_501] = ",".join([*values[:2], "700.0", *values[3:]])
    path.with_suffix(".csv").write_text("\n".join(lines))
    trace = graded(path).cases[0].traces["1"]
    assert max(trace.force_N) == 700.0
    assert len(trace.force_N) == len(trace.position_m) == len(trace.force_20_N) <= 1500
    assert np.all(np.diff(trace.position_m) > 0)


def test_assess_writes_the_same_files_as_run(train: Train, tmp_path: Path) -> None:
    out = tmp_path / "out"
    formats = ("--formats", "html,json,junit,md,badge")
    result = pantocheck("assess", train(), "--profile", "acceptance-ac", "--out", out, *formats)
    assert (result.exit_code, result.output.split()[0]) == (0, "PASS")
    assert sorted(path.name for path in out.iterdir()) == [
        "badge.svg", "certificate.html", "junit.xml", "results.json", "summary.md",
    ]  # fmt: skip
    page = (out / "certificate.html").read_text()
    assert 'data-label="Uncertainty"' in page
    assert "95\N{NO-BREAK SPACE}% interval" not in page
    assert re.search(r"± 0\.\d+", (out / "certificate.html").read_text())
    assert json.loads((out / "results.json").read_text())["cases"][0]["id"] == "acceptance-ac/train"
    assert pantocheck("assess", train(sigma=40.0), "--profile", "acceptance-ac", "--out", out).exit_code == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--profile", "acceptance-dc"], "profile 'acceptance-dc': there is no profile with this name"),
        (["--profile", "none.toml"], "profile 'none.toml': cannot be read"),
        (["--profile", "acceptance-ac", "--wave-speed-m-s", "-3"], "key wave_speed_m_s: -3 must be greater than 0"),
        (["--profile", "acceptance-ac", "--uplift-space-mm", "nan"], "key uplift_space_mm: nan is not a finite number"),
        (["--profile", "acceptance-ac", "--drift", "0"], "option --drift: 0 must be greater than 0"),
        (["--profile", "line-test"], "Add --measured RECORD2"),
        (["--profile", "acceptance-ac", "--baseline", "none.json"], "results 'none.json': cannot be read"),
    ],
)
def test_bad_options_end_with_one_message(train: Train, tmp_path: Path, arguments: list[str], message: str) -> None:
    result = pantocheck("assess", train(), *arguments, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert message in result.stderr


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"rule.1.tolerance": 1.0}, "has several kinds of bounds"),
        ({"rule.1.upper": None}, "has no bound"),
        ({"rule.1.quantity": "cov_2"}, "there is no quantity 'cov_2'"),
        ({"rule.1.quantity": "damping_ratio"}, "damping_ratio is not a quantity of a run"),
        ({"rule.0.upper.constant": None, "rule.0.upper.constant_kN": 0.07}, "constant_kN"),
        ({"rule.4.upper.given": "luck"}, "found 'luck', expected 'uplift_space_mm'"),
    ],
)
def test_wrong_profile_names_its_key(tmp_path: Path, changes: dict[str, Any], message: str) -> None:
    path = tmp_path / "own.toml"
    shutil.copy(library_folder() / "profiles" / "acceptance-ac.toml", path)
    edit_toml(path, changes)
    with pytest.raises(InputError, match=message):
        load_profile(str(path))


@pytest.mark.parametrize("name", ["tsi-ene", "TSI_ENE", "en50367", "en-50119"])
def test_a_document_that_was_not_read_has_no_profile_and_a_reason(name: str) -> None:
    with pytest.raises(InputError, match=r"No rule of this document was read in print.*give --profile mine\.toml; "):
        load_profile(name)

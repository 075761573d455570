"""Rules of a profile on summaries of two pantographs: owners, uncertainty, sources and curves."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.toml_edit import write_toml
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.cases.profile_file import Profile, load_profile
from pantocheck.conformance.comparison.profile_grading import assess_record
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.assessed_record import AssessedRecord, load_assessed_record
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.sidecar_tables import LineTable

FRONT = {"mean_force_N": 118.0, "std_force_N": 30.0}
REAR = {"mean_force_N": 122.0, "std_force_N": 36.0}


def summary(path: Path, *pantographs: dict[str, float], **keys: Any) -> AssessedRecord:
    """Summary of a train at 250 km/h."""
    content = {"schema": "pantocheck.summary/1", "speed_km_h": 250.0, "filter_cutoff_Hz": 20.0, "trust": "primary"}
    stated = {"evaluated_m": [300.0, 900.0], "source": f"report {path.stem}", "pantograph": list(pantographs)}
    write_toml(path, {key: value for key, value in (content | stated | keys).items() if value is not None})
    return load_assessed_record(path, load_profile("line-test"), LineTable())


@pytest.fixture
def profile() -> Profile:
    """Line test of mean and standard deviation."""
    profile = load_profile("line-test")
    return profile.model_copy(update={"rule": profile.rule[:2]})


@pytest.fixture
def train(tmp_path: Path) -> AssessedRecord:
    return summary(tmp_path / "train.toml", FRONT, REAR)


@pytest.fixture
def measured(tmp_path: Path) -> AssessedRecord:
    return summary(
        tmp_path / "measured.toml", {"mean_force_N": 120.0, "std_force_N": 28.0}, REAR | {"mean_force_N": 120.0}
    )


def test_profile_without_a_comparison(train: AssessedRecord, measured: AssessedRecord) -> None:
    with pytest.raises(InputError, match="does not compare with a measured record"):
        assess_record(train, load_profile("acceptance-ac"), "secondary", measured)


def test_summary_without_a_section_is_not_compared(train: AssessedRecord, profile: Profile, tmp_path: Path) -> None:
    other = summary(tmp_path / "other.toml", FRONT, REAR | {"std_force_N": 37.0}, evaluated_m=None)
    for pair in ((train, other), (other, train)):
        with pytest.raises(InputError, match="the analysis section is not stated"):
            assess_record(pair[0], profile, "provisional", pair[1])


def test_each_rule_for_each_pantograph(train: AssessedRecord, measured: AssessedRecord, profile: Profile) -> None:
    """Tolerances of 2.5 N around 120 N, and of 20 % around 28 N of the front and 36 N of the rear."""
    case = assess_record(train, profile, "provisional", measured).cases[0]
    found = [(row.quantity, row.pantograph, row.lower, row.upper, row.verdict) for row in case.criteria]
    assert found == [
        ("mean_force_N", 1, 117.5, 122.5, "pass"),
        ("mean_force_N", 2, 117.5, 122.5, "pass"),
        ("std_force_N", 1, pytest.approx(22.4), pytest.approx(33.6), "pass"),
        ("std_force_N", 2, pytest.approx(28.8), pytest.approx(43.2), "pass"),
    ]
    assert [row.limit_uncertainty for row in case.criteria] == [None] * 4, "summaries state no uncertainty"
    assert case.criteria[1].source.endswith("tolerance 2.5 N around the measured value 120 of measured")
    assert case.criteria[3].source.endswith("tolerance 20 % around the measured value 36 of measured")
    case = assess_record(train, profile, "provisional", measured).cases[0]
    assert [(group.group, group.trust, group.source) for group in case.inputs] == [
        ("record train", "primary", "report train"),
        ("record measured", "primary", "report measured"),
    ]
    assert case.notes[:2] == [
        "train: train is a summary record: its values are graded as given.",
        "measured: measured is a summary record: its values are graded as given.",
    ]
    for note, stated in (("\nThe tolerances are provisional.\n", ["The tolerances are provisional."]), ("", [])):
        noted = profile.model_copy(update={"note": note})
        assert assess_record(train, noted, "provisional", measured).cases[0].notes[2:] == stated


def test_limit_of_the_user_replaces_its_rule(train: AssessedRecord, measured: AssessedRecord, profile: Profile) -> None:
    limit = Limit(quantity="std_force_N", pantograph=2, upper=50.0, trust="primary", source="own")
    case = assess_record(train, profile, "provisional", measured, [limit]).cases[0]
    found = [(row.quantity, row.pantograph, row.upper) for row in case.criteria]
    assert found[:3] == [
        ("mean_force_N", 1, 122.5),
        ("mean_force_N", 2, 122.5),
        ("std_force_N", 1, pytest.approx(33.6)),
    ]
    assert found[3:] == [("std_force_N", 2, 50.0)]
    (change,) = case.limit_changes
    assert change.startswith("std_force_N of pantograph 2: the limit 28.8 to 43.2 is widened to <= 50")


@pytest.mark.parametrize("missing", [1, 2])
def test_missing_quantity_is_skipped(train: AssessedRecord, tmp_path: Path, profile: Profile, missing: int) -> None:
    pantographs = [dict(FRONT), dict(REAR)]
    pantographs[missing - 1] = {"mean_force_N": 120.0}
    other = summary(tmp_path / "other.toml", *(values | {"mean_force_N": 120.0} for values in pantographs))
    rows = assess_record(train, profile, "provisional", other).cases[0].criteria
    skipped = [(row.quantity, row.pantograph, row.reason) for row in rows if row.verdict == "skip"]
    assert skipped == [("std_force_N", missing, "the measured record does not have this quantity")]
    assert [row.value for row in rows if row.verdict == "skip"] == [(FRONT, REAR)[missing - 1]["std_force_N"]]


def test_curves_of_a_record_show_its_supports(tmp_path: Path) -> None:
    """Supports at 120 m and 180 m in a section from 110 m to 190 m; without listed supports there are none."""
    time = np.arange(4000) / 500
    position = 60 * time - np.array([[0.0], [100.0]])
    supports = np.array([60.0, 120.0, 180.0, 240.0])
    record = Record(
        time=time,
        speed=60.0,
        position=position,
        force=np.array([[120.0], [110.0]]) + 30 * np.sin(2 * np.pi * position / 60),
        evaluated=(110.0, 190.0),
        support_position=supports,
        support_uplift=0.05 * np.exp(-(((position[0] - supports[:, None]) / 5) ** 2)),
    )
    profile = load_profile("acceptance-ac")
    path = write_record(tmp_path / "train.csv", record)
    traces = assess_record(load_assessed_record(path, profile, LineTable()), profile).cases[0].traces
    assert {key: trace.supports_m for key, trace in traces.items()} == {"1": [120.0, 180.0], "2": [120.0, 180.0]}
    bare = write_record(tmp_path / "bare.csv", Record(time, 60.0, position, record.force, (110.0, 190.0)))
    traces = assess_record(load_assessed_record(bare, profile, LineTable()), profile).cases[0].traces
    assert {key: trace.supports_m for key, trace in traces.items()} == {"1": [], "2": []}


def test_pass_by_a_wide_own_tolerance_is_information(tmp_path: Path) -> None:
    """Wider than half of the measured value, unless the library states as much: 20 mm for the range of heights.

    No contact loss has no half: 1 % stands for it.
    """
    profile = load_profile("line-test")
    (published,) = (rule for rule in profile.rule if rule.quantity == "contact_height_range_mm")
    for quantity, value, tolerance, verdict, reason in (
        ("contact_height_range_mm", 30.0, 15.0, "pass", ""),
        ("contact_height_range_mm", 30.0, 20.0, "pass", ""),
        ("contact_height_range_mm", 30.0, 21.0, "info", "the own tolerance of 21 mm is 70 % of the measured value"),
        ("contact_height_range_mm", 0.0, 21.0, "info", "is more than any share of the measured value"),
        ("contact_loss_pct", 0.0, 0.5, "pass", ""),
        ("contact_loss_pct", 0.0, 0.6, "info", "the own tolerance of 0.6 % is 60 % of the measured value"),
        ("contact_loss_pct", 4.0, 2.1, "info", "the own tolerance of 2.1 % is 52.5 % of the measured value"),
    ):
        changes = {"quantity": quantity, "tolerance": tolerance, "trust": "own", "source": "plan 3"}
        pair = [summary(tmp_path / f"{name}.toml", {quantity: value}) for name in ("own", "measured")]
        rules = (published.model_copy(update=changes),)
        graded = assess_record(pair[0], profile.model_copy(update={"rule": rules}), "secondary", pair[1])
        (row,) = graded.cases[0].criteria
        assert (row.verdict, reason in (row.reason or "")) == (verdict, True), row

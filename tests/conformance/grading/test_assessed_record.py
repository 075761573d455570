"""Assessed record: length of a span, and facts on the line from the record or from the user."""

from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from helpers.record_keys import record_keys
from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.assessed_record import AssessedRecord, find_equal_pantograph, load_assessed_record
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.records.length_uncertainty import length_uncertainties
from pantocheck.conformance.records.sidecar_tables import LineTable

SPEED, RATE, SUMMARY = 60.0, 100.0, library_folder() / "en50318-2002" / "known-passing-code" / "250.toml"
NOTHING = LineTable()

Load = Callable[..., AssessedRecord]


@pytest.fixture
def load(tmp_path: Path) -> Load:
    """Assessed record of two pantographs 90 m apart over 1.8 km; force in kN. Keys of the sidecar may be changed."""

    def load(keys: dict[str, Any], line: LineTable = NOTHING) -> AssessedRecord:
        time = np.arange(30 * RATE) / RATE
        noise = np.random.default_rng(2).normal(0, 5, (2, time.size))
        force = np.array([[120.0], [110.0]]) + 30 * np.sin(2 * np.pi * (SPEED * time - [[0.0], [90.0]]) / 45) + noise
        columns = np.column_stack([time, *(1e-3 * force)])
        write_csv_table(tmp_path / "train.csv", ["time_s", "force_1_kN", "force_2_kN"], columns, 12)
        sidecar = record_keys(speed_km_h=3.6 * SPEED, pantographs=2, start_m=0.0, spacing_m=[90.0])
        (tmp_path / "train.toml").write_text(tomli_w.dumps(sidecar | {"file": "train.csv"} | keys))
        return load_assessed_record(tmp_path / "train.toml", load_profile("acceptance-ac"), line)

    return load


@pytest.mark.parametrize(
    ("line", "keys", "length"),
    [
        (NOTHING, {"line": {"span_m": 45.0}}, 45.0),
        (LineTable(span_m=54.0), {"line": {"span_m": 45.0}}, 54.0),
        (LineTable(span_m=54.0), {"support_position_m": [0.0, 63.0, 126.0]}, 54.0),
        (NOTHING, {"support_position_m": [0.0, 63.0, 126.0, 184.5]}, 63.0),
        (NOTHING, {"support_position_m": [126.0, 0.0, 63.0]}, 63.0),
        (NOTHING, {"support_position_m": [0.0, 4.0, 54.0, 58.0, 112.0, 116.0, 900.0]}, 52.0),  # 50 m and 54 m
        (NOTHING, {"support_position_m": [0.0, 300.0, 303.0]}, 60.0),
        (NOTHING, {}, 60.0),
    ],
)
def test_length_of_a_span_is_that_of_the_line(load: Load, line: LineTable, keys: dict[str, Any], length: float) -> None:
    """The span that the user states, that of the record, the median plausible distance of its supports, or 60 m."""
    record = load(keys, line)
    component = record.uncertainty.components["length"]
    assert f"spans of {length:g} m;" in component.basis
    for number, pooled in record.prepared.pantographs.items():
        expected = length_uncertainties(pooled, length / SPEED)
        assert component.half_widths[number] == {name: found.half_width for name, found in expected.items()}
    assert component.half_widths[1] != component.half_widths[2]


def test_same_samples_give_the_same_interval(load: Load) -> None:
    """Facts that determine no value of the force, from the user or in the sidecar, leave every half-width as it is."""
    plain = load({})
    facts = LineTable(wave_speed_m_s=122.0, uplift_space_mm=120.0)
    others = [load({}, facts), load({"run": {"wall_s": 1.5}, "system": {"name": "other"}})]
    expected = plain.uncertainty.components["length"].half_widths
    assert expected[1]["cov_20"] > 0
    for record in others:
        assert record.digest != plain.digest
        assert record.uncertainty.components["length"].half_widths == expected


def test_fact_of_the_user_replaces_that_of_the_record(load: Load) -> None:
    """216 km/h is 60 m/s, half of 120 m/s and 0.4 of 150 m/s."""
    stated = {"line": {"wave_speed_m_s": 120.0, "uplift_space_mm": 80.0}}
    for line, wave_speed, ratio in ((NOTHING, 120.0, 0.5), (LineTable(wave_speed_m_s=150.0), 150.0, 0.4)):
        record = load(stated, line)
        values = record.values.values[LINE]
        assert (values["wave_speed_m_s"], values["speed_over_wave_speed"]) == (wave_speed, pytest.approx(ratio))
        assert record.line.uplift_space_mm == 80.0
    assert "wave_speed_m_s" not in load({}).values.values[LINE]


@pytest.mark.parametrize(
    ("user", "line", "wave_speed"), [(None, None, 125.0), (None, 100.0, 100.0), (80.0, 100.0, 80.0)]
)
def test_stated_wave_speed_counts(tmp_path: Path, user: float | None, line: float | None, wave_speed: float) -> None:
    """The summary has 125 m/s among its quantities; its line table and the user state the line that is assessed."""
    path = tmp_path / "a.toml"
    path.write_text(SUMMARY.read_text())
    edit_toml(path, {"quantities.wave_speed_m_s": 125.0, "line": {} if line is None else {"wave_speed_m_s": line}})
    record = load_assessed_record(path, load_profile("acceptance-ac"), LineTable(wave_speed_m_s=user))
    assert record.values.values[LINE]["speed_over_wave_speed"] == pytest.approx(250 / 3.6 / wave_speed)


@pytest.mark.parametrize(
    ("cutoff", "fits"), [(10.0, False), (19.97, False), (19.99, True), (20.01, True), (20.03, False), (50.0, False)]
)
def test_summary_has_the_filter_of_the_profile(tmp_path: Path, cutoff: float, fits: bool) -> None:
    """A tolerance of a thousandth for printed numbers: a lower filter lowers the deviation."""
    path = tmp_path / "a.toml"
    path.write_text(SUMMARY.read_text())
    edit_toml(path, {"filter_cutoff_Hz": cutoff})
    message = f"filtered at {cutoff:g} Hz, profile acceptance-ac requires 20 Hz"
    with nullcontext() if fits else pytest.raises(InputError, match=message):
        assert load_assessed_record(path, load_profile("acceptance-ac"), NOTHING).pantographs == (1,)


def test_copy_of_the_samples_is_found_in_any_pantograph_and_unit(load: Load, tmp_path: Path) -> None:
    """The same force in newtons is a copy of that in kilonewtons; the rear alone in another record, too."""
    keys = {"evaluated_m": [100.0, 1500.0], "speed_km_h": 3.6 * SPEED}
    first = load(keys)
    assert find_equal_pantograph(first, load(keys | {"system": {"name": "other"}})) == 1
    table = (tmp_path / "train.csv").read_text().splitlines()
    values = np.array([row.split(",") for row in table[1:]], dtype=np.float64)

    placed = edit_toml(tmp_path / "train.toml", {"file": "placed.csv", "start_m": None, "spacing_m": None})
    columns = np.column_stack([values, SPEED * values[:, 0], SPEED * values[:, 0] - 90.0])
    names = ["time_s", "force_1_kN", "force_2_kN", "position_1_m", "position_2_m"]
    write_csv_table(tmp_path / "placed.csv", names, columns, 12)

    def other(front: float, rear: float) -> AssessedRecord:
        columns = np.column_stack([values[:, 0], 1e3 * (values[:, 1] + front), 1e3 * (values[:, 2] + rear)])
        columns = np.column_stack([columns, SPEED * values[:, 0], SPEED * values[:, 0] - 90.0])
        names = ["time_s", "force_1_N", "force_2_N", "position_1_m", "position_2_m"]
        write_csv_table(tmp_path / "other.csv", names, columns, 12)
        edit = {"file": "other.csv"}
        (tmp_path / "other.toml").write_text(placed.read_text())
        edit_toml(tmp_path / "other.toml", edit)
        return load_assessed_record(tmp_path / "other.toml", load_profile("acceptance-ac"), NOTHING)

    subject = load_assessed_record(placed, load_profile("acceptance-ac"), NOTHING)
    assert subject.values.values[2], "the quantities of the rear are computed"
    assert find_equal_pantograph(subject, other(0.0, 0.0)) == 1
    assert find_equal_pantograph(subject, other(0.005, 0.0)) == 2
    assert find_equal_pantograph(subject, other(0.0, 0.005)) == 1
    assert find_equal_pantograph(subject, other(0.005, 0.005)) is None


@pytest.mark.parametrize(
    ("changes", "equal"),
    [({}, 1), ({"pantograph.0.mean_force_N": 118.9}, None), ({"pantograph.0.max_force_N": 190.0}, None)],
)
def test_summary_is_a_copy_if_all_is_equal(tmp_path: Path, changes: dict[str, Any], equal: int | None) -> None:
    records = []
    for name, edit in (("a.toml", {}), ("b.toml", changes)):
        (tmp_path / name).write_text(SUMMARY.read_text())
        path = edit_toml(tmp_path / name, edit)
        records.append(load_assessed_record(path, load_profile("acceptance-ac"), NOTHING))
    assert find_equal_pantograph(*records) == equal

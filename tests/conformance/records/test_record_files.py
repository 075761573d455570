"""Records on disk: a written record reads back, other units become SI, and damage is refused with its place."""

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from numpy.testing import assert_allclose

from helpers.record_keys import record_keys
from helpers.toml_edit import edit_toml
from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.record import Record, RecordInvalid
from pantocheck.conformance.records.record_reading import open_record, read_record, read_samples
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.samples import complete_samples
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.runs.record_folder import open_record_folder

Writer = Callable[[str], Path]
CHANNELS = ("time", "position", "force", "contact_height", "support_position", "support_uplift")


@pytest.fixture
def record(wave: type[Wave], case_250: Case) -> Record:
    return wave().record(case_250)


@pytest.fixture
def written(record: Record, tmp_path: Path) -> Writer:
    """Writer of the record; gives the path of the table."""

    def write(name: str) -> Path:
        write_record(tmp_path / name, record, case="en50318-2002/250", run={"dt_s": 0.001, "wall_s": None})
        return tmp_path / name

    return write


@pytest.mark.parametrize("name", ["a.csv", "a.h5", "a.hdf5"])
def test_round_trip(written: Writer, record: Record, name: str) -> None:
    back, sidecar = read_record(written(name))
    assert sidecar.case == "en50318-2002/250"
    assert sidecar.run.dt_s == 0.001
    for key in CHANNELS:
        # Twelve significant digits are written.
        assert_allclose(getattr(back, key), getattr(record, key), rtol=1e-11, atol=1e-300)
    assert back.evaluated == record.evaluated
    assert back.filter_applied_Hz is None
    assert_allclose(back.speed, record.speed, rtol=1e-11)
    assert read_record(written(name).with_suffix(".toml"))[0].force.shape == record.force.shape


def test_two_pantographs_in_other_units_are_read_in_si(converted_record: Path, two_pantograph_record: Record) -> None:
    """Fifteen digits are written, and one factor is applied: the sample values agree to rounding."""
    record, _ = read_record(converted_record)
    samples, _, _ = read_samples(converted_record)
    assert record.evaluated == two_pantograph_record.evaluated
    for key in CHANNELS:
        assert_allclose(getattr(record, key), getattr(two_pantograph_record, key), rtol=1e-13, atol=1e-15, err_msg=key)
    assert_allclose(samples.force, two_pantograph_record.force, rtol=1e-13)


def test_speed_in_kilometres_per_hour_is_integrated_to_positions(tmp_path: Path) -> None:
    """At 216 km/h, 60 m/s, a hundred samples at 100 Hz move each pantograph by 59.4 m."""
    time = np.arange(100) / 100
    columns = [time, np.full(100, 216.0), np.full(100, 0.12), np.full(100, 0.11)]
    names = ["time_s", "speed_km_h", "force_1_kN", "force_2_kN"]
    write_csv_table(tmp_path / "a.csv", names, np.column_stack(columns), 9)
    sidecar = record_keys(speed_km_h=216.0, pantographs=2, spacing_m=[100.0])
    (tmp_path / "a.toml").write_text(tomli_w.dumps(sidecar))
    samples, described, _ = read_samples(tmp_path / "a.csv")
    _, position = complete_samples(samples, described)
    assert_allclose(position[:, -1], [59.4, -40.6], rtol=1e-12)
    assert_allclose(samples.force[:, 0], [120.0, 110.0])


@pytest.mark.parametrize("suffix", [".csv", ".h5"])
def test_missing_uplift_is_written_and_read_as_nan(tmp_path: Path, two_pantograph_record: Record, suffix: str) -> None:
    """Twelve digits in a CSV file; an infinite uplift is refused, as is a missing value of any other channel."""
    uplift = np.array(two_pantograph_record.support_uplift)
    uplift[1, 300:] = np.nan
    record = replace(two_pantograph_record, support_uplift=uplift)
    write_record(tmp_path / f"a{suffix}", record)
    back, _ = read_record(tmp_path / f"a{suffix}")
    assert_allclose(back.support_uplift, uplift, rtol=1e-11, atol=1e-15, equal_nan=True)
    uplift[1, 300] = np.inf
    with pytest.raises(RecordInvalid, match="support_uplift: 1 values are not finite, the first at sample 301"):
        replace(two_pantograph_record, support_uplift=uplift)


@pytest.mark.parametrize("seed", range(4))
def test_rows_keep_their_number_in_any_order(tmp_path: Path, two_pantograph_record: Record, seed: int) -> None:
    """Columns in any order, and the uplift of any of the supports: each row keeps its pantograph and its support."""
    # Fifteen digits are written and one factor is applied, so that the values agree to rounding.
    record, random = two_pantograph_record, np.random.default_rng(seed)
    supports = np.flatnonzero([[0, 1, 1], [0, 0, 1], [1, 0, 1], [1, 1, 1]][seed])
    columns = {"time_ms": 1e3 * record.time}
    for row in range(2):
        columns[f"position_{row + 1}_km"] = 1e-3 * record.position[row]
        columns[f"force_{row + 1}_kN"] = 1e-3 * record.force[row]
        columns[f"contact_height_{row + 1}_cm"] = 1e2 * record.contact_height[row]
    columns |= {f"uplift_{row + 1}_mm": 1e3 * record.support_uplift[row] for row in supports}
    names = [str(name) for name in random.permutation(list(columns))]
    sidecar = edit_toml(write_record(tmp_path / "a.csv", record), {"sha256": None})
    write_csv_table(tmp_path / "a.csv", names, np.column_stack([columns[name] for name in names]), 15)
    back, _ = read_record(sidecar)
    for key in ("position", "force", "contact_height"):
        assert_allclose(getattr(back, key), getattr(record, key), rtol=1e-13, atol=1e-15, err_msg=key)
    assert_allclose(back.support_position, record.support_position[supports], rtol=0)
    assert_allclose(back.support_uplift, record.support_uplift[supports], rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("channels", [("time", "position"), ("position",), ("time",), ("time", "speed")])
def test_rear_pantographs_run_behind_the_first(tmp_path: Path, channels: tuple[str, ...]) -> None:
    """The second runs 100 m behind the first and the third 50 m behind it, from any channels that place the train."""
    # At 216 km/h, 60 m/s, a sample every 3 m is a sample every 0.05 s. Twelve digits are written: 1e-9 of the position.
    values = {
        "time_ms": 50.0 * np.arange(100),
        "position_1_km": 0.5 + 0.003 * np.arange(100),
        "speed_km_h": np.full(100, 216.0),
    }
    columns = {name: values[name] for name in values if name.startswith(channels)}
    columns |= {f"force_{row}_kN": np.full(100, 0.1 + 0.01 * row) for row in (1, 2, 3)}
    write_csv_table(tmp_path / "a.csv", list(columns), np.column_stack(list(columns.values())), 12)
    sidecar = record_keys(speed_km_h=216.0, pantographs=3, spacing_m=[100.0, 50.0], start_m=500.0)
    (tmp_path / "a.toml").write_text(tomli_w.dumps(sidecar))
    record, _ = read_record(tmp_path / "a.csv")
    assert_allclose(record.position[:, 0], [500.0, 400.0, 350.0], rtol=1e-9)
    assert_allclose(record.position[:, -1], [797.0, 697.0, 647.0], rtol=1e-9)
    assert_allclose(record.time[-1] - record.time[0], 99 * 0.05, rtol=1e-9)
    assert record.evaluated == pytest.approx((500.0, 647.0))  # the track that all pantographs cross


@pytest.mark.parametrize("name", ["a.csv", "a.h5"])
def test_same_record_same_bytes(written: Writer, name: str) -> None:
    first = written(name).read_bytes()
    assert written(name).read_bytes() == first


def without_digest(path: Path) -> Path:
    """A written record whose sidecar does not state the digest of the table."""
    edit_toml(path.with_suffix(".toml"), {"sha256": None})
    return path


def damaged_csv(path: Path, line: int, text: str) -> Path:
    """A written CSV record, its digest unknown, with one line (from 1) replaced."""
    without_digest(path)
    lines = path.read_text().splitlines()
    lines[line - 1] = text
    path.write_text("\n".join(lines) + "\n")
    return path


def renamed_column(path: Path, old: str, new: str) -> Path:
    """A written CSV record, its digest unknown, with one column renamed."""
    head = path.read_text().splitlines()[0]
    assert old in head.split(",")
    return damaged_csv(path, 1, head.replace(old, new))


@pytest.mark.parametrize(
    ("line", "text", "message"),
    [
        (5, "x,1,2,3", "line 5: has 4 of 15 values"),
        (5, "abc" + ",1" * 14, "line 5, column 1: 'abc' is not a number"),
        (5, "1,2,3", "line 5: has 3 of 15 values"),
        (5, "0.003,260,nan" + ",1" * 12, "channel force: 1 values are not finite, the first at sample 4"),
        (5, "0.003,260,-1e300" + ",1" * 12, "force_1_N: sample 4 has the impossible value -1e\\+300"),
        (1, "1" + ",1" * 14, "has no head line"),
        (1, "time_s,position_1_m,contact_height_1_m", "line 2: has 15 values, expected 3"),
    ],
)
def test_damaged_csv_names_its_place(written: Writer, line: int, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_record(damaged_csv(written("a.csv"), line, text))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("force_1_N", "force_1_lbf", r"column 'force_1_lbf': unknown column.\n  Did you mean force_1_N"),
        ("force_1_N", "force_2_N", r"column 'force_2_N': the sidecar has no pantograph 2.\n  It has 1"),
        ("time_s", "force_1_kN", "repeats the channel of another column"),
        ("position_1_m", "time_ms", "repeats the channel of another column"),
        ("force_1_N", "speed_m_s", "has no channel force_N"),
    ],
)
def test_wrong_column_is_named(written: Writer, old: str, new: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_record(renamed_column(written("a.csv"), old, new))


@pytest.mark.parametrize(
    ("start", "end", "message"),
    [
        (1, None, "holds a head line but no samples"),
        (0, None, "holds no line of data"),
        (100, 200, "not evenly spaced"),
    ],
)
def test_missing_lines_are_refused(written: Writer, start: int, end: int | None, message: str) -> None:
    path = without_digest(written("a.csv"))
    lines = path.read_text().splitlines()
    del lines[start:end]
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=message):
        read_record(path)


def test_decimal_commas_and_too_many_numbers(written: Writer, record: Record, monkeypatch: pytest.MonkeyPatch) -> None:
    path = without_digest(written("a.csv"))
    path.write_text(path.read_text().replace(",", ";").replace(".", ","))
    assert_allclose(read_record(path)[0].force, record.force, rtol=1e-11)
    # The limit is lowered below the size of the table, which must not be cut silently.
    path = written("a.csv")
    monkeypatch.setattr("pantocheck.conformance.records.table_rows.MAX_SAMPLES", record.time.size)
    with pytest.raises(InputError, match=f"more than {record.time.size} numbers"):
        read_record(path)


def test_section_and_sidecar_of_a_table_are_those_of_its_files(written: Writer, record: Record, tmp_path: Path) -> None:
    sidecar = written("a.csv").with_suffix(".toml")
    assert read_record(sidecar, (200.0, 300.0))[0].evaluated == record.evaluated
    edit_toml(sidecar, {"evaluated_m": None})
    assert read_record(sidecar, (200.0, 300.0))[0].evaluated == (200.0, 300.0)
    assert read_record(sidecar)[0].evaluated != record.evaluated
    path = tmp_path / "run.csv"
    path.write_text("time_s,force_1_N\n0,120\n")
    with pytest.raises(InputError, match=r"its sidecar run\.toml is missing") as error:
        open_record(path)
    assert f"pantocheck describe {path} --sidecar {path.with_suffix('.toml')}" in str(error.value)
    with pytest.raises(InputError, match=r"record 'lost\.csv': cannot be read"):
        open_record(tmp_path / "lost.csv")


def test_truncated_empty_or_changed_table_is_refused(written: Writer) -> None:
    path = without_digest(written("a.h5"))
    path.write_bytes(path.read_bytes()[:3000])
    with pytest.raises(InputError, match="is damaged, or is not HDF5"):
        read_record(path)
    path.write_bytes(b"")
    with pytest.raises(InputError, match="is empty"):
        read_record(path)
    path = written("a.csv")
    path.write_text(path.read_text().replace("119", "118", 1))
    with pytest.raises(InputError, match="sha256"):
        read_record(path)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"filter_applied_Hz": None}, "key filter_applied_Hz: missing"),
        ({"filter_applied_Hz": -20.0}, "found -20 Hz, expected a positive cut-off"),
        ({"schema": "pantocheck.record/9"}, "key schema: version 9 of the format record"),
        ({"file": "../a.csv"}, "found the path"),
        ({"file": "b.csv"}, "record 'b.csv': cannot be read"),
        ({"speed_km_h": None, "speed_m_s": 69.4}, "key speed_m_s: unknown key"),
        ({"support_position_m": []}, r"found \[\], which is empty\.\n  Remove the key, or fill it in"),
        ({"pantographs": 2, "spacing_m": [100.0]}, r": has 1 row of force_N, expected 2\.\n  Store one row"),
        ({"pantographs": 2}, "spacing_m is missing from the sidecar, and the table has 1 row of position_m"),
    ],
)
def test_wrong_sidecar_is_refused(written: Writer, changes: dict[str, Any], message: str) -> None:
    path = without_digest(written("a.csv"))
    edit_toml(path.with_suffix(".toml"), changes)
    with pytest.raises(InputError, match=message):
        read_record(path)


def test_record_overwrites_no_case_and_has_a_known_suffix(record: Record, tmp_path: Path) -> None:
    path = tmp_path / "250.toml"
    path.write_bytes((library_folder() / "en50318-2002" / "250.toml").read_bytes())
    before = path.read_bytes()
    with pytest.raises(InputError, match=r"would overwrite 250\.toml, which is not a sidecar"):
        write_record(path.with_suffix(".csv"), record)
    assert path.read_bytes() == before
    assert not path.with_suffix(".csv").exists()
    with pytest.raises(InputError, match=r"has the unknown suffix '\.xls'"):
        write_record(tmp_path / "a.xls", record)


@pytest.mark.parametrize("name", ["a.csv", "a.h5"])
@pytest.mark.parametrize("place", ["absolute", "relative"])
def test_table_behind_a_link_out_of_its_folder_is_refused(written: Writer, name: str, place: str) -> None:
    """A record folder of another author must not make the suite read other files of the user."""
    table = written(name)
    inside = table.parent / "records"
    inside.mkdir()
    table.with_suffix(".toml").rename(inside / "a.toml")
    (inside / name).symlink_to(table if place == "absolute" else os.path.relpath(table, inside))
    for read in (
        lambda: read_record(inside / "a.toml"),
        lambda: open_record_folder(inside).run(select_cases(["en50318-2002/250"])[0]),
        lambda: load_assessed_record(inside / "a.toml", load_profile("acceptance-ac"), LineTable()),
    ):
        with pytest.raises(InputError, match="is a link to a file outside its folder"):
            read()


def test_link_inside_the_folder_and_link_to_the_folder_are_followed(written: Writer, tmp_path: Path) -> None:
    table = written("a.csv")
    table.rename(tmp_path / "b.csv")
    table.symlink_to("b.csv")
    linked = tmp_path / "linked"
    linked.symlink_to(tmp_path, target_is_directory=True)
    for path in (table, linked / "a.csv"):
        assert read_record(path)[0].rate == pytest.approx(read_record(table)[0].rate)

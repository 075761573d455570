"""Records on disk: what is written is read back, and what is damaged is refused with its place."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_reading import read_record
from pantocheck.conformance.records.record_writing import write_record

Writer = Callable[[str], Path]


@pytest.fixture
def record(wave, case_250):
    return wave().record(case_250)


@pytest.fixture
def written(record, tmp_path):
    def write(name: str):
        write_record(tmp_path / name, record, case="en50318-2002/250", run={"dt_s": 0.001, "wall_s": None})
        return tmp_path / name

    return write


@pytest.mark.parametrize("name", ["a.csv", "a.h5", "a.hdf5"])
def test_round_trip(written, record, name):
    back, sidecar = read_record(written(name))
    assert sidecar.case == "en50318-2002/250"
    assert sidecar.run.dt_s == 0.001
    for key in ("time", "position", "force", "contact_height", "support_position", "support_uplift"):
        # Twelve significant digits are written.
        assert_allclose(getattr(back, key), getattr(record, key), rtol=1e-11, atol=1e-300)
    assert back.evaluated == record.evaluated
    assert back.filter_applied_Hz is None
    assert_allclose(back.speed, record.speed, rtol=1e-11)
    assert read_record(written(name).with_suffix(".toml"))[0].force.shape == record.force.shape


@pytest.mark.parametrize("name", ["a.csv", "a.h5"])
def test_same_record_same_bytes(written, name):
    first = written(name).read_bytes()
    assert written(name).read_bytes() == first


def without_digest(path):
    sidecar = path.with_suffix(".toml")
    sidecar.write_text("\n".join(line for line in sidecar.read_text().splitlines() if not line.startswith("sha256")))
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
        (5, "x,1,2,3", "line 5: does not fit: 4 values, expected 15"),
        (5, "abc" + ",1" * 14, "line 5, column 1: 'abc' is not a number"),
        (5, "1,2,3", "line 5: does not fit: 3 values, expected 15"),
        (5, "0.003,260,nan" + ",1" * 12, "channel force: 1 values are not finite, the first at sample 4"),
        (5, "0.003,260,-1e300" + ",1" * 12, "force_1_N: -1e\\+300 at sample 4 is impossible"),
        (1, "1" + ",1" * 14, "has no head line"),
        (1, "time_s,position_1_m,contact_height_1_m", "line 2: does not fit: 15 values, expected 3"),
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
        ("time_s", "force_1_kN", "two columns have the same name"),
        ("position_1_m", "time_ms", "two columns have the same name"),
        ("force_1_N", "speed_m_s", "there is no channel force_N"),
    ],
)
def test_wrong_column_is_named(written: Writer, old: str, new: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_record(renamed_column(written("a.csv"), old, new))


@pytest.mark.parametrize(
    ("start", "end", "message"),
    [(1, None, "holds a head line but no samples"), (0, None, "holds no data"), (100, 200, "not evenly spaced")],
)
def test_missing_lines_are_refused(written: Writer, start: int, end: int | None, message: str) -> None:
    path = without_digest(written("a.csv"))
    lines = path.read_text().splitlines()
    del lines[start:end]
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=message):
        read_record(path)


def test_decimal_commas_are_read(written: Writer, record: Record) -> None:
    path = without_digest(written("a.csv"))
    path.write_text(path.read_text().replace(",", ";").replace(".", ","))
    assert_allclose(read_record(path)[0].force, record.force, rtol=1e-11)


def test_csv_with_more_numbers_than_a_record_may_have_is_refused_not_cut(written, record, monkeypatch):
    """The limit lowered to half of what is there: read up to it, the rest would be missing without a word."""
    path = written("a.csv")
    monkeypatch.setattr("pantocheck.conformance.records.channel_rows.MAX_SAMPLES", record.time.size)
    with pytest.raises(InputError, match=f"more than {record.time.size} numbers"):
        read_record(path)


def test_stretch_of_the_case_holds_where_the_sidecar_names_none(written, record):
    sidecar = written("a.csv").with_suffix(".toml")
    assert read_record(sidecar, (200.0, 300.0))[0].evaluated == record.evaluated
    lines = sidecar.read_text().splitlines(keepends=True)
    start = next(i for i, line in enumerate(lines) if line.startswith("evaluated_m"))
    end = start if "]" in lines[start] else next(i for i in range(start, len(lines)) if lines[i].startswith("]"))
    sidecar.write_text("".join(lines[:start] + lines[end + 1 :]))
    assert read_record(sidecar, (200.0, 300.0))[0].evaluated == (200.0, 300.0)
    assert read_record(sidecar)[0].evaluated != record.evaluated


def test_truncated_or_foreign_hdf5(written, tmp_path):
    path = without_digest(written("a.h5"))
    path.write_bytes(path.read_bytes()[:3000])
    with pytest.raises(InputError, match="is damaged or not HDF5"):
        read_record(path)
    path.write_bytes(b"")
    with pytest.raises(InputError, match="is empty"):
        read_record(path)


def test_changed_table_contradicts_its_digest(written):
    path = written("a.csv")
    path.write_text(path.read_text().replace("119", "118", 1))
    with pytest.raises(InputError, match="sha256"):
        read_record(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('filter_applied_Hz = "none"', "", "key filter_applied_Hz: missing"),
        ('filter_applied_Hz = "none"', "filter_applied_Hz = -20.0", "-20 Hz is not a cut-off"),
        ('schema = "pantocheck.record/1"', 'schema = "pantocheck.record/9"', "key schema: found 'pantocheck.record/9'"),
        ('file = "a.csv"', 'file = "../a.csv"', "is a path"),
        ('file = "a.csv"', 'file = "b.csv"', "record 'b.csv': cannot be read"),
        ("speed_km_h = 250.0", "speed_m_s = 69.4", "key speed_m_s: unknown key"),
        ("pantographs = 1", "pantographs = 2", "1 rows of position_m, expected 2"),
    ],
)
def test_wrong_sidecar(written, old, new, message):
    path = without_digest(written("a.csv"))
    sidecar = path.with_suffix(".toml")
    assert old in sidecar.read_text()
    sidecar.write_text(sidecar.read_text().replace(old, new))
    with pytest.raises(InputError, match=message):
        read_record(path)


def test_record_never_overwrites_a_case_file(record, own_case):
    path = own_case("250.toml", "order = 6", "order = 4")
    before = path.read_bytes()
    with pytest.raises(InputError, match=r"would overwrite 250\.toml, which is not a sidecar"):
        write_record(path.with_suffix(".csv"), record)
    assert path.read_bytes() == before
    assert not path.with_suffix(".csv").exists()


def test_unknown_suffix(record, tmp_path):
    with pytest.raises(InputError, match=r"format '\.xls' is not known"):
        write_record(tmp_path / "a.xls", record)


def test_fuzzed_tables_never_give_a_traceback(written):
    """Bytes changed at random: read as a record with other numbers, or refused; nothing else."""
    random = np.random.default_rng(7)
    for name in ("a.csv", "a.h5"):
        path = without_digest(written(name))
        content = path.read_bytes()
        for _ in range(60):
            changed = bytearray(content)
            for at in random.integers(0, min(len(content), 4000), 4):
                changed[at] = random.integers(256)
            path.write_bytes(bytes(changed))
            try:
                record, _ = read_record(path)
            except InputError:
                continue
            assert np.isfinite(record.force).all()

"""CSV records of mass drops: round trip, decimal dialects, names of channels."""

import gc
import sys
import tomllib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
import scipy.io
import tomli_w

from helpers.drop_records import RATE, N, assert_same_record
from helpers.workbooks import convert_to_ods, write_rows
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.drop_writing import (
    select_drop_writer,
    write_drop_csv,
    write_drop_hdf5,
    write_drop_uff,
)


@pytest.mark.parametrize("name", ["S1,z", "S1;z", 'S1"z', "S1'z", "S1\nz", "S1_z\n", "S1\u2028z", "S1\tz"])
def test_names_that_no_head_line_can_hold_are_refused(tmp_path: Path, record: DropRecord, name: str) -> None:
    """Neither the file nor its sidecar is left behind."""
    named = replace(record, channels=(replace(record.channels[0], name=name), *record.channels[1:]))
    with pytest.raises(InputError, match="this name is not possible in the head line"):
        write_drop_csv(named, tmp_path / "r.csv")
    assert not list(tmp_path.iterdir())


def test_decimal_commas(tmp_path: Path, record: DropRecord) -> None:
    write_drop_csv(record, tmp_path / "r.csv")
    text = (tmp_path / "r.csv").read_text()
    (tmp_path / "r.csv").write_text(text.replace(",", ";").replace(".", ","))
    assert_same_record(read_drop_records(tmp_path / "r.csv")[0], record, 1e-8)


@pytest.mark.parametrize("name", ["plan.csv", "plan.uff"])
def test_sidecar_replaces_no_other_file(tmp_path: Path, record: DropRecord, name: str) -> None:
    """A case `plan.toml` beside the record `plan.csv` stays; a sidecar of an earlier record is replaced."""
    case, write = tmp_path / "plan.toml", select_drop_writer(Path(name))
    case.write_text('id = "own/plan"\n[mass_drop]\n')
    with pytest.raises(InputError, match=r"would overwrite plan\.toml"):
        write(record, tmp_path / name)
    assert [path.name for path in tmp_path.iterdir()] == ["plan.toml"]
    assert case.read_text() == 'id = "own/plan"\n[mass_drop]\n'
    case.write_text('[test]\nname = "earlier"\n[drop]\n')
    write(record, tmp_path / name)
    assert "earlier" not in case.read_text()


@pytest.mark.parametrize("name", ["sensors.csv", "sensors.xlsx", "sensors.ods"])
def test_channels_are_read_from_a_sheet(tmp_path: Path, record: DropRecord, name: str) -> None:
    """The sheet replaces the tables [[channel]]; a position may be given in another unit."""
    write_drop_csv(record, tmp_path / "r.csv")
    tree = tomllib.loads((tmp_path / "r.toml").read_text())
    channels = tree.pop("channel")
    (tmp_path / "r.toml").write_text(tomli_w.dumps({"channel_file": name} | tree))
    keys = list(dict.fromkeys(key for channel in channels for key in channel))
    rows = [keys, *([channel.get(key) for key in keys] for channel in channels)]
    if name == "sensors.csv":
        text = "\n".join(";".join("" if cell is None else str(cell) for cell in row) for row in rows)
        (tmp_path / name).write_text(text)
    else:
        convert_to_ods(write_rows(tmp_path / "sensors.xlsx", rows, "sensors"))
    (read,) = read_drop_records(tmp_path / "r.csv")
    assert_same_record(read, record, 1e-8)
    assert read.channels == record.channels


def test_wrong_sheets_of_channels_are_refused(tmp_path: Path, record: DropRecord) -> None:
    write_drop_csv(record, tmp_path / "r.csv")
    sidecar = (tmp_path / "r.toml").read_text()
    (tmp_path / "r.toml").write_text('channel_file = "s.xlsx"\n' + sidecar)
    with pytest.raises(InputError, match="given beside channel_file"):
        read_drop_records(tmp_path / "r.csv")
    (tmp_path / "r.toml").write_text('channel_file = "s.xlsx"\n' + sidecar.partition("[[channel]]")[0])
    write_rows(tmp_path / "s.xlsx", [["column", "name", "sensor", "direction", "unit"], [0.5, "a", 1, None, "g"]])
    with pytest.raises(InputError) as caught:
        read_drop_records(tmp_path / "r.csv")
    assert [problem.where.partition("row 2")[1] for problem in caught.value.problems] == ["row 2"] * 3


# HDF5 records of mass drops: round trip of several runs, damaged files.
def test_hdf5_of_two_runs_is_read_and_a_group_in_place_of_a_table_refused(tmp_path: Path, record: DropRecord) -> None:
    write_drop_hdf5((record, record), tmp_path / "r.h5")
    runs = read_drop_records(tmp_path / "r.h5")
    assert [run.name for run in runs] == ["T run 1", "T run 2"]
    assert_same_record(runs[1], record, 0.0)
    write_drop_hdf5((record,), tmp_path / "r.h5")
    with h5py.File(tmp_path / "r.h5", "r+") as file:
        del file["run_1/acceleration"]
        file.create_group("run_1/acceleration")
    with pytest.raises(InputError, match="holds no table of samples"):
        read_drop_records(tmp_path / "r.h5")


def test_hdf5_units_and_directions_become_si_and_upward(tmp_path: Path, record: DropRecord) -> None:
    """The file describes its channels; the factor and the sign are exact."""
    write_drop_hdf5((record,), tmp_path / "r.h5")
    with h5py.File(tmp_path / "r.h5", "r+") as file:
        file["channels/unit"][0] = "mm/s2"
        file["channels/direction"][0] = f"-{record.channels[0].axis}"
    (read,) = read_drop_records(tmp_path / "r.h5")
    assert read.signals[:, 0] == pytest.approx(-1e-3 * record.signals[:, 0], rel=1e-12)
    assert read.signals[:, 1] == pytest.approx(record.signals[:, 1], rel=1e-12)


# Universal files of mass drops: round trip with and without a sidecar.
def test_uff_reads_back_from_text_and_without_a_sidecar(tmp_path: Path, record: DropRecord) -> None:
    """ASCII has twelve digits."""
    write_drop_uff(record, tmp_path / "r.uff", "ascii")
    assert_same_record(read_drop_records(tmp_path / "r.uff")[0], record, 1e-10)
    write_drop_uff(record, tmp_path / "r.uff")
    (tmp_path / "r.toml").unlink()
    (read,) = read_drop_records(tmp_path / "r.uff")
    assert (read.channels, read.drop) == (record.channels, record.drop)


@pytest.mark.parametrize("name", ["Câble_z", "mât 3", "5µ_z"])
def test_names_beyond_ascii_read_back(tmp_path: Path, record: DropRecord, name: str) -> None:
    named = replace(record, channels=(replace(record.channels[0], name=name), *record.channels[1:]))
    write_drop_uff(named, tmp_path / "u.uff")
    assert_same_record(read_drop_records(tmp_path / "u.uff")[0], named, 0.0)
    write_drop_csv(named, tmp_path / "c.csv")
    assert_same_record(read_drop_records(tmp_path / "c.csv")[0], named, 1e-8)


# MATLAB records of mass drops: both versions, matrices and vectors, the time.
@pytest.mark.parametrize("version", ["5", "7.3"])
def test_matlab(tmp_path: Path, record: DropRecord, version: str) -> None:
    write_drop_csv(record, tmp_path / "r.csv")
    path = tmp_path / "r.mat"
    if version == "5":
        scipy.io.savemat(path, {"acceleration": record.signals, "fs": RATE})
    else:
        with h5py.File(path, "w") as file:
            file["acceleration"] = record.signals.T  # MATLAB stores by columns
            file["fs"] = np.array([[RATE]])
    assert_same_record(read_drop_records(path)[0], record, 1e-12)


@pytest.mark.parametrize("name", ["Time", "T", "TIME_S"])
def test_matlab_time_is_no_signal_however_it_is_written(tmp_path: Path, record: DropRecord, name: str) -> None:
    write_drop_csv(record, tmp_path / "r.csv")
    scipy.io.savemat(tmp_path / "r.mat", {name: record.time, "acceleration": record.signals})
    assert_same_record(read_drop_records(tmp_path / "r.mat")[0], record, 1e-12)
    scipy.io.savemat(tmp_path / "r.mat", {name: 2 * record.time, "acceleration": record.signals})
    with pytest.raises(InputError, match="the time column 50 Hz"):
        read_drop_records(tmp_path / "r.mat")


@pytest.mark.parametrize("form", ["matrix", "vectors"])
def test_matlab_time_of_another_length_is_refused(tmp_path: Path, record: DropRecord, form: str) -> None:
    write_drop_csv(record, tmp_path / "r.csv")
    vectors = {channel.name: record.signals[:, c] for c, channel in enumerate(record.channels)}
    data = vectors if form == "vectors" else {"acceleration": record.signals}
    scipy.io.savemat(tmp_path / "r.mat", {"t": record.time[:-7], **data})
    with pytest.raises(InputError, match=f"{N - 7} times for {N} samples"):
        read_drop_records(tmp_path / "r.mat")


def test_matlab_tables_of_one_size_are_refused(tmp_path: Path, record: DropRecord) -> None:
    """Raw and filtered signals side by side: the file does not tell which is the record."""
    write_drop_csv(record, tmp_path / "r.csv")
    scipy.io.savemat(tmp_path / "r.mat", {"raw": record.signals, "filtered": 0.5 * record.signals, "fs": RATE})
    with pytest.raises(InputError, match=r"filtered, raw.*the same size, so that the table of samples is not known"):
        read_drop_records(tmp_path / "r.mat")


# TDMS and MDF records of mass drops, whose libraries are extras.
def write_tdms(record: DropRecord, path: Path, *factors: float) -> Path:
    """Record as TDMS with its sidecar; the sampling intervals of its channels are multiplied by the factors."""
    nptdms = pytest.importorskip("nptdms", reason="extra tdms")
    write_drop_csv(record, path.with_suffix(".csv"))
    with nptdms.TdmsWriter(str(path)) as writer:
        for channel, signal, factor in zip(record.channels, record.signals.T, factors, strict=True):
            writer.write_segment([nptdms.ChannelObject("group", channel.name, signal, {"wf_increment": factor / RATE})])
    return path


def test_tdms(tmp_path: Path, record: DropRecord) -> None:
    path = write_tdms(record, tmp_path / "r.tdms", 1, 1, 1)
    assert_same_record(read_drop_records(path)[0], record, 0.0)
    with pytest.raises(InputError, match="channels with different sampling intervals"):
        read_drop_records(write_tdms(record, path, 1, 1, 2))


def write_mdf(record: DropRecord, path: Path) -> None:
    """Record as MDF 4 with its sidecar."""
    asammdf = pytest.importorskip("asammdf", reason="extra mdf")
    write_drop_csv(record, path.with_suffix(".csv"))
    with asammdf.MDF(version="4.10") as file:
        for channel, signal in zip(record.channels, record.signals.T, strict=True):
            file.append(asammdf.Signal(signal, record.time, name=channel.name, unit="m/s2"))
        file.save(path, overwrite=True)


def test_mdf(tmp_path: Path, record: DropRecord) -> None:
    write_mdf(record, tmp_path / "r.mf4")
    assert_same_record(read_drop_records(tmp_path / "r.mf4")[0], record, 0.0)


def test_damaged_mdf_ends_in_one_message(tmp_path: Path, record: DropRecord, capfd: pytest.CaptureFixture[str]) -> None:
    """Objects of the library that are half built print no traceback when they are deleted (a pytest error here)."""
    write_mdf(record, tmp_path / "r.mf4")
    content = (tmp_path / "r.mf4").read_bytes()
    capfd.readouterr()
    for length in (70, 200, 1000):
        (tmp_path / "r.mf4").write_bytes(content[:length])
        with pytest.raises(InputError, match="is damaged, or is not MDF"):
            read_drop_records(tmp_path / "r.mf4")
    gc.collect()
    assert capfd.readouterr() == ("", "")


def test_mdf_of_two_rates_is_refused(tmp_path: Path, record: DropRecord, monkeypatch: pytest.MonkeyPatch) -> None:
    """A substitute for the package: the check belongs to the suite and must not need the extra."""
    signals = {
        channel.name: SimpleNamespace(
            name=channel.name, unit="m/s2", samples=record.signals[:, c], timestamps=(1 + (c == 2)) * record.time
        )
        for c, channel in enumerate(record.channels)
    }

    class File:
        def __init__(self, path: Path) -> None:
            self.get = signals.__getitem__
            self.channels_db = {name: ((0, c),) for c, name in enumerate(signals)}
            sizes = SimpleNamespace(cycles_nr=record.time.size, samples_byte_nr=8, invalidation_bytes_nr=0)
            self.groups = [SimpleNamespace(channel_group=sizes)]

        def __enter__(self) -> "File":
            return self

        def __exit__(self, *error: object) -> None:
            pass

    monkeypatch.setitem(sys.modules, "asammdf", SimpleNamespace(MDF=File))
    monkeypatch.setitem(sys.modules, "asammdf.blocks", SimpleNamespace())
    monkeypatch.setitem(sys.modules, "asammdf.blocks.utils", SimpleNamespace(MdfException=RuntimeError))
    write_drop_csv(record, tmp_path / "r.csv")
    (tmp_path / "r.mf4").write_bytes(b"x")
    with pytest.raises(InputError, match="channels with different sampling times"):
        read_drop_records(tmp_path / "r.mf4")
    signals[record.channels[2].name].timestamps = record.time
    assert_same_record(read_drop_records(tmp_path / "r.mf4")[0], record, 0.0)


@pytest.mark.parametrize(("suffix", "package", "extra"), [(".tdms", "nptdms", "tdms"), (".mf4", "asammdf", "mdf")])
def test_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str, package: str, extra: str) -> None:
    path = tmp_path / f"r{suffix}"
    path.write_bytes(b"x")
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(InputError, match=rf"pantocheck\[{extra}\]"):
        read_drop_records(path)

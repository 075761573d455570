"""Records: round trips, both decimal dialects, units and directions, and a clear message for every damage."""

import sys
from dataclasses import replace
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
import scipy.io
import tomli_w

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_reading import read_drop_records
from pantocheck.conformance.mass_drops.drop_record import DropChannel, DropDescription, DropLine, DropRecord
from pantocheck.conformance.mass_drops.drop_writing import write_drop_csv, write_drop_hdf5
from pantocheck.conformance.mass_drops.uff_writing import write_drop_uff

RATE, N = 100.0, 400
FLIPS = 400  # files; on fewer some of the errors that the libraries raise do not show


@pytest.fixture
def record():
    random = np.random.default_rng(0)
    channels = (
        DropChannel("S1_z", 1, "z", "CW", 12.0),
        DropChannel("S1_y", 1, "y", "CW", 12.0),
        DropChannel("S2_z", 2, "z", "MW", 40.5),
    )
    line = DropLine((60.0, 54.0), 20e3, 15e3)
    return DropRecord(
        "T",
        "made",
        RATE,
        random.standard_normal((N, 3)),
        channels,
        "acceleration",
        DropDescription(30, "CW", 33, 1.5),
        line,
    )


def same(read, record, tolerance):
    assert read.signals == pytest.approx(record.signals, abs=tolerance)
    assert (read.channels, read.drop, read.line, read.rate) == (record.channels, record.drop, record.line, record.rate)
    assert read.quantity == record.quantity


@pytest.mark.parametrize("form", ["ascii", "binary"])
def test_uff_reads_back(tmp_path, record, form):
    """Binary holds doubles; ASCII has twelve digits."""
    write_drop_uff(record, tmp_path / "r.uff", form)
    same(read_drop_records(tmp_path / "r.uff")[0], record, 0.0 if form == "binary" else 1e-10)


def test_uff_speaks_for_itself_without_a_sidecar(tmp_path, record):
    write_drop_uff(record, tmp_path / "r.uff")
    (tmp_path / "r.toml").unlink()
    (read,) = read_drop_records(tmp_path / "r.uff")
    assert read.channels == record.channels
    assert read.drop == record.drop


def test_csv_and_hdf5_read_back(tmp_path, record):
    """CSV is written with nine digits."""
    write_drop_csv(record, tmp_path / "r.csv")
    same(read_drop_records(tmp_path / "r.csv")[0], record, 1e-8)
    write_drop_hdf5((record, record), tmp_path / "r.h5")
    runs = read_drop_records(tmp_path / "r.h5")
    assert [run.name for run in runs] == ["T run 1", "T run 2"]
    same(runs[1], record, 0.0)


@pytest.mark.parametrize("name", ["Câble_z", "mât 3", "5µ_z"])
def test_names_beyond_ascii_read_back(tmp_path, record, name):
    named = replace(record, channels=(replace(record.channels[0], name=name), *record.channels[1:]))
    write_drop_uff(named, tmp_path / "u.uff")
    same(read_drop_records(tmp_path / "u.uff")[0], named, 0.0)
    write_drop_csv(named, tmp_path / "c.csv")
    same(read_drop_records(tmp_path / "c.csv")[0], named, 1e-8)


@pytest.mark.parametrize("name", ["S1,z", "S1;z", 'S1"z', "S1'z", "S1\nz", "S1_z\n", "S1\u2028z", "S1\tz"])
def test_names_that_no_head_line_can_hold_are_refused(tmp_path, record, name):
    """Neither the file nor its sidecar is left behind."""
    named = replace(record, channels=(replace(record.channels[0], name=name), *record.channels[1:]))
    with pytest.raises(InputError, match="a name that a head line cannot hold"):
        write_drop_csv(named, tmp_path / "r.csv")
    assert not list(tmp_path.iterdir())


def test_decimal_commas(tmp_path, record):
    write_drop_csv(record, tmp_path / "r.csv")
    text = (tmp_path / "r.csv").read_text()
    (tmp_path / "r.csv").write_text(text.replace(",", ";").replace(".", ","))
    same(read_drop_records(tmp_path / "r.csv")[0], record, 1e-8)


def test_units_and_directions_become_si_and_upward(tmp_path, record):
    write_drop_csv(record, tmp_path / "r.csv")
    sidecar = (
        (tmp_path / "r.toml").read_text().replace('direction = "+z"\nunit = "m/s2"', 'direction = "-z"\nunit = "g"', 1)
    )
    (tmp_path / "r.toml").write_text(sidecar)
    (read,) = read_drop_records(tmp_path / "r.csv")
    assert read.signals[:, 0] == pytest.approx(-9.80665 * record.signals[:, 0], rel=1e-6)
    assert read.signals[:, 2] == pytest.approx(record.signals[:, 2], rel=1e-6)


@pytest.mark.parametrize("version", ["5", "7.3"])
def test_matlab(tmp_path, record, version):
    write_drop_csv(record, tmp_path / "r.csv")
    path = tmp_path / "r.mat"
    if version == "5":
        scipy.io.savemat(path, {"acceleration": record.signals, "fs": RATE})
    else:
        with h5py.File(path, "w") as file:
            file["acceleration"] = record.signals.T  # MATLAB stores by columns
            file["fs"] = np.array([[RATE]])
    same(read_drop_records(path)[0], record, 1e-12)


def test_tdms(tmp_path, record):
    nptdms = pytest.importorskip("nptdms", reason="extra tdms")
    write_drop_csv(record, tmp_path / "r.csv")
    with nptdms.TdmsWriter(str(tmp_path / "r.tdms")) as writer:
        writer.write_segment(
            [
                nptdms.ChannelObject("group", channel.name, record.signals[:, c], {"wf_increment": 1 / RATE})
                for c, channel in enumerate(record.channels)
            ]
        )
    same(read_drop_records(tmp_path / "r.tdms")[0], record, 0.0)


def test_mdf(tmp_path, record):
    asammdf = pytest.importorskip("asammdf", reason="extra mdf")
    write_drop_csv(record, tmp_path / "r.csv")
    file = asammdf.MDF(version="4.10")
    signals = [
        asammdf.Signal(record.signals[:, c], record.time, name=channel.name, unit="m/s2")
        for c, channel in enumerate(record.channels)
    ]
    file.append(signals)
    file.save(tmp_path / "r.mf4", overwrite=True)
    file.close()
    same(read_drop_records(tmp_path / "r.mf4")[0], record, 0.0)


def test_tdms_with_channels_of_two_rates_is_refused(tmp_path, record):
    nptdms = pytest.importorskip("nptdms", reason="extra tdms")
    write_drop_csv(record, tmp_path / "r.csv")
    with nptdms.TdmsWriter(str(tmp_path / "r.tdms")) as writer:
        writer.write_segment(
            [
                nptdms.ChannelObject("group", one.name, record.signals[:, c], {"wf_increment": (1 + (c == 2)) / RATE})
                for c, one in enumerate(record.channels)
            ]
        )
    with pytest.raises(InputError, match="differ in sampling interval"):
        read_drop_records(tmp_path / "r.tdms")


def test_mdf_with_channels_of_two_rates_is_refused(tmp_path, record, monkeypatch):
    """The package in the clothes of what is asked of it: the check is ours and must not wait for the extra."""
    signals = {
        channel.name: SimpleNamespace(
            name=channel.name, unit="m/s2", samples=record.signals[:, c], timestamps=(1 + (c == 2)) * record.time
        )
        for c, channel in enumerate(record.channels)
    }

    class File:
        channels_db = signals

        def __init__(self, path):
            self.get = signals.__getitem__

        def __enter__(self):
            return self

        def __exit__(self, *error):
            pass

    monkeypatch.setitem(sys.modules, "asammdf", SimpleNamespace(MDF=File))
    monkeypatch.setitem(sys.modules, "asammdf.blocks", SimpleNamespace())
    monkeypatch.setitem(sys.modules, "asammdf.blocks.utils", SimpleNamespace(MdfException=RuntimeError))
    write_drop_csv(record, tmp_path / "r.csv")
    (tmp_path / "r.mf4").write_bytes(b"x")
    with pytest.raises(InputError, match="differ in sampling interval"):
        read_drop_records(tmp_path / "r.mf4")
    signals[record.channels[2].name].timestamps = record.time
    same(read_drop_records(tmp_path / "r.mf4")[0], record, 0.0)


@pytest.mark.parametrize("name", ["Time", "T", "TIME_S"])
def test_matlab_time_is_no_signal_however_it_is_written(tmp_path, record, name):
    write_drop_csv(record, tmp_path / "r.csv")
    scipy.io.savemat(tmp_path / "r.mat", {name: record.time, "acceleration": record.signals})
    same(read_drop_records(tmp_path / "r.mat")[0], record, 1e-12)
    scipy.io.savemat(tmp_path / "r.mat", {name: 2 * record.time, "acceleration": record.signals})
    with pytest.raises(InputError, match="the time column says 50"):
        read_drop_records(tmp_path / "r.mat")


@pytest.mark.parametrize("form", ["matrix", "vectors"])
def test_matlab_time_of_another_length_is_refused(tmp_path, record, form):
    write_drop_csv(record, tmp_path / "r.csv")
    vectors = {channel.name: record.signals[:, c] for c, channel in enumerate(record.channels)}
    data = vectors if form == "vectors" else {"acceleration": record.signals}
    scipy.io.savemat(tmp_path / "r.mat", {"t": record.time[:-7], **data})
    with pytest.raises(InputError, match=f"{N - 7} times for {N} samples"):
        read_drop_records(tmp_path / "r.mat")


def test_matlab_tables_of_one_size_are_refused(tmp_path, record):
    """One vector per channel under other names than the sidecar's, or raw and filtered side by side: no one is it."""
    write_drop_csv(record, tmp_path / "r.csv")
    scipy.io.savemat(tmp_path / "r.mat", {"raw": record.signals, "filtered": 0.5 * record.signals, "fs": RATE})
    with pytest.raises(InputError, match=r"filtered, raw.*several tables of one size"):
        read_drop_records(tmp_path / "r.mat")


@pytest.mark.parametrize(("suffix", "package", "extra"), [(".tdms", "nptdms", "tdms"), (".mf4", "asammdf", "mdf")])
def test_missing_extra_is_named(tmp_path, monkeypatch, suffix, package, extra):
    path = tmp_path / f"r{suffix}"
    path.write_bytes(b"x")
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(InputError, match=rf"pantocheck\[{extra}\]"):
        read_drop_records(path)


def csv_damage(change):
    """A written CSV record with its text changed."""

    def damage(folder, record):
        write_drop_csv(record, folder / "r.csv")
        path = folder / "r.csv"
        path.write_text(change(path.read_text()))
        return path

    return damage


def sidecar_damage(old, new):
    """A written CSV record with its sidecar changed."""

    def damage(folder, record):
        write_drop_csv(record, folder / "r.csv")
        path = folder / "r.toml"
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new, 1))
        return folder / "r.csv"

    return damage


def cut_binary(folder, record):
    write_drop_uff(record, folder / "r.uff")
    content = (folder / "r.uff").read_bytes()
    (folder / "r.uff").write_bytes(content[: len(content) * 2 // 3])
    return folder / "r.uff"


def cut_hdf5(folder, record):
    write_drop_hdf5((record,), folder / "r.h5")
    content = (folder / "r.h5").read_bytes()
    (folder / "r.h5").write_bytes(content[: len(content) // 2])
    return folder / "r.h5"


def without_sidecar(folder, record):
    write_drop_csv(record, folder / "r.csv")
    (folder / "r.toml").unlink()
    return folder / "r.csv"


def empty(name):
    def damage(folder, record):
        (folder / name).write_bytes(b"")
        return folder / name

    return damage


DAMAGES = {
    "nan": (csv_damage(lambda t: t.replace(t.splitlines()[5].split(",")[1], "nan", 1)), "not numbers"),
    "text": (csv_damage(lambda t: t.replace(t.splitlines()[5].split(",")[1], "oops", 1)), "'oops' is not a number"),
    "cut line": (csv_damage(lambda t: t[:-30]), "is cut short"),
    "no samples": (csv_damage(lambda t: t.splitlines()[0] + "\n"), "no samples"),
    "missing column": (
        csv_damage(lambda t: "\n".join(line.rsplit(",", 1)[0] for line in t.splitlines())),
        "missing: S2_z",
    ),
    "gap in time": (csv_damage(lambda t: "\n".join(t.splitlines()[:50] + t.splitlines()[60:])), "steps by"),
    "wrong rate": (sidecar_damage("sampling_rate_hz = 100.0", "sampling_rate_hz = 200.0"), "says 200"),
    "wrong unit": (sidecar_damage('unit = "m/s2"', 'unit = "furlong"'), "'furlong' is not known"),
    "wrong direction": (sidecar_damage('direction = "+z"', 'direction = "up"'), "'up' is not known"),
    "wrong name": (sidecar_damage('name = "S1_z"', 'name = "S9_z"'), "the sidecar calls it 'S9_z'"),
    "late trigger": (sidecar_damage("trigger_nominal_s = 1.5", "trigger_nominal_s = 15.0"), "the record ends at 4 s"),
    "no rate": (sidecar_damage("sampling_rate_hz = 100.0\n", ""), "sampling_rate_hz"),
    "mixed units": (sidecar_damage('unit = "m/s2"', 'unit = "mm"'), "mixes"),
    "channel twice": (sidecar_damage("column = 2", "column = 1"), "column 1 is described twice"),
    "cut binary": (cut_binary, "missing: S2_z"),
    "cut hdf5": (cut_hdf5, "damaged"),
    "no sidecar": (without_sidecar, "no sidecar"),
    "empty csv": (empty("r.csv"), "is empty"),
    "empty uff": (empty("r.uff"), "is empty"),
    "unknown format": (empty("r.xyz"), "'.xyz' is not known"),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_damage_is_told(tmp_path, record, name):
    damage, message = DAMAGES[name]
    with pytest.raises(InputError, match=message):
        read_drop_records(damage(tmp_path, record))


@pytest.mark.parametrize("suffix", [".uff", ".mat", ".h5", ".tdms", ".mf4", ".csv"])
def test_garbage_is_refused(tmp_path, record, suffix):
    write_drop_csv(record, tmp_path / "r.csv")
    path = tmp_path / f"r{suffix}"
    path.write_bytes(bytes(np.random.default_rng(1).integers(0, 256, 5000, dtype=np.uint8)))
    with pytest.raises(InputError):
        read_drop_records(path)


def test_hdf5_group_in_place_of_a_table_is_refused(tmp_path, record):
    write_drop_hdf5((record,), tmp_path / "r.h5")
    with h5py.File(tmp_path / "r.h5", "r+") as file:
        del file["run_1/acceleration"]
        file.create_group("run_1/acceleration")
    with pytest.raises(InputError, match="holds no table of samples"):
        read_drop_records(tmp_path / "r.h5")


def whole_file(kind, folder, record):
    if kind == "h5":
        write_drop_hdf5((record,), folder / "r.h5")
        return folder / "r.h5"
    write_drop_csv(record, folder / "r.csv")
    if kind == "tdms":
        nptdms = pytest.importorskip("nptdms", reason="extra tdms")
        with nptdms.TdmsWriter(str(folder / "r.tdms")) as writer:
            for c, channel in enumerate(record.channels):
                writer.write_segment([nptdms.ChannelObject("g", channel.name, record.signals[:, c])])
        return folder / "r.tdms"
    vectors = {channel.name: record.signals[:, c] for c, channel in enumerate(record.channels)}
    if kind == "mat 5":
        # Compressed, as MATLAB saves: scipy itself crashes on some uncompressed files with a false size.
        scipy.io.savemat(folder / "r.mat", {**vectors, "fs": RATE}, do_compression=True)
    else:
        with h5py.File(folder / "r.mat", "w") as file:
            for name, vector in vectors.items():
                file.create_dataset(name, data=vector[None, :], compression="gzip")
            file["fs"] = np.array([[RATE]])
    return folder / "r.mat"


@pytest.mark.filterwarnings("ignore")  # what the libraries have to say of damaged files
@pytest.mark.parametrize("kind", ["h5", "mat 5", "mat 7.3", "tdms"])
def test_flipped_bytes_are_read_or_refused(tmp_path, record, kind):
    """Three bytes anew, half of them in the first 700, where heads and directories are; samples may well survive.

    Every fourth MATLAB file of version 5 is cut short as well; HDF5's library itself may crash on files damaged so.
    """
    path = whole_file(kind, tmp_path, record)
    content = path.read_bytes()
    random = np.random.default_rng(20)
    refused = 0
    for k in range(FLIPS):
        damaged = bytearray(content)
        for _ in range(3):
            end = min(len(content), 700) if random.random() < 0.5 else len(content)
            damaged[random.integers(end)] = random.integers(256)
        if kind == "mat 5" and k % 4 == 0:
            damaged = damaged[: random.integers(1, end)]
        path.write_bytes(damaged)
        try:
            read_drop_records(path)
        except InputError:
            refused += 1
    assert refused > 0


def test_clipping_is_marked(tmp_path, record):
    signals = record.signals.copy()
    signals[50:60, 0] = signals[:, 0].max()
    clipped = DropRecord(record.name, record.source, RATE, signals, record.channels, drop=record.drop, line=record.line)
    write_drop_csv(clipped, tmp_path / "r.csv")
    (read,) = read_drop_records(tmp_path / "r.csv")
    assert any("clipped" in text for text in read.warnings)


def test_dead_channel_is_refused(tmp_path, record):
    signals = record.signals.copy()
    signals[:, 1] = 0.25
    dead = DropRecord(record.name, record.source, RATE, signals, record.channels, drop=record.drop)
    write_drop_csv(dead, tmp_path / "r.csv")
    with pytest.raises(InputError, match="never changes"):
        read_drop_records(tmp_path / "r.csv")


def test_own_keys_of_a_team_are_left_alone(tmp_path, record):
    write_drop_csv(record, tmp_path / "r.csv")
    text = (tmp_path / "r.toml").read_text()
    (tmp_path / "r.toml").write_text(text + "\n" + tomli_w.dumps({"weather": {"wind_m_s": 2.0}}))
    same(read_drop_records(tmp_path / "r.csv")[0], record, 1e-8)

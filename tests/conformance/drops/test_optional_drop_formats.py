"""TDMS and MDF records of mass drops, whose libraries are extras."""

import gc
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from helpers.drop_records import RATE, assert_same_record
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.drop_writing import write_drop_csv


def test_tdms(tmp_path: Path, record: DropRecord) -> None:
    nptdms = pytest.importorskip("nptdms", reason="extra tdms")
    write_drop_csv(record, tmp_path / "r.csv")
    with nptdms.TdmsWriter(str(tmp_path / "r.tdms")) as writer:
        writer.write_segment(
            [
                nptdms.ChannelObject("group", channel.name, record.signals[:, c], {"wf_increment": 1 / RATE})
                for c, channel in enumerate(record.channels)
            ]
        )
    assert_same_record(read_drop_records(tmp_path / "r.tdms")[0], record, 0.0)


def write_mdf(record: DropRecord, path: Path) -> None:
    """Record as MDF 4 with its sidecar."""
    asammdf = pytest.importorskip("asammdf", reason="extra mdf")
    write_drop_csv(record, path.with_suffix(".csv"))
    with asammdf.MDF(version="4.10") as file:
        file.append(
            [
                asammdf.Signal(record.signals[:, c], record.time, name=channel.name, unit="m/s2")
                for c, channel in enumerate(record.channels)
            ]
        )
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


def test_tdms_with_channels_of_two_rates_is_refused(tmp_path: Path, record: DropRecord) -> None:
    nptdms = pytest.importorskip("nptdms", reason="extra tdms")
    write_drop_csv(record, tmp_path / "r.csv")
    with nptdms.TdmsWriter(str(tmp_path / "r.tdms")) as writer:
        writer.write_segment(
            [
                nptdms.ChannelObject("group", one.name, record.signals[:, c], {"wf_increment": (1 + (c == 2)) / RATE})
                for c, one in enumerate(record.channels)
            ]
        )
    with pytest.raises(InputError, match="channels with different sampling intervals"):
        read_drop_records(tmp_path / "r.tdms")


def test_mdf_with_channels_of_two_rates_is_refused(
    tmp_path: Path, record: DropRecord, monkeypatch: pytest.MonkeyPatch
) -> None:
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
def test_missing_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str, package: str, extra: str
) -> None:
    path = tmp_path / f"r{suffix}"
    path.write_bytes(b"x")
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(InputError, match=rf"pantocheck\[{extra}\]"):
        read_drop_records(path)

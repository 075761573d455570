"""Damaged records of mass drops: each damage has its message, and no damage gives a traceback."""

import re
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io

from helpers.drop_records import RATE
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.drop_writing import select_drop_writer, write_drop_csv, write_drop_hdf5

Damage = Callable[[Path, DropRecord], Path]
"""Writes a record into a folder, damages it and gives its path."""

FLIPS = 400  # files; on fewer some of the errors that the libraries raise do not show


def change_text(suffix: str, change: Callable[[str], str]) -> Damage:
    """A written CSV record with its text or that of its sidecar changed."""

    def damage(folder: Path, record: DropRecord) -> Path:
        write_drop_csv(record, folder / "r.csv")
        path = folder / f"r{suffix}"
        text = path.read_text()
        assert change(text) != text
        path.write_text(change(text))
        return folder / "r.csv"

    return damage


def change_bytes(name: str, change: Callable[[bytes], bytes]) -> Damage:
    """A written universal file of three data sets, or HDF5 file, with its bytes changed."""

    def damage(folder: Path, record: DropRecord) -> Path:
        select_drop_writer(folder / name)(record, folder / name)
        (folder / name).write_bytes(change((folder / name).read_bytes()))
        return folder / name

    return damage


def cut(name: str, share: float) -> Damage:
    return change_bytes(name, lambda content: content[: int(len(content) * share)])


def replace_value(text: str) -> Damage:
    return change_text(".csv", lambda t: t.replace(t.splitlines()[5].split(",")[1], text, 1))


def replace_key(old: str, new: str) -> Damage:
    return change_text(".toml", lambda t: t.replace(old, new, 1))


def empty(name: str) -> Damage:
    def damage(folder: Path, record: DropRecord) -> Path:
        (folder / name).write_bytes(b"")
        return folder / name

    return damage


def remove_sidecar(folder: Path, record: DropRecord) -> Path:
    write_drop_csv(record, folder / "r.csv")
    (folder / "r.toml").unlink()
    return folder / "r.csv"


DAMAGES = {
    "nan": (replace_value("nan"), "not finite, the first at 0.04 s"),
    "text": (replace_value("oops"), "'oops' is not a number"),
    "cut line": (change_text(".csv", lambda t: t[:-30]), "line 401: has 2 of 4 values"),
    "no samples": (change_text(".csv", lambda t: t.splitlines()[0] + "\n"), "no samples"),
    "missing column": (change_text(".csv", lambda t: re.sub(",[^,\n]*\n", "\n", t)), "S2_z missing"),
    "wrong unit": (replace_key('unit = "m/s2"', 'unit = "furlong"'), "unknown unit 'furlong'"),
    "wrong direction": (replace_key('direction = "+z"', 'direction = "up"'), "unknown direction 'up'"),
    "late trigger": (replace_key("nominal_s = 1.5", "nominal_s = 15.0"), "after the end of the record at 4 s"),
    "no rate": (replace_key("sampling_rate_hz = 100.0\n", ""), "sampling_rate_hz"),
    "cut binary": (cut("r.uff", 2 / 3), r"S2_z missing\)\.\s+It may be truncated: copy or export it again"),
    "cut inside a data set": (cut("r.uff", 3 / 5), r"ends inside a data set\.\s+It may be truncated"),
    "type of numbers that does not exist (0 in place of 4)": (
        change_bytes("r.uff", lambda c: c.replace(b"         4       400", b"         0       400", 1)),
        "damaged, or is not a universal file",
    ),
    "cut hdf5": (cut("r.h5", 1 / 2), "damaged"),
    "no sidecar": (remove_sidecar, "nor a sidecar"),
    "empty csv": (empty("r.csv"), "is empty"),
    "empty uff": (empty("r.uff"), "is empty"),
    "unknown format": (empty("r.xyz"), "unknown suffix '.xyz'"),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_damage_is_told(tmp_path: Path, record: DropRecord, name: str) -> None:
    damage, message = DAMAGES[name]
    with pytest.raises(InputError, match=message):
        read_drop_records(damage(tmp_path, record))


@pytest.mark.parametrize("suffix", [".uff", ".mat", ".h5", ".tdms", ".mf4", ".csv"])
def test_garbage_is_refused(tmp_path: Path, record: DropRecord, suffix: str) -> None:
    write_drop_csv(record, tmp_path / "r.csv")
    path = tmp_path / f"r{suffix}"
    path.write_bytes(bytes(np.random.default_rng(1).integers(0, 256, 5000, dtype=np.uint8)))
    with pytest.raises(InputError):
        read_drop_records(path)


def whole_file(kind: str, folder: Path, record: DropRecord) -> Path:
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


@pytest.mark.thorough
@pytest.mark.filterwarnings("ignore")  # what the libraries have to say of damaged files
@pytest.mark.parametrize("kind", ["h5", "mat 5", "mat 7.3", "tdms"])
def test_flipped_bytes_are_read_or_refused(tmp_path: Path, record: DropRecord, kind: str) -> None:
    """Three bytes anew, half of them in the first 700, where heads and directories are; samples may well survive."""
    # Every fourth MATLAB file of version 5 is cut short as well; HDF5's library itself may crash on files damaged so.
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

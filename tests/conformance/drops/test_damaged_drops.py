"""Damaged records of mass drops: each damage has its message, and no damage gives a traceback."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.drop_writing import select_drop_writer, write_drop_csv

Damage = Callable[[Path, DropRecord], Path]
"""Writes a record into a folder, damages it and gives its path."""


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

"""Universal files of mass drops: round trip with and without a sidecar."""

from dataclasses import replace
from pathlib import Path
from typing import Literal

import pytest

from helpers.drop_records import assert_same_record
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.drop_writing import write_drop_csv, write_drop_uff


@pytest.mark.parametrize("form", ["ascii", "binary"])
def test_uff_reads_back(tmp_path: Path, record: DropRecord, form: Literal["ascii", "binary"]) -> None:
    """Binary holds doubles; ASCII has twelve digits."""
    write_drop_uff(record, tmp_path / "r.uff", form)
    assert_same_record(read_drop_records(tmp_path / "r.uff")[0], record, 0.0 if form == "binary" else 1e-10)


def test_uff_speaks_for_itself_without_a_sidecar(tmp_path: Path, record: DropRecord) -> None:
    write_drop_uff(record, tmp_path / "r.uff")
    (tmp_path / "r.toml").unlink()
    (read,) = read_drop_records(tmp_path / "r.uff")
    assert read.channels == record.channels
    assert read.drop == record.drop


@pytest.mark.parametrize("name", ["Câble_z", "mât 3", "5µ_z"])
def test_names_beyond_ascii_read_back(tmp_path: Path, record: DropRecord, name: str) -> None:
    named = replace(record, channels=(replace(record.channels[0], name=name), *record.channels[1:]))
    write_drop_uff(named, tmp_path / "u.uff")
    assert_same_record(read_drop_records(tmp_path / "u.uff")[0], named, 0.0)
    write_drop_csv(named, tmp_path / "c.csv")
    assert_same_record(read_drop_records(tmp_path / "c.csv")[0], named, 1e-8)

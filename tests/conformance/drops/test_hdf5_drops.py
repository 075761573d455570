"""HDF5 records of mass drops: round trip of several runs, damaged files."""

from pathlib import Path

import h5py
import pytest

from helpers.drop_records import assert_same_record
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.drop_writing import write_drop_hdf5


def test_hdf5_reads_back(tmp_path: Path, record: DropRecord) -> None:
    write_drop_hdf5((record, record), tmp_path / "r.h5")
    runs = read_drop_records(tmp_path / "r.h5")
    assert [run.name for run in runs] == ["T run 1", "T run 2"]
    assert_same_record(runs[1], record, 0.0)


def test_hdf5_group_in_place_of_a_table_is_refused(tmp_path: Path, record: DropRecord) -> None:
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

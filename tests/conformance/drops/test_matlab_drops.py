"""MATLAB records of mass drops: both versions, matrices and vectors, the time."""

from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io

from helpers.drop_records import RATE, N, assert_same_record
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.drop_writing import write_drop_csv


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

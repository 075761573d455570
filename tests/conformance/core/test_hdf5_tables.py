"""HDF5 tables: runs with a description of their channels, data sets at the root, and the place of every fault."""

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.testing import assert_array_equal

from pantocheck.conformance.core import hdf5_table
from pantocheck.conformance.core.hdf5_table import write_hdf5_table
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import MeasuredTable, TableColumn, read_tables

SAMPLES = np.random.default_rng(2).standard_normal((3, 20))
DESCRIPTION = {
    "name": ["a", "b", "c"],
    "unit": ["g", "m/s2", "mm/s2"],
    "sensor": [4, 5, 6],
    "wire": ["CW", "MW", ""],
    "position_m": [1.5, np.nan, -2.0],
    "direction": ["+z", "-y", "+x"],
}


def write_runs(path: Path, *numbers: str, rate: float | None = 50.0, quantity: str = "acceleration") -> None:
    """File with one run per number, whose samples are multiples of `SAMPLES`."""
    datasets = {f"channels/{key}": values for key, values in DESCRIPTION.items()}
    datasets |= {f"run_{number}/{quantity}": k * SAMPLES for k, number in enumerate(numbers, 1)}
    write_hdf5_table(path, {"test": "T"} | ({} if rate is None else {"sampling_rate_hz": rate}), datasets)


def read(path: Path, names: tuple[str, ...] = ()) -> list[MeasuredTable]:
    return read_tables(path, names, 1000)


@pytest.mark.parametrize("quantity", ["acceleration", "velocity", "displacement"])
def test_runs_follow_their_numbers(quantity: str, tmp_path: Path) -> None:
    """Run 10 follows run 2, although it is the first by its name."""
    write_runs(tmp_path / "r.h5", "10", "2", "1", quantity=quantity)
    tables = read(tmp_path / "r.h5")
    assert [table.run for table in tables] == [1, 2, 3]
    for table, factor in zip(tables, (3, 2, 1), strict=True):
        assert_array_equal(table.values, factor * SAMPLES.T)
        assert (table.rate, table.attributes["test"]) == (50.0, "T")


def test_channels_are_those_of_the_description(tmp_path: Path) -> None:
    write_runs(tmp_path / "r.h5", "1", rate=None)
    (table,) = read(tmp_path / "r.h5")
    assert (table.run, table.rate) == (0, None)
    assert table.columns == (
        TableColumn("a", 1, "g", 4, "CW", 1.5, "+z"),
        TableColumn("b", 1, "m/s2", 5, "MW", None, "-y"),
        TableColumn("c", 1, "mm/s2", 6, "", -2.0, "+x"),
    )
    write_runs(tmp_path / "r.h5", "1")
    (table,) = read(tmp_path / "r.h5", ("a", "b", "c"))
    assert table.columns == tuple(
        TableColumn(name, unit=unit) for name, unit in zip("abc", DESCRIPTION["unit"], strict=True)
    )
    write_hdf5_table(tmp_path / "r.h5", {}, {"run_1/velocity": SAMPLES})
    (table,) = read(tmp_path / "r.h5")
    assert table.columns == (TableColumn(),) * 3


def test_rows_of_data_sets_at_the_root_are_columns(tmp_path: Path) -> None:
    write_hdf5_table(tmp_path / "r.h5", {}, {"force_N": SAMPLES[:2], "time_s": SAMPLES[2]})
    (table,) = read(tmp_path / "r.h5")
    assert [(column.name, column.row) for column in table.columns] == [("force_N", 1), ("force_N", 2), ("time_s", 1)]
    assert_array_equal(table.values, SAMPLES.T)


def test_data_sets_keep_their_order_and_long_names_are_shortened(tmp_path: Path) -> None:
    write_hdf5_table(tmp_path / "r.h5", {}, {"time_s": SAMPLES[0], "force_N": SAMPLES[1]})
    assert [column.name for column in read(tmp_path / "r.h5")[0].columns] == ["time_s", "force_N"]
    write_hdf5_table(tmp_path / "r.h5", {}, {"x" * 90: np.zeros((2, 2, 2))})
    with pytest.raises(InputError, match=r"data set 'x{80}'"):
        read(tmp_path / "r.h5")


def describe_nothing(file: h5py.File) -> None:
    for key in list(file["channels"]):
        del file["channels"][key]
        file["channels"][key] = np.empty(0)


def replace_run(values: object) -> Callable[[h5py.File], None]:
    def damage(file: h5py.File) -> None:
        del file["run_1/acceleration"]
        if values is not None:
            file["run_1/acceleration"] = values

    return damage


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (describe_nothing, "r.h5', group 'channels': describes no channel"),
        (replace_run(None), "r.h5', run_1: holds no table of samples"),
        (replace_run(SAMPLES[0]), "r.h5', run_1: holds no table of samples"),
        (replace_run(SAMPLES[None]), "r.h5', run_1: holds no table of samples"),
        (replace_run(h5py.Empty("f8")), "r.h5', run_1: holds no table of samples"),
        (replace_run(np.full((3, 20), b"x")), "r.h5', run_1: holds no table of samples"),
        (replace_run(SAMPLES[:2]), "r.h5', run_1: holds 2 channels, but the group 'channels' describes 3"),
    ],
)
def test_damaged_run_is_refused(damage: Callable[[h5py.File], None], message: str, tmp_path: Path) -> None:
    write_runs(tmp_path / "r.h5", "1")
    with h5py.File(tmp_path / "r.h5", "r+") as file:
        damage(file)
    with pytest.raises(InputError, match=message):
        read(tmp_path / "r.h5")


@pytest.mark.parametrize(
    ("datasets", "message"),
    [
        ({}, "r.h5': holds no data set"),
        ({"a": SAMPLES[None]}, r"data set 'a': has the shape \(1, 3, 20\)\."),
        ({"a": 1.5}, r"data set 'a': has the shape \(\)\."),
        (
            {"a": SAMPLES, "b": SAMPLES[0, 1:]},
            r"data set 'b': has the shape \(19,\); the first data set has 20 samples",
        ),
        ({"a": ["text"]}, "data set 'a': holds no table of samples"),
    ],
)
def test_data_sets_at_the_root_have_one_length(datasets: dict[str, object], message: str, tmp_path: Path) -> None:
    with h5py.File(tmp_path / "r.h5", "w") as file:
        for name, values in datasets.items():
            file[name] = values
    with pytest.raises(InputError, match=message):
        read(tmp_path / "r.h5")


def test_file_and_group_may_be_as_large_as_allowed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_hdf5_table(tmp_path / "r.h5", {}, {f"d{k}": SAMPLES[0] for k in range(4)})
    monkeypatch.setattr(hdf5_table, "MOST_ITEMS", 4)
    assert read(tmp_path / "r.h5")[0].values.shape == (20, 4)
    monkeypatch.setattr(hdf5_table, "MOST_ITEMS", 3)
    with pytest.raises(InputError, match="4 data sets"):
        read(tmp_path / "r.h5")
    write_hdf5_table(tmp_path / "r.h5", {}, {"a": SAMPLES, "b": SAMPLES[0]})
    assert read_tables(tmp_path / "r.h5", (), 80)[0].values.size == 80
    with pytest.raises(InputError, match="80 numbers"):
        read_tables(tmp_path / "r.h5", (), 79)


def test_chunk_may_be_as_large_as_the_table(tmp_path: Path) -> None:
    """A chunk is read as a whole; up to 10 000 numbers are allowed for any table."""
    for size, allowed in ((10_000, True), (10_001, False)):
        with h5py.File(tmp_path / "r.h5", "w") as file:
            file.create_dataset("a", (20,), "f8", chunks=(size,), maxshape=(None,))
        if allowed:
            assert read(tmp_path / "r.h5")[0].values.size == 20
        else:
            with pytest.raises(InputError, match=r"has chunks of the shape \(10001,\)"):
                read(tmp_path / "r.h5")

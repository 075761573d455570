"""MATLAB tables: choice of the matrix, of the time and of the rate; compressed data are counted before reading."""

import struct
import zlib
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import scipy.io
from numpy.testing import assert_array_equal

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import MeasuredTable, read_tables

SAMPLES = np.random.default_rng(3).standard_normal((30, 2))


def read(folder: Path, variables: dict[str, Any], names: tuple[str, ...] = (), version: str = "5") -> MeasuredTable:
    """Table of a file with these variables."""
    if version == "5":
        scipy.io.savemat(folder / "r.mat", variables)
    else:
        with h5py.File(folder / "r.mat", "w") as file:
            for name, values in variables.items():
                file[name] = np.atleast_2d(values).T  # MATLAB stores by columns
    (table,) = read_tables(folder / "r.mat", names, 10_000)
    return table


@pytest.mark.parametrize("version", ["5", "7.3"])
@pytest.mark.parametrize("first", ["position", "signals"])
def test_largest_matrix_is_the_table(version: str, first: str, tmp_path: Path) -> None:
    """A smaller matrix before or behind it is no signal; a row of numbers and a scalar are none either."""
    variables = {"position": np.ones((3, 2)), "signals": SAMPLES, "gain": 2.0}
    ordered = {first: variables[first]} | variables
    assert_array_equal(read(tmp_path, ordered, version=version).values, SAMPLES)


@pytest.mark.parametrize("version", ["5", "7.3"])
def test_channels_may_stand_in_rows(version: str, tmp_path: Path) -> None:
    assert_array_equal(read(tmp_path, {"signals": SAMPLES.T}, version=version).values, SAMPLES)
    assert read(tmp_path, {"signals": np.eye(4)}, version=version).values.shape == (4, 4)


@pytest.mark.parametrize("version", ["5", "7.3"])
@pytest.mark.parametrize("rate", ["fs", "Fs", "rate", "sampling_rate_Hz"])
def test_time_and_rate_are_no_channels(version: str, rate: str, tmp_path: Path) -> None:
    time = np.arange(30) / 50
    table = read(tmp_path, {"signals": SAMPLES[:, 0], "t": time, rate: 50.0}, version=version)
    assert table.values.shape == (30, 1)
    assert table.rate == 50.0
    assert table.time is not None
    assert_array_equal(table.time, time)


def test_single_time_is_no_time_column(tmp_path: Path) -> None:
    """A scalar `t`, such as the time of the trigger."""
    assert read(tmp_path, {"signals": SAMPLES, "t": 1.5}).time is None
    table = read(tmp_path, {"signals": SAMPLES[:2], "t": np.array([0.0, 0.1])})
    assert table.time is not None
    assert table.time[1] == 0.1


def test_vectors_of_a_sidecar_stand_in_its_order_or_none_is_taken(tmp_path: Path) -> None:
    variables = {"a": SAMPLES[:, 0], "b": SAMPLES[:, 1:], "c": np.ones(40)}
    table = read(tmp_path, variables, ("b", "a"))
    assert_array_equal(table.values, SAMPLES[:, ::-1])
    assert [column.name for column in table.columns] == ["b", "a"]
    table = read(tmp_path, {"a": SAMPLES[:, 0], "signals": SAMPLES}, ("a", "b"))
    assert_array_equal(table.values, SAMPLES)
    assert [column.name for column in table.columns] == [None, None]


@pytest.mark.parametrize(
    ("variables", "message"),
    [
        ({"note": "text"}, "holds no table of samples; variables besides time and rate: none"),
        ({"b": 1.0, "a": 2.0}, "holds no table of samples; variables besides time and rate: a, b"),
        ({"raw": SAMPLES, "filtered": SAMPLES}, "r.mat', filtered, raw: have the same size"),
    ],
)
def test_file_without_one_table_is_refused(variables: dict[str, Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        read(tmp_path, variables)


def test_other_variables_and_numbers_that_look_like_a_compressed_one_are_no_hindrance(tmp_path: Path) -> None:
    assert_array_equal(read(tmp_path, {"note": "text", "signals": SAMPLES, "flag": np.array([True])}).values, SAMPLES)
    # 15 is the type of a compressed variable; the search for those steps over the others as a whole.
    samples = np.tile(np.array([15, 64], dtype=np.int32), (30, 2))
    assert_array_equal(read(tmp_path, {"signals": samples}).values, samples)


def test_search_for_large_compressed_data_does_not_stop_at_the_limit(tmp_path: Path) -> None:
    """The data are inflated in parts of 2^20 bytes; two of them are the limit for 2^17 numbers, and here are five."""
    largest = 2**17
    scipy.io.savemat(tmp_path / "r.mat", {"signals": SAMPLES, "note": "a" * (5 * 2**20)}, do_compression=True)
    with pytest.raises(InputError, match="more than 131072 numbers"):
        read_tables(tmp_path / "r.mat", (), largest)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize(("excess", "refused"), [(0, False), (1, True)])
def test_compressed_data_may_fill_eight_bytes_per_number_and_a_mebibyte(
    order: str, excess: int, refused: bool, tmp_path: Path
) -> None:
    """Two compressed variables of text hold `8 largest + 2^20` bytes together; scipy reads neither of them."""
    largest, pad = 100, 56  # heads of a variable of text without a name: flags, shape, name, tag of the text
    total = 8 * largest + 2**20 + excess
    elements = b""
    for size in (total // 2, total - total // 2):
        text = size - pad
        head = struct.pack(f"{order}II", 14, size - 8) + struct.pack(f"{order}IIII", 6, 8, 4, 0)
        head += struct.pack(f"{order}IIii", 5, 8, 1, text) + struct.pack(f"{order}II", 1, 0)
        content = zlib.compress(head + struct.pack(f"{order}II", 16, text) + b"a" * text)
        assert len(head) + 8 + text == size
        elements += struct.pack(f"{order}II", 15, len(content)) + content
    version = struct.pack(f"{order}H", 0x100) + (b"IM" if order == "<" else b"MI")
    (tmp_path / "r.mat").write_bytes(b"MATLAB 5.0 MAT-file".ljust(124) + version + elements)
    message = "more than 100 numbers" if refused else "holds no table of samples"
    with pytest.raises(InputError, match=message):
        read_tables(tmp_path / "r.mat", (), largest)

"""Tables of strangers: stated sizes are checked before reading, and all numbers stand in the file itself."""

import logging
import os
import struct
import tracemalloc
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import scipy.io

from pantocheck.conformance.core import hdf5_table
from pantocheck.conformance.core.files import BoundedFile, open_file
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import read_tables

LARGEST = 10_000
MEMORY = 40 * 2**20
"""Memory that a refusal may take [bytes]; every bomb below holds more."""


@pytest.fixture(autouse=True)
def limit_memory() -> Iterator[None]:
    """Fail a test that reads a bomb before it refuses it."""
    logging.disable()  # of nptdms
    tracemalloc.start()
    yield
    logging.disable(logging.NOTSET)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < MEMORY


def soft_link(file: h5py.File, folder: Path) -> None:
    file["force_N"] = h5py.SoftLink("/run_1/acceleration")


def external_link(file: h5py.File, folder: Path) -> None:
    with h5py.File(folder / "other.h5", "w") as other:
        other["force_N"] = np.ones(10)
    file["force_N"] = h5py.ExternalLink(str(folder / "other.h5"), "force_N")


def external_storage(file: h5py.File, folder: Path) -> None:
    os.mkfifo(folder / "pipe")
    file.create_dataset("force_N", (10,), "f8", external=[(str(folder / "pipe"), 0, 80)])


def virtual_dataset(file: h5py.File, folder: Path) -> None:
    layout = h5py.VirtualLayout((10,), "f8")
    layout[:] = h5py.VirtualSource(str(folder / "other.h5"), "force_N", shape=(10,))
    file.create_virtual_dataset("force_N", layout)


@pytest.mark.parametrize("link", [soft_link, external_link, external_storage, virtual_dataset])
@pytest.mark.parametrize("place", ["/", "run_1", "channels"])
def test_hdf5_data_in_another_place_are_refused(
    link: Callable[[h5py.Group, Path], None], place: str, tmp_path: Path
) -> None:
    """The SHA-256 of a table must cover its numbers."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        link(file if place == "/" else file.create_group(place), tmp_path)
    with pytest.raises(InputError, match=r"record 'a\.h5'.*, 'force_N': (is a link to|takes its numbers from) another"):
        read_tables(tmp_path / "a.h5", (), LARGEST)


def test_hdf5_is_read_from_the_file_that_was_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another file takes the name of the checked file before the library reads."""
    path, other = tmp_path / "a.h5", tmp_path / "b.h5"
    for target, value in ((path, 1.0), (other, 2.0)):
        with h5py.File(target, "w") as file:
            file["force_N"] = np.full(10, value)

    @contextmanager
    def open_and_replace(*arguments: Any) -> Iterator[BoundedFile]:
        with open_file(*arguments) as file:
            other.replace(path)
            yield file

    monkeypatch.setattr(hdf5_table, "open_file", open_and_replace)
    (table,) = hdf5_table.read_hdf5_table(path, (), LARGEST)
    assert np.all(table.values == 1.0)


@pytest.mark.parametrize(
    ("file", "name"), [("a.h5", "x"), ("a.h5", "run_1/acceleration"), ("a.h5", "channels/name"), ("a.mat", "x")]
)
def test_hdf5_that_states_terabytes_is_refused(file: str, name: str, tmp_path: Path) -> None:
    path = tmp_path / file
    with h5py.File(path, "w") as writer:
        writer.create_dataset(name, (3, 10**13), "f8", chunks=(3, 1000), compression="gzip")
    assert path.stat().st_size < 10_000
    with pytest.raises(InputError, match="30000000000000 numbers"):
        read_tables(path, (), LARGEST)


def test_numbers_of_all_runs_and_chunks_count(tmp_path: Path) -> None:
    """The library reads a chunk as a whole, even for one number of it."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("x", (10,), "f8", chunks=(10**8,), maxshape=(None,))
    with pytest.raises(InputError, match="has chunks of the shape"):
        read_tables(tmp_path / "a.h5", (), LARGEST)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for run in (1, 2):
            file[f"run_{run}/acceleration"] = np.zeros((3, 2000))
    assert len(read_tables(tmp_path / "a.h5", (), 12_000)) == 2
    with pytest.raises(InputError, match="12000 numbers"):
        read_tables(tmp_path / "a.h5", (), 11_999)


def test_matlab_variable_over_the_limit_is_refused_by_its_stated_shape(tmp_path: Path) -> None:
    scipy.io.savemat(tmp_path / "a.mat", {"x": np.zeros((100, 101))}, do_compression=True)
    with pytest.raises(InputError, match="more than 10000 numbers"):
        read_tables(tmp_path / "a.mat", (), LARGEST)
    assert read_tables(tmp_path / "a.mat", (), 10_100)[0].values.shape == (101, 100)


@pytest.mark.parametrize("order", ["<", ">"])
def test_matlab_bomb_behind_a_small_stated_shape_is_refused(order: str, tmp_path: Path) -> None:
    """A variable of 2 x 2 numbers whose compressed data inflate to 100 MB."""
    header = struct.pack(f"{order}IIII", 6, 8, 6, 0) + struct.pack(f"{order}IIii", 5, 8, 2, 2)
    header += struct.pack(f"{order}HHI", 1, 1, 0) if order == ">" else struct.pack("<HH4s", 1, 1, b"x")
    compressor = zlib.compressobj()
    chunks = [compressor.compress(struct.pack(f"{order}II", 14, 10**8) + header)]
    chunks.append(compressor.compress(struct.pack(f"{order}II", 9, 10**8 - 100)))
    chunks += [compressor.compress(bytes(10**6)) for _ in range(100)]
    element = b"".join([*chunks, compressor.flush()])
    version = struct.pack(f"{order}H", 0x100) + (b"IM" if order == "<" else b"MI")
    start = b"MATLAB 5.0 MAT-file".ljust(124) + version
    (tmp_path / "a.mat").write_bytes(start + struct.pack(f"{order}II", 15, len(element)) + element)
    with pytest.raises(InputError, match="more than 10000 numbers"):
        read_tables(tmp_path / "a.mat", (), LARGEST)


def test_compressed_matlab_variable_is_read_in_parts(tmp_path: Path) -> None:
    """48 MiB of random bytes, which do not become smaller; the first part shows that they are too many."""
    compressor = zlib.compressobj(0)
    with (tmp_path / "a.mat").open("wb") as file:
        file.write(b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x100) + b"IM")
        file.write(struct.pack("<II", 15, 48 * 2**20))
        for _ in range(48):
            file.write(compressor.compress(os.urandom(2**20)))
    with pytest.raises(InputError, match="10000"):
        read_tables(tmp_path / "a.mat", (), LARGEST)


@pytest.mark.filterwarnings("ignore")
def test_damaged_tdms_is_read_or_refused(tmp_path: Path) -> None:
    """Bytes of lengths and counts are set to their largest value, one after the other."""
    nptdms = pytest.importorskip("nptdms", reason="extra tdms")
    path = tmp_path / "a.tdms"
    with nptdms.TdmsWriter(str(path)) as writer:
        writer.write_segment([nptdms.ChannelObject("g", "a", np.arange(77.0), {"wf_increment": 0.01})])
    content = path.read_bytes()
    refused = 0
    for place in range(len(content) - 77 * 8):
        path.write_bytes(content[:place] + b"\x7f" + content[place + 1 :])
        try:
            (table,) = read_tables(path, (), LARGEST)
            assert table.values.size <= LARGEST
        except InputError:
            refused += 1
    assert refused > 50

"""Bounded reading: every reader refuses at once a file that never ends, is no file, or is too large."""

import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.core.files import NO_LINK, file_digest, open_file, read_bytes
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import read_json
from pantocheck.conformance.core.measured_table import TABLE_FORMATS, read_tables
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.documents.document_reading import read_certificate
from pantocheck.conformance.results.identified_modes import read_modes
from pantocheck.conformance.results.results_reading import read_results

Reader = Callable[[Path], object]

READERS: dict[str, Reader] = {
    "plain.toml": lambda path: read_toml(path, "case"),
    "model.toml": lambda path: read_model(path, CaseFile, "case"),
    "results.json": read_results,
    "modes.json": read_modes,
    "any.json": lambda path: read_json(path, "numbers", 10),
    "certificate.pdf": read_certificate,
    "digest": file_digest,
} | {f"table{form.suffixes[0]}": lambda path: read_tables(path, ("a",), 100) for form in TABLE_FORMATS}


@pytest.fixture(autouse=True)
def limit_time() -> Iterator[None]:
    """End a test that waits for a pipe."""
    signal.signal(signal.SIGALRM, lambda *_: pytest.fail("the reader waits"))
    signal.alarm(10)
    yield
    signal.alarm(0)


@pytest.mark.parametrize("name", READERS)
@pytest.mark.parametrize("kind", ["pipe", "device", "folder"])
def test_every_reader_refuses_what_is_no_regular_file(name: str, kind: str, tmp_path: Path) -> None:
    make: dict[str, Reader] = {
        "pipe": os.mkfifo,
        "device": lambda path: path.symlink_to("/dev/zero"),
        "folder": os.mkdir,
    }
    make[kind](tmp_path / name)
    with pytest.raises(InputError, match=r"not a regular file\)?\.\n  (Give|Name) a"):
        READERS[name](tmp_path / name)


@pytest.mark.parametrize("name", READERS)
def test_every_reader_refuses_a_file_over_its_limit(name: str, tmp_path: Path) -> None:
    """A sparse file of 2^40 bytes would exhaust the memory."""
    with (tmp_path / name).open("wb") as file:
        file.truncate(2**40)
    with pytest.raises(InputError, match=r"has 1099511627776 bytes\.\n  At most"):
        READERS[name](tmp_path / name)


def test_growing_file_is_refused_and_a_whole_one_read(tmp_path: Path) -> None:
    """The limit holds while the file is read, not only before."""
    path = tmp_path / "a.csv"
    path.write_bytes(b"1\n" * 10)
    with open_file(path, "record 'a.csv'", 100) as file:
        with path.open("ab") as writer:
            writer.write(b"2\n")
        with pytest.raises(InputError, match=r"record 'a\.csv': grew while it was read"):
            file.read()
    content = os.urandom(2**21 + 7)  # more than two chunks
    (tmp_path / "a").write_bytes(content)
    assert read_bytes(tmp_path / "a", "a", 2**22) == content


def test_link_is_refused_where_no_link_is_allowed(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("a")
    (tmp_path / "b").symlink_to("a")
    assert len(file_digest(tmp_path / "b")) == 64
    with pytest.raises(InputError, match="cannot be read"):
        file_digest(tmp_path / "b", NO_LINK)

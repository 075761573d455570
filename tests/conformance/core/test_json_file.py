"""JSON files: bounded, of one regular file, and refused with the first key at fault."""

import os
from pathlib import Path

import pytest
from pydantic import TypeAdapter

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import read_json, validate_json


def test_content_is_parsed(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text('{"a": [1.5]}')
    assert read_json(tmp_path / "a.json", "numbers", 12) == {"a": [1.5]}


def test_file_over_the_limit_is_refused_before_it_is_read(tmp_path: Path) -> None:
    """A sparse file of 2^40 bytes would exhaust the memory if it were read."""
    with (tmp_path / "a.json").open("wb") as file:
        file.truncate(2**40)
    with pytest.raises(
        InputError, match=r"numbers 'a.json': has 1099511627776 bytes.\n  At most 10 bytes are accepted"
    ):
        read_json(tmp_path / "a.json", "numbers", 10)


def test_pipe_is_refused(tmp_path: Path) -> None:
    """Nobody writes into this pipe: opening it would wait for ever."""
    os.mkfifo(tmp_path / "a.json")
    with pytest.raises(InputError, match="not a regular file"):
        read_json(tmp_path / "a.json", "numbers", 10)


@pytest.mark.parametrize("content", [b"", b"{", b"[" * 100_000, b"\xff\xfe", b"9" * 5000])
def test_damaged_content_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.json").write_bytes(content)
    with pytest.raises(InputError, match=r"numbers 'a\.json': is not valid JSON"):
        read_json(tmp_path / "a.json", "numbers", 200_000)


def test_first_key_at_fault_is_named() -> None:
    model = TypeAdapter(dict[str, list[float]])
    assert validate_json({"a": [1, 2]}, model, "here", "Hint.") == {"a": [1.0, 2.0]}
    with pytest.raises(InputError, match=r"here, key a\[2\]: input should be a valid number.*\n  Hint\."):
        validate_json({"a": [1, "x"]}, model, "here", "Hint.")

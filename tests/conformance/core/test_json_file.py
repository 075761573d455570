"""JSON files: refused with the first key at fault; the bounds are those of every reader (test_bounded_file.py)."""

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import format_json, read_json, validate_json

LEAVES = st.one_of(st.none(), st.booleans(), st.integers(), st.floats(allow_nan=False, allow_infinity=False), st.text())
TREES = st.recursive(
    LEAVES, lambda part: st.lists(part) | st.dictionaries(st.text(), part) | st.lists(st.floats(-9, 9))
)


def test_content_is_parsed_and_its_first_key_at_fault_named(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text('{"a": [1.5]}')
    assert read_json(tmp_path / "a.json", "numbers", 12) == {"a": [1.5]}
    model = TypeAdapter(dict[str, list[float]])
    assert validate_json({"a": [1, 2]}, model, "here", "Hint.") == {"a": [1.0, 2.0]}
    with pytest.raises(InputError, match=r"here, key a\[2\]: input should be a valid number.*\n  Hint\."):
        validate_json({"a": [1, "x"]}, model, "here", "Hint.")


@pytest.mark.parametrize("content", [b"", b"{", b"[" * 100_000, b"\xff\xfe", b"9" * 5000])
def test_damaged_content_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.json").write_bytes(content)
    with pytest.raises(InputError, match=r"numbers 'a\.json': is not valid JSON"):
        read_json(tmp_path / "a.json", "numbers", 200_000)


@given(TREES, st.booleans())
def test_text_is_that_of_the_standard_library(tree: object, ascii_only: bool) -> None:
    assert format_json(tree, ascii_only) == json.dumps(tree, indent=1, ensure_ascii=ascii_only)


@pytest.mark.parametrize("tree", [[1.0, float("nan")], {"a": float("inf")}])
def test_number_that_is_not_finite_is_refused(tree: object) -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        format_json(tree)

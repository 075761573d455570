"""Lines of tables and keys in TOML files."""

import tomllib

import pytest

from pantocheck.conformance.core.toml_file import find_key_line, list_table_lines

TEXT = '''# baseline = "comment"
note = """
[[limit]]
baseline = 1
"""
other = \'\'\'
[[limit]]\'\'\'
single = "a # \\" [[limit]]"  # [[limit]]
baseline = "x"

[[limit]]  # first
quantity = "a"

  [[ limit ]]
baseline = "inside a table"
[[limits]]
'''


def test_headers_and_keys_inside_texts_and_comments_are_not_found() -> None:
    assert len(tomllib.loads(TEXT)["limit"]) == 2
    assert list_table_lines(TEXT, "limit") == (11, 14)
    assert find_key_line(TEXT, "baseline") == 9
    assert find_key_line(TEXT, "quantity") is None  # a key of a table


@pytest.mark.parametrize(
    "text", ['"' * 200_001, "'" * 200_000, '"\\' * 100_000, "#" * 200_000, '"""' + '\\"' * 100_000]
)
def test_damaged_texts_take_linear_time(text: str) -> None:
    assert list_table_lines(f"{text}\n[[limit]]\n", "limit") in ((), (2,))

"""Extreme lines are valid, or refused with the keys that are wrong."""

import copy
import tempfile
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import hypothesis.strategies as st
from hypothesis import given, settings

from helpers.toml_edit import write_toml
from pantocheck.conformance.app.commands.new_command import read_template
from pantocheck.conformance.app.file_check import check_input_file
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.key_paths import follow_path, join_path

EXTREMES = (0, -1, 1e-300, 1e-3, 0.3, 10, 60, 119.99, 1e3, 2e5, 1e10, 1e300, True, "text", [1.0], {})
"""Values at and beyond the bounds of the keys, and of other types."""


def list_numbers(tree: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Paths of all numbers of a tree."""
    for key, value in tree.items() if isinstance(tree, dict) else enumerate(tree):
        if isinstance(value, dict | list):
            yield from list_numbers(value, (*path, key))
        elif isinstance(value, int | float):
            yield (*path, key)


TEMPLATE = tomllib.loads(read_template("line"))


@settings(max_examples=30)
@given(st.dictionaries(st.sampled_from(list(list_numbers(TEMPLATE))), st.sampled_from(EXTREMES), max_size=5))
def test_extreme_line_is_valid_or_refused_with_its_keys(changes: dict[tuple[str | int, ...], object]) -> None:
    """No combination ends with another exception; every value of another type is among the reasons."""
    tree = copy.deepcopy(TEMPLATE)
    for path, value in changes.items():
        table, part, _ = follow_path(tree, path, "")
        table[part] = value
    with tempfile.TemporaryDirectory() as folder:
        file = write_toml(Path(folder) / "line.toml", tree)
        try:
            check_input_file(file)
            refused = set()
        except InputError as error:
            refused = {problem.where.rpartition(", key ")[2] for problem in error.problems}
    wrong = {join_path(path) for path, value in changes.items() if isinstance(value, str | list | dict)}
    assert {key for key in wrong if key not in refused and not any(part.startswith(key) for part in refused)} == set()

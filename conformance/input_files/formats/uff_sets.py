"""Writing of the data sets of a universal file."""

import warnings
from pathlib import Path
from typing import Any

import pyuff

from pantocheck.conformance.input_files.atomic_writing import produce_atomically

LINE_LENGTH = 80
"""Characters of an identification line."""


def write_data_sets(path: Path, data_sets: list[dict[str, Any]]) -> None:
    """Write data sets as pyuff prepares them.

    Raises:
        InputError: The file cannot be written.
    """

    def produce(temporary: Path) -> None:
        # pyuff's mode 'overwrite' damages binary files; adding to a new file does not.
        temporary.unlink()
        with warnings.catch_warnings():
            # pyuff leaves its files to the garbage collector, which closes them when it returns.
            warnings.simplefilter("ignore", ResourceWarning)
            pyuff.UFF(str(temporary)).write_sets(data_sets, mode="add")

    produce_atomically(path, produce)


def encode_identification_line(text: str) -> str:
    """Identification line: ASCII characters, at most `LINE_LENGTH`, never empty."""
    return text.encode("ascii", "replace").decode("ascii")[:LINE_LENGTH].strip() or "NONE"

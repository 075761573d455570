"""CSV tables: numbers below one head line, with decimal points (`1.5,2`) or decimal commas (`1,5;2`)."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from itertools import chain, islice
from pathlib import Path
from typing import TextIO

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.bounded_file import MAX_FILE_BYTES, convert_read_errors, open_file
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import MeasuredTable, TableColumn

LONGEST_ROW = 1_000_000  # longest line of a table [characters]

Lines = Iterator[tuple[int, str]]
"""Numbered lines of a file, from 1."""


def read_csv_table(path: Path, names: tuple[str, ...], largest: int) -> list[MeasuredTable]:
    """Read the run of a CSV file; arguments and errors as in `table_formats.Reader`.

    Blank lines, and lines before the head line that begin with `#`, are skipped.
    """
    del names  # a CSV file is read the same way with and without a sidecar
    where = f"record '{path.name}'"
    with _open_text(path, where) as file, warnings.catch_warnings():
        start = list(islice(_numbered(file, where), 3))
        if not start:
            raise InputError(where, "holds no line of data", "Export the record again.")
        dialect = _find_dialect([line for _, line in start])
        delimiter, decimal = dialect
        head = [cell.strip().strip('"') for cell in start[0][1].split(delimiter)]
        named = not all(_is_number(cell, decimal) for cell in head)
        body = (line.replace(decimal, ".") for _, line in chain(start[named:], _numbered(file, where)))
        warnings.simplefilter("ignore", UserWarning)  # numpy's warning of a table without rows
        try:
            values = np.loadtxt(body, delimiter=delimiter, ndmin=2, comments=None, max_rows=largest // len(head) + 1)
        except (InputError, UnicodeDecodeError):
            raise
        except ValueError:
            raise _find_fault(path, where, dialect, named) from None
    if values.size > largest:
        raise InputError(where, f"holds more than {largest} numbers", "Shorten the record, or leave channels out.")
    if values.size == 0:
        raise InputError(where, "holds a head line but no samples", "Export the record again.")
    if values.shape[1] != len(head):
        raise _find_fault(path, where, dialect, named)
    return [MeasuredTable(path.name, values, tuple(TableColumn(name if named else None) for name in head))]


def write_csv_table(path: Path, names: list[str], values: RealArray, digits: int) -> None:
    """Write a CSV table (decimal point, commas).

    Parameters
    ----------
    path : Path
        The file.
    names : list of str
        Names of the columns.
    values : (n, c) ndarray
        Samples.
    digits : int
        Significant digits.
    """
    head = ",".join(names)
    np.savetxt(path, values, f"%.{digits}g", ",", header=head, comments="", encoding="utf-8")


@contextmanager
def _open_text(path: Path, where: str) -> Iterator[TextIO]:
    with convert_read_errors(path, where), open_file(path, where, MAX_FILE_BYTES) as file:
        yield TextIOWrapper(file, encoding="utf-8-sig")


def _numbered(file: TextIO, where: str) -> Lines:
    """Lines of the table: those after the first comments that are not blank."""
    comments = True
    for number, line in enumerate(iter(lambda: file.readline(LONGEST_ROW), ""), 1):
        if len(line) == LONGEST_ROW:
            raise InputError(f"{where}, line {number}", "is too long", f"A line has at most {LONGEST_ROW} characters.")
        comments = comments and line.lstrip().startswith("#")
        if line.strip() and not comments:
            yield number, line


def _find_dialect(lines: list[str]) -> tuple[str, str]:
    """Delimiter and decimal mark of the first lines; beside a semicolon or a tab, a comma marks decimals."""
    for delimiter in (";", "\t"):
        if all(delimiter in line for line in lines):
            return delimiter, ","
    return ",", "."


def _is_number(cell: str, decimal: str) -> bool:
    try:
        float(cell.replace(decimal, "."))
    except ValueError:
        return False
    return True


def _find_fault(path: Path, where: str, dialect: tuple[str, str], named: bool) -> InputError:
    """First line of a damaged table whose width or numbers are wrong."""
    with _open_text(path, where) as file:
        lines = list(_numbered(file, where))
    delimiter, decimal = dialect
    width = lines[0][1].count(delimiter) + 1
    for number, line in lines[named:]:
        cells = [cell.strip() for cell in line.split(delimiter)]
        if len(cells) < width:
            return InputError(
                f"{where}, line {number}",
                f"has {len(cells)} of {width} values",
                "Complete or remove this line; the export may have stopped within it.",
            )
        if len(cells) > width:
            return InputError(
                f"{where}, line {number}",
                f"has {len(cells)} values, expected {width}",
                "Name every column in the head line; if columns are separated by commas, write decimals with points.",
            )
        for column, cell in enumerate(cells, 1):
            if not _is_number(cell, decimal):
                return InputError(
                    f"{where}, line {number}, column {column}",
                    f"{cell[:40]!r} is not a number",
                    "Write 1.5 with commas between columns, or 1,5 with semicolons; nan marks a missing value.",
                )
    return InputError(where, "is not a table of numbers", "Export the record again.")

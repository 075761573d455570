"""CSV tables: columns of numbers below their names, with any separator, decimal mark, head lines and encoding."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from io import StringIO, TextIOWrapper
from itertools import chain
from pathlib import Path
from typing import TextIO

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.files import MAX_FILE_BYTES, convert_read_errors, open_file, write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import ChannelNames, MeasuredTable, TableColumn
from pantocheck.conformance.core.text_reading import (
    NumberedLine,
    TextLayout,
    find_text_layout,
    is_number,
    is_thousands,
    number_error,
    split_cells,
    thousands_error,
)
from pantocheck.conformance.core.text_settings import DecimalSign, TextSettings, find_encoding

LONGEST_ROW = 1_000_000  # longest line of a table [characters]

LAYOUT_LINES = 1000
"""Number of lines from which the layout is found."""

LAYOUT_CHARACTERS = 1_000_000
"""Number of characters from which the layout is found."""

FOUND = TextSettings()
"""Settings of a table whose layout is found."""

Lines = Iterator[NumberedLine]
"""Numbered lines of a file, from 1."""


def read_csv_table(
    path: Path, names: ChannelNames, largest: int, settings: TextSettings = FOUND
) -> list[MeasuredTable]:
    """Read the run of a CSV file; arguments and errors as in `measured_table.Reader`.

    Columns of text become columns of missing values. Blank lines are skipped, and an empty cell is a missing value.

    Args:
        path: The file.
        names: Names of the channels in its sidecar; a text table is read the same way with and without them.
        largest: Largest accepted number of values.
        settings: Stated keys of the layout.

    Returns:
        The only run.

    Raises:
        InputError: The file is damaged or too large, or several layouts are valid.
    """
    del names
    where = f"record '{path.name}'"
    with open_text_table(path, where, settings) as (layout, lines), warnings.catch_warnings():
        numbers = sorted(set(range(layout.width)) - layout.texts)
        warnings.simplefilter("ignore", UserWarning)  # numpy's warning of a table without rows
        try:
            values = np.loadtxt(
                _convert_lines(lines, layout, where),
                delimiter="\t",
                usecols=numbers if layout.texts else None,
                ndmin=2,
                comments=None,
                max_rows=largest // layout.width + 1,
            )
        except (InputError, UnicodeError):
            raise
        except ValueError:
            raise _find_fault(path, where, settings) from None
    if values.shape[0] * layout.width > largest:
        raise InputError(where, f"holds more than {largest} numbers", "Shorten the record, or leave channels out.")
    if layout.texts:
        known, values = values, np.full((values.shape[0], layout.width), np.nan)
        values[:, numbers] = known
    elif values.shape[1] != layout.width:
        raise _find_fault(path, where, settings)
    return [MeasuredTable(path.name, values, _list_columns(layout))]


@contextmanager
def open_text_table(path: Path, where: str, settings: TextSettings) -> Iterator[tuple[TextLayout, Lines]]:
    """Open a text table and find its layout.

    Args:
        path: The file.
        where: Name of the file in messages.
        settings: Stated keys of the layout.

    Yields:
        Layout, and the numbered lines of numbers that are not blank.

    Raises:
        InputError: The file cannot be read, is not text, or several layouts are valid.
    """
    with open_text(path, where, settings) as file:
        lines = _number_lines(file, where)
        start: list[NumberedLine] = []
        size = 0
        while len(start) < LAYOUT_LINES and size < LAYOUT_CHARACTERS and (line := next(lines, None)) is not None:
            start.append(line)
            size += len(line[1])
        if all(text.lstrip().startswith("#") for _, text in start):
            raise InputError(where, "holds no line of data", "Export the record again.")
        layout = find_text_layout(start, where, settings)
        yield layout, (line for line in chain(start, lines) if line[0] >= layout.first)


@contextmanager
def open_text(path: Path, where: str, settings: TextSettings) -> Iterator[TextIOWrapper]:
    """Open a text file in its encoding; arguments and errors as in `open_text_table`."""
    with convert_read_errors(path, where), open_file(path, where, MAX_FILE_BYTES) as file:
        encoding = find_encoding(file, where) if settings.encoding is None else settings.encoding
        try:
            yield TextIOWrapper(file, encoding=encoding)
        except UnicodeError as error:
            raise InputError(
                where,
                f"is not text in the encoding {encoding} ({error})",
                "Correct encoding in [table] of the sidecar.",
            ) from None


def write_csv_table(path: Path, names: list[str], values: RealArray, digits: int) -> None:
    """Write a CSV table (decimal point, commas), in a new folder if needed.

    Args:
        path: The file.
        names: Names of the columns.
        values: Samples, (n, c).
        digits: Significant digits.
    """
    head = ",".join(names)
    text = StringIO()
    np.savetxt(text, values, f"%.{digits}g", ",", header=head, comments="")
    write_atomically(path, text.getvalue().encode())


def _list_columns(layout: TextLayout) -> tuple[TableColumn, ...]:
    """Columns with the names and units of the head lines."""
    names = layout.names or (None,) * layout.width
    units = layout.units or ("",) * layout.width
    return tuple(TableColumn(name, unit=unit.strip("[]()") or None) for name, unit in zip(names, units, strict=True))


def _number_lines(file: TextIO, where: str) -> Lines:
    """Lines of a file that are not blank."""
    for number, line in enumerate(iter(lambda: file.readline(LONGEST_ROW), ""), 1):
        if len(line) == LONGEST_ROW:
            raise InputError(f"{where}, line {number}", "is too long", f"A line has at most {LONGEST_ROW} characters.")
        if line.strip():
            yield number, line


def _convert_lines(lines: Lines, layout: TextLayout, where: str) -> Iterator[str]:
    """Lines with decimal points and tabs between columns; a second decimal mark makes a number unreadable."""
    decimal = layout.decimal
    marks = "," if layout.separator != "," else ""
    for number, text in lines:
        if decimal is None and marks and ("," in text or "." in text):
            decimal = _find_mark(text, layout, where)
        line = text.rstrip("\r\n")
        if '"' in line or layout.texts:
            cells = split_cells(line, layout.separator)
            if len(cells) != layout.width:
                raise _width_error(f"{where}, line {number}", len(cells), layout.width)
            line = layout.separator.join(cells)
        if decimal == ",":
            line = line.translate(_COMMA_TO_POINT)
        if layout.separator == " ":
            yield "\t".join(split_cells(line, " "))
        else:
            yield _fill_empty(line, layout.separator)


_COMMA_TO_POINT = str.maketrans({",": ".", ".": "?"})


def _find_mark(text: str, layout: TextLayout, where: str) -> DecimalSign | None:
    """Decimal mark of the first line whose numbers have one; None if only its texts have marks."""
    cells = [cell for c, cell in enumerate(split_cells(text, layout.separator)) if c not in layout.texts]
    marked = [cell for cell in cells if "," in cell or "." in cell]
    if not marked:
        return None
    if all(is_thousands(cell) for cell in marked):
        raise thousands_error(where, marked[0])
    return "," if "," in marked[0] else "."


def _fill_empty(line: str, separator: str) -> str:
    """Line with tabs between columns and `nan` in empty cells."""
    if not line.startswith(separator) and not line.endswith(separator) and 2 * separator not in line:
        return line.replace(separator, "\t")
    return "\t".join(cell if cell.strip() else "nan" for cell in line.split(separator))


def _width_error(place: str, found: int, width: int) -> InputError:
    if found < width:
        hint = "Complete or remove this line; the export may have stopped within it."
        return InputError(place, f"has {found} of {width} values", hint)
    hint = "Name every column in the head line; if columns are separated by commas, write decimals with points."
    return InputError(place, f"has {found} values, expected {width}", hint)


def _find_fault(path: Path, where: str, settings: TextSettings) -> InputError:
    """First line of a damaged table whose width or numbers are wrong."""
    with open_text_table(path, where, settings) as (layout, lines):
        for number, text in lines:
            place, cells = f"{where}, line {number}", split_cells(text, layout.separator)
            if len(cells) != layout.width:
                return _width_error(place, len(cells), layout.width)
            for column, cell in enumerate(cells):
                if column not in layout.texts and cell and not is_number(cell, layout.decimal):
                    return number_error(place, column, cell)
    return InputError(where, "is not a table of numbers", "Export the record again.")

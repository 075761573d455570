"""Tables of text cells: sheets of workbooks, and CSV with commas, semicolons or tabs, as spreadsheets export it."""

import csv
import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import dropwhile, islice
from pathlib import Path

from pantocheck.conformance.core.files import read_bytes
from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.text_settings import find_encoding
from pantocheck.conformance.core.workbook_reading import EMPTY, WORKBOOK_SUFFIXES, SheetRow, read_sheet

MAX_SPREADSHEET_BYTES = 10_000_000
"""Largest table that is read [bytes]: a line of 1000 spans with 30 droppers each takes 2 MB."""

MOST_ROWS = 100_000
"""Largest number of rows: 1000 spans with 100 droppers each."""

DELIMITERS = (";", "\t", ",")
"""Separators of columns; a head line with a semicolon or a tab is not separated by commas."""


@dataclass(frozen=True)
class SpreadsheetRow:
    """Row of a table."""

    number: int
    """Number of its line in the file, from 1."""
    cells: tuple[str, ...]
    """Texts of its cells, without spaces around them."""
    numbers: frozenset[int] = frozenset()
    """Columns, from 0, whose cells a workbook stores as numbers: their decimal mark is certain."""


@dataclass(frozen=True)
class Spreadsheet:
    """Table of text cells below one head line."""

    where: str
    """Name of the file in messages."""
    delimiter: str
    """Separator of its columns; empty for a sheet of a workbook."""
    head: SpreadsheetRow
    """Names of the columns."""
    rows: tuple[SpreadsheetRow, ...]
    """Rows below the head line; empty rows are left out."""

    def locate(self, row: SpreadsheetRow, column: int) -> str:
        """Place of a cell in messages; columns count from 0."""
        return f"{self.where}, row {row.number}, column {self.head.cells[column][:80]!r}"


def read_spreadsheet(path: Path, sheet: str | None = None) -> Spreadsheet:
    """Read a table of text cells, or a sheet of a workbook.

    The encoding of a text is UTF-8 or UTF-16 with a byte order mark, or else UTF-8 or Windows-1252. Rows before the
    head line that begin with `#` or `sep=` are skipped.

    Args:
        path: The file.
        sheet: Name of the sheet in a workbook with several sheets.

    Raises:
        InputError: The file cannot be read, is not a text, has no row or too many, or has rows of another width than
            its head line; a cell of a sheet has no certain content.
    """
    where = f"table '{path.name}'"
    if path.suffix.lower() in WORKBOOK_SUFFIXES:
        found = read_sheet(path, where, sheet)
        table = list_table_rows(found.rows, found.where)
        if faults := list(list_faults(table, found.where)):
            raise join_errors(faults)
        return _build_spreadsheet(found.where, "", [_convert_row(row) for row in table])
    content = read_bytes(path, where, MAX_SPREADSHEET_BYTES)
    text = content.decode(find_encoding(io.BytesIO(content), where))
    lines = text.splitlines()
    start = next((i for i, line in enumerate(lines) if line.strip() and not _is_preface(line)), len(lines))
    if start == len(lines):
        raise InputError(where, "is empty", "Write the names of the columns in the first row.")
    delimiter = next((mark for mark in DELIMITERS if mark in lines[start]), ",")
    reader = csv.reader(io.StringIO("\n".join(lines[start:])), delimiter=delimiter, strict=True)
    try:
        rows = [
            SpreadsheetRow(start + reader.line_num, tuple(cell.strip() for cell in cells))
            for cells in islice(reader, MOST_ROWS + 2)
        ]
    except csv.Error as error:
        raise InputError(f"{where}, row {start + reader.line_num}", str(error), "Export the table again.") from None
    if len(rows) > MOST_ROWS + 1:
        raise InputError(where, f"has more than {MOST_ROWS} rows", "Export one line only, without empty rows.")
    return _build_spreadsheet(where, delimiter, [row for row in rows if any(row.cells)])


def list_table_rows(rows: Sequence[SheetRow], where: str) -> list[SheetRow]:
    """Head line and rows of a sheet, without the columns that are empty in all of them.

    Args:
        rows: Filled rows of the sheet.
        where: Name of the sheet in messages.

    Raises:
        InputError: There is no row.
    """
    table = list(dropwhile(lambda row: _is_preface(row.cells[0].text), rows))
    if not table:
        raise InputError(where, "is empty", "Write the names of the columns in the first row.")
    used = sorted({column for row in table for column, cell in enumerate(row.cells) if cell != EMPTY})
    return [SheetRow(row.number, tuple(row.cells[c] if c < len(row.cells) else EMPTY for c in used)) for row in table]


def list_faults(table: Sequence[SheetRow], where: str) -> Iterator[InputError]:
    """Errors of the cells without a certain content; the first row of the table is its head line."""
    for row in table:
        for name, cell in zip(table[0].cells, row.cells, strict=True):
            if cell.fault is not None:
                place = f"{where}, row {row.number}, column {name.text[:80]!r}"
                yield InputError(place, f"the cell {cell.fault.found}", cell.fault.hint)


def _convert_row(row: SheetRow) -> SpreadsheetRow:
    numbers = frozenset(c for c, cell in enumerate(row.cells) if cell.is_number)
    return SpreadsheetRow(row.number, tuple(cell.text for cell in row.cells), numbers)


def _build_spreadsheet(where: str, delimiter: str, filled: list[SpreadsheetRow]) -> Spreadsheet:
    head, body = filled[:1], filled[1:]
    if not body:
        raise InputError(where, "has a head line but no rows", "Export the table again.")
    if len(body) > MOST_ROWS:
        raise InputError(where, f"has more than {MOST_ROWS} rows", "Export one line only, without empty rows.")
    _check_widths(where, head[0], body)
    return Spreadsheet(where, delimiter, head[0], tuple(body))


def _is_preface(line: str) -> bool:
    return line.lstrip().startswith(("#", "sep="))


def _check_widths(where: str, head: SpreadsheetRow, body: list[SpreadsheetRow]) -> None:
    width = len(head.cells)
    errors = [
        InputError(
            f"{where}, row {row.number}",
            f"has {len(row.cells)} cells, expected {width}",
            "If columns are separated by commas, write decimals with points.",
        )
        for row in body
        if len(row.cells) != width
    ]
    if errors:
        raise join_errors(errors)

"""Sheets of workbooks: cells of an XLSX or ODS file as numbers and texts; XLSX needs the extra `sheets`.

Cells whose content is not certain (dates, errors, formulas without a result) have a fault, and are never empty.
"""

import io
import re
import warnings
import zipfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from datetime import date, time, timedelta
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

from pantocheck.conformance.core.extras import refuse_missing_package
from pantocheck.conformance.core.files import read_bytes
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import convert_damage_errors

WORKBOOK_SUFFIXES = (".xlsx", ".ods")

MAX_WORKBOOK_BYTES = 10_000_000
"""Largest workbook that is read [bytes]."""

MAX_UNPACKED_BYTES = 60_000_000
"""Largest size of all its parts without compression [bytes]: 300,000 numbers take 15 MB."""

_MOST_PARTS = 2000
"""Largest number of its parts."""

_MOST_ROWS_OF_SHEET = 1_048_576
"""Rows of a sheet of the spreadsheet programs."""

_MOST_CELLS = 2_000_000
"""Largest number of cells up to the last one of each row, empty ones included."""

_DAMAGED = (zipfile.BadZipFile, SyntaxError)
"""Exceptions of the libraries for damaged archives and XML texts."""


class Fault(NamedTuple):
    """Reason why a cell has no certain content."""

    found: str
    """Predicate of the cell."""
    hint: str = "Format the cell as a number, and write the value again."


_DATE = Fault("is a date")
_FORMULA = Fault("is a formula without a stored result", "Open the file in a spreadsheet program, and save it.")
_MERGED = Fault("is merged with others", "Separate the cells, and write the value into each.")


class SheetCell(NamedTuple):
    """Cell of a sheet; an empty one has an empty text."""

    text: str = ""
    """Text without spaces around it; of a number, its shortest decimal form with all digits."""
    is_number: bool = False
    """Whether the file stores a number, so that its decimal mark is certain."""
    fault: Fault | None = None


EMPTY = SheetCell()


class SheetRow(NamedTuple):
    """Row of a sheet with at least one cell that is not empty."""

    number: int
    """Number in the sheet, from 1."""
    cells: tuple[SheetCell, ...]


@dataclass(frozen=True)
class Sheet:
    """Filled rows of a sheet."""

    where: str
    """File and sheet in messages."""
    rows: tuple[SheetRow, ...]


def list_sheet_names(path: Path, where: str) -> list[str]:
    """Names of the sheets of a workbook; errors as in `read_sheet`."""
    return [name for name, _ in _open_workbook(path, where)]


def read_sheet(path: Path, where: str, name: str | None = None) -> Sheet:
    """Read a sheet of a workbook.

    Macros, links and images are not read. Hidden rows are rows like the others.

    Args:
        path: XLSX or ODS file.
        where: Name of the file in messages.
        name: Name of the sheet, in any case, if there are several; None: there must be one.

    Raises:
        InputError: The file is missing, damaged or too large, has a document type definition, or has several sheets and
            none of this name.
        MissingPackage: The extra `sheets` is not installed, and the file needs it.
    """
    filled = [(title, read) for title, read in _open_workbook(path, where)]
    wanted = [item for item in filled if name is not None and item[0].strip().lower() == name]
    if len(filled) > 1 and not wanted:
        names = ", ".join(repr(title[:40]) for title, _ in filled[:10])
        hint = "Keep one sheet only." if name is None else f"Name the sheet {name!r}, or keep one sheet only."
        raise InputError(where, f"has several sheets ({names})", hint)
    (title, read), *_ = wanted or filled
    place = f"{where}, sheet '{title[:80]}'"
    with convert_damage_errors(place, "a workbook", *_DAMAGED):
        return Sheet(place, tuple(row for row in read(place) if any(cell != EMPTY for cell in row.cells)))


SheetReader = Callable[[str], Iterator[SheetRow]]
"""Reader of the rows of a sheet; its argument is the place of the sheet in messages."""


def _open_workbook(path: Path, where: str) -> list[tuple[str, SheetReader]]:
    """Names and readers of the sheets, in the order of the workbook."""
    content = read_bytes(path, where, MAX_WORKBOOK_BYTES)
    with convert_damage_errors(where, "a workbook", *_DAMAGED):
        archive = zipfile.ZipFile(io.BytesIO(content))
        _check_parts(archive, where)
        if path.suffix.lower() == ".ods":
            found = _open_ods(archive)
        else:
            with refuse_missing_package(where):
                found = _open_xlsx(archive, content)
        if not found:
            raise ValueError("no sheet")
        return found


def _check_parts(archive: zipfile.ZipFile, where: str) -> None:
    """Refuse an archive whose parts are too large, encrypted, or have a document type definition.

    `zipfile` unpacks at most the size that the directory states, so that the sum of these sizes is a bound.
    """
    parts = archive.infolist()
    size = sum(part.file_size for part in parts)
    if size > MAX_UNPACKED_BYTES or len(parts) > _MOST_PARTS:
        found = f"has {len(parts)} parts of {size} bytes together without compression"
        raise InputError(where, found, f"At most {_MOST_PARTS} parts and {MAX_UNPACKED_BYTES} bytes are read.")
    for part in parts:
        if part.flag_bits & 1:
            raise InputError(where, "is encrypted", "Save it without a password.")
        if part.filename.lower().endswith((".xml", ".rels")):
            text = archive.read(part)
            if b"\0" in text or b"<!DOCTYPE" in text or b"<!ENTITY" in text:
                found = f"part '{part.filename[:80]}' has a document type definition, or is not UTF-8"
                raise InputError(where, found, "Save the table with a spreadsheet program.")


def _convert_number(value: float) -> SheetCell:
    whole = float(value).is_integer() and abs(value) < 1e15
    return SheetCell(str(int(value)) if whole else repr(float(value)), is_number=True)


def _convert_text(text: str) -> SheetCell:
    return SheetCell(text.strip())


# XLSX
def _open_xlsx(archive: zipfile.ZipFile, content: bytes) -> list[tuple[str, SheetReader]]:
    book = _load_xlsx(content, data_only=False)

    def bind(index: int) -> SheetReader:
        return lambda where: _read_xlsx(archive, content, book.worksheets[index], index, where)

    return [(sheet.title, bind(index)) for index, sheet in enumerate(book.worksheets)]


def _load_xlsx(content: bytes, data_only: bool) -> Any:
    from openpyxl import load_workbook

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # parts of the file that are not read
        return load_workbook(io.BytesIO(content), read_only=True, data_only=data_only, keep_links=False)


def _read_xlsx(archive: zipfile.ZipFile, content: bytes, sheet: Any, index: int, where: str) -> Iterator[SheetRow]:
    merged = _find_merged(archive.read(sheet._worksheet_path))
    cells = 0
    results: Iterator[Any] | None = None
    for number, row in _iterate_xlsx(sheet):
        cells += len(row)
        if cells > _MOST_CELLS or number > _MOST_ROWS_OF_SHEET:
            raise InputError(where, f"has more than {_MOST_CELLS} cells", "Delete the empty rows and columns.")
        if results is None and any(cell.data_type == "f" for cell in row):
            values = _load_xlsx(content, data_only=True).worksheets[index]
            results = islice(_iterate_xlsx(values), number - 1, None)
        cached = row if results is None else next(results)[1]
        found = [_convert_xlsx(cell, result) for cell, result in zip(row, cached, strict=True)]
        yield SheetRow(number, _mark_merged(found, merged.pop(number, set())))
    for number in sorted(merged):  # behind the last row with a content
        yield SheetRow(number, _mark_merged([], merged[number]))


def _mark_merged(cells: list[SheetCell], columns: set[int]) -> tuple[SheetCell, ...]:
    """Cells of a row with the fault of those in merged ranges."""
    cells += [EMPTY] * (max(columns, default=0) - len(cells))
    for column in columns:
        cells[column - 1] = SheetCell(fault=_MERGED)
    return tuple(cells)


def _iterate_xlsx(sheet: Any) -> Iterator[tuple[int, Any]]:
    sheet.reset_dimensions()  # the size that the file states may be wrong
    return enumerate(sheet.iter_rows(), 1)


def _convert_xlsx(cell: Any, result: Any) -> SheetCell:
    """Content of a cell; `result` is the same cell with the stored result of its formula."""
    value = result.value
    match value:
        case None:
            return SheetCell(fault=_FORMULA) if cell.data_type == "f" else EMPTY
        case _ if result.data_type == "e":
            return SheetCell(fault=Fault(f"is the error {str(value)[:20]}", "Correct the formula."))
        case bool():
            return SheetCell(fault=Fault("is a truth value"))
        case int() | float():
            if "%" in str(result.number_format):
                return SheetCell(fault=Fault("is a percentage"))
            return _convert_number(value)
        case date() | time() | timedelta():
            return SheetCell(fault=_DATE)
        case _:
            return _convert_text(str(value))


_RANGE = re.compile(rb"<(?:\w+:)?mergeCell\s[^>]*?ref=[\"']([A-Z]{1,3})(\d{1,7}):([A-Z]{1,3})(\d{1,7})[\"']")


def _find_merged(text: bytes) -> dict[int, set[int]]:
    """Columns of the cells of merged ranges by their row, without the first cell, which holds the content."""
    found, cells = dict[int, set[int]](), 0
    for left, top, right, bottom in _RANGE.findall(text):
        rows, columns = range(int(top), int(bottom) + 1), range(_column_number(left), _column_number(right) + 1)
        cells += len(rows) * len(columns)
        if cells > _MOST_CELLS:
            raise ValueError("too many merged cells")
        for row in rows:
            if covered := set(columns if row > rows[0] else columns[1:]):
                found.setdefault(row, set()).update(covered)
    return found


def _column_number(letters: bytes) -> int:
    number = 0
    for letter in letters:
        number = 26 * number + letter - 64
    return number


# ODS
_OFFICE = "{urn:oasis:names:tc:opendocument:xmlns:office:1.0}"
_TABLE = "{urn:oasis:names:tc:opendocument:xmlns:table:1.0}"
_TEXT = "{urn:oasis:names:tc:opendocument:xmlns:text:1.0}"
_ERROR = "{urn:org:documentfoundation:names:experimental:calc:xmlns:calcext:1.0}value-type"


def _open_ods(archive: zipfile.ZipFile) -> list[tuple[str, SheetReader]]:
    tree = ElementTree.fromstring(archive.read("content.xml"))

    def bind(table: ElementTree.Element) -> SheetReader:
        return lambda where: _read_ods(table, where)

    tables = tree.iterfind(f"{_OFFICE}body/{_OFFICE}spreadsheet/{_TABLE}table")
    return [(table.get(f"{_TABLE}name", ""), bind(table)) for table in tables]


def _read_ods(table: ElementTree.Element, where: str) -> Iterator[SheetRow]:
    number, cells = 1, 0
    for row in table.iter(f"{_TABLE}table-row"):
        repeated = int(row.get(f"{_TABLE}number-rows-repeated", "1"))
        content = tuple(_list_ods_cells(row))
        if content:
            cells += len(content) * repeated
            if cells > _MOST_CELLS or number + repeated > _MOST_ROWS_OF_SHEET:
                raise InputError(where, f"has more than {_MOST_CELLS} cells", "Delete the empty rows and columns.")
            yield from (SheetRow(number + i, content) for i in range(repeated))
        number += repeated


def _list_ods_cells(row: ElementTree.Element) -> Iterable[SheetCell]:
    """Cells of a row up to the last one with a content."""
    cells: list[SheetCell] = []
    empty = 0
    for element in row:
        if element.tag not in (f"{_TABLE}table-cell", f"{_TABLE}covered-table-cell"):
            continue
        repeated = int(element.get(f"{_TABLE}number-columns-repeated", "1"))
        cell = _convert_ods(element)
        if cell == EMPTY:
            empty += repeated
        elif len(cells) + empty + repeated > _MOST_CELLS:
            raise ValueError("too many cells")
        else:
            cells += [EMPTY] * empty + [cell] * repeated
            empty = 0
    return cells


def _convert_ods(element: ElementTree.Element) -> SheetCell:
    if element.tag == f"{_TABLE}covered-table-cell":
        return SheetCell(fault=_MERGED)
    text = "\n".join(map(_join_text, element.iterfind(f"{_TEXT}p")))
    if element.get(_ERROR) == "error":
        return SheetCell(fault=Fault(f"is the error {text[:20]}", "Correct the formula."))
    match element.get(f"{_OFFICE}value-type"):
        case None if element.get(f"{_TABLE}formula") is not None:
            return SheetCell(fault=_FORMULA)
        case None | "string":
            return _convert_text(text)
        case "float":
            return _convert_number(float(element.attrib[f"{_OFFICE}value"]))
        case "date" | "time":
            return SheetCell(fault=_DATE)
        case kind:
            return SheetCell(fault=Fault(f"is a {kind[:20]}"))


def _join_text(paragraph: ElementTree.Element) -> str:
    """Text of a paragraph with the blanks that the file counts."""
    parts = [paragraph.text or ""]
    for child in paragraph:
        blanks = min(int(child.get(f"{_TEXT}c", "1")), 100) if child.tag == f"{_TEXT}s" else 0
        parts += [" " * blanks or _join_text(child), child.tail or ""]
    return "".join(parts)

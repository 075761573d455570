"""Workbooks: sheets of numbers and texts with heads, input checks and fixed dates; needs the extra `sheets`.

The same sheets give the same bytes. A text is never a formula.
"""

import io
import re
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from pydantic import BaseModel

from pantocheck.conformance.core.key_paths import key_adapter
from pantocheck.conformance.core.validation_messages import describe_field, list_bounds

_LONGEST_TEXT = 32_000
"""Longest text of a cell; the format permits 32,767 characters."""

_CHECKED_ROWS = 2000
"""Rows below the head that have input checks."""

_EPOCH = (1980, 1, 1, 0, 0, 0)
_FORMULA_SIGNS = ("=", "+", "-", "@")
_NO_TEXT = re.compile(r"[\x00-\x08\x0b-\x1f\ud800-\udfff\ufffe\uffff]")
_CHANGED = re.compile(rb"(<dcterms:modified[^>]*>)[^<]*")

CellContent = str | float | int | None


@dataclass(frozen=True)
class SheetColumn:
    """Column of a sheet, with the check of its cells."""

    name: str
    """Name with its unit, in the head."""
    meaning: str = ""
    """Description that the program shows beside a selected cell."""
    words: tuple[str, ...] = ()
    """Accepted words; empty for any."""
    rule: str = ""
    """Accepted numbers in words; empty for a column of texts."""
    bounds: tuple[str, ...] = ()
    """Conditions of a number, such as `>=0`; `=INT` for a whole number."""


@dataclass(frozen=True)
class WrittenSheet:
    """Sheet to write."""

    name: str
    columns: tuple[SheetColumn, ...]
    rows: Sequence[Sequence[CellContent]]
    """Cells in the order of the columns."""
    is_filled_in: bool = False
    """Whether a person fills in the sheet, so that it has input checks."""


def describe_column(name: str, model: type[BaseModel], key: str) -> SheetColumn:
    """Column of a key of an input table: its description, accepted words and bounds.

    Args:
        name: Name of the column.
        model: Input table.
        key: Key of the table; a list stands for its items.
    """
    schema = key_adapter(model, key).json_schema()
    found = _find_value(schema, schema)
    meaning = describe_field(model, key) or str(found.get("description", ""))
    words = tuple(map(str, found.get("enum", [found["const"]] if "const" in found else [])))
    if found.get("type") not in ("number", "integer"):
        return SheetColumn(name, meaning, words)
    is_whole = found["type"] == "integer"
    rule = " ".join(("a whole number" if is_whole else "a number", ", ".join(list_bounds(found)))).strip()
    bounds = tuple(f"{sign}{found[limit]:.15g}" for limit, sign in _SIGNS.items() if limit in found)
    return SheetColumn(name, meaning, words, rule, (*bounds, *(("=INT",) if is_whole else ())))


_SIGNS = {"minimum": ">=", "exclusiveMinimum": ">", "maximum": "<=", "exclusiveMaximum": "<"}


def _find_value(part: dict[str, Any], schema: dict[str, Any]) -> dict[str, Any]:
    """Schema of the values of a key: the first one that is not null, inside lists and references."""
    while True:
        if "anyOf" in part:
            part = next(option for option in part["anyOf"] if option.get("type") != "null")
        elif "$ref" in part:
            part = schema["$defs"][part["$ref"].rpartition("/")[2]]
        elif "items" in part:
            part = part["items"]
        else:
            return part


def write_workbook(sheets: Sequence[WrittenSheet]) -> bytes:
    """Content of an XLSX file; the sheets have different names of at most 31 characters."""
    from openpyxl import Workbook

    book = Workbook()
    book.remove(book.active)
    book.properties.creator = "Pantocheck"
    book.properties.created = datetime(*_EPOCH)
    for sheet in sheets:
        _write_sheet(book.create_sheet(sheet.name), sheet)
    buffer = io.BytesIO()
    book.save(buffer)
    return _fix_dates(buffer.getvalue())


def _write_sheet(target: Any, sheet: WrittenSheet) -> None:
    from openpyxl.styles import Font
    from openpyxl.utils import get_column_letter

    for number, column in enumerate(sheet.columns, 1):
        letter = get_column_letter(number)
        cells = [row[number - 1] for row in sheet.rows]
        for place, content in enumerate((column.name, *cells), 1):
            if content is not None and content != "":
                _fill_cell(target.cell(place, number), content)
        target.cell(1, number).font = Font(bold=True)
        longest = max((len(str(content)) for content in (column.name, *cells[:200])), default=0)
        target.column_dimensions[letter].width = min(longest + 2, 60)
        if sheet.is_filled_in and not column.rule:
            target.column_dimensions[letter].number_format = "@"  # `+z` and `1-2` stay texts
        if sheet.is_filled_in and (column.words or column.rule or column.meaning):
            target.add_data_validation(_build_check(column, letter, max(_CHECKED_ROWS, 2 * len(sheet.rows))))
    target.freeze_panes = "A2"


def _fill_cell(cell: Any, content: str | float | int) -> None:
    if isinstance(content, str):
        cell.value = _NO_TEXT.sub("\ufffd", content)[:_LONGEST_TEXT]
        cell.data_type = "s"  # never a formula
        cell.quotePrefix = content.startswith(_FORMULA_SIGNS)
    else:
        cell.value = repr(content)  # openpyxl would write 16 digits of a number
        cell.data_type = "n"


def _build_check(column: SheetColumn, letter: str, rows: int) -> Any:
    """Input check of the cells below a head."""
    from openpyxl.worksheet.datavalidation import DataValidation

    first = f"{letter}2"
    wanted, check = column.rule, DataValidation()
    if column.words:
        wanted = f"one of {', '.join(column.words)}"
        check = DataValidation(type="list", formula1=f'"{",".join(column.words)}"')
    elif column.rule:
        conditions = [f"{first}{bound}({first})" if bound == "=INT" else f"{first}{bound}" for bound in column.bounds]
        check = DataValidation(type="custom", formula1=f"AND({','.join((f'ISNUMBER({first})', *conditions))})")
    check.allow_blank = True
    check.showErrorMessage, check.showInputMessage = bool(wanted), True
    check.errorTitle, check.error = column.name[:32], f"Write {wanted}."[:255]
    check.promptTitle = column.name[:32]
    check.prompt = "; ".join(part for part in (column.meaning, wanted) if part)[:255]
    check.add(f"{letter}2:{letter}{rows + 1}")
    return check


def _fix_dates(content: bytes) -> bytes:
    """The same archive without the time of its writing."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as source, zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as target:
        for name in source.namelist():
            part = _CHANGED.sub(rb"\g<1>1980-01-01T00:00:00Z", source.read(name))
            member = zipfile.ZipInfo(name, _EPOCH)
            member.compress_type, member.create_system = zipfile.ZIP_DEFLATED, 3
            target.writestr(member, part)
    return buffer.getvalue()

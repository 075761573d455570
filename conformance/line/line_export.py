"""Export of a line as tables of its supports and droppers: CSV, or sheets with checks of their cells."""

import csv
import io
from collections.abc import Sequence
from typing import Annotated, Literal

from pydantic import BaseModel, Field

from pantocheck.conformance.core.extras import require_package
from pantocheck.conformance.core.workbook_writing import SheetColumn, WrittenSheet, describe_column, write_workbook
from pantocheck.conformance.line.elements.dropper_schedule import DropperSchedule
from pantocheck.conformance.line.line_columns import (
    DROPPER_COLUMNS,
    DROPPER_SHEET,
    POSITION,
    SPAN_LENGTH,
    SUPPORT_COLUMNS,
    SUPPORT_KEYS,
    SUPPORT_SHEET,
)
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.support_table import CHANGED_TABLES, LIMIT_VALUES, SUPPORT_CHANGES, SupportPlace

DecimalMark = Literal["point", "comma"]
Cell = float | int | str | None

DELIMITER_BY_MARK: dict[DecimalMark, str] = {"point": ",", "comma": ";"}
"""Separator of the columns by the decimal mark of the numbers."""


def export_supports(line: LineFile, mark: DecimalMark = "point") -> str:
    """Write the table of the supports and both ends of a line.

    Args:
        line: The line.
        mark: Decimal mark; columns are separated by commas, or by semicolons beside decimal commas.

    Returns:
        CSV text; a column without any value is left out. Numbers have all digits of the line file.
    """
    return _write_table(SUPPORT_COLUMNS, _list_support_rows(line), mark)


def export_droppers(line: LineFile, mark: DecimalMark = "point") -> str:
    """Write the table of the droppers of every span; parameters and return value as in `export_supports`."""
    return _write_table(DROPPER_COLUMNS, _list_dropper_rows(line), mark)


def export_workbook(line: LineFile) -> bytes:
    """Write both tables as the sheets of a workbook, with every column and with checks of the cells.

    Raises:
        MissingPackage: The extra `sheets` is not installed.
    """
    require_package("openpyxl", "format 'xlsx'")
    supports = [describe_column(name, *_find_key(name)) for name in SUPPORT_COLUMNS]
    droppers = [
        describe_column(name, _PlaceColumns if name == "span" else DropperSchedule, name) for name in DROPPER_COLUMNS
    ]
    return write_workbook(
        [
            _build_sheet(SUPPORT_SHEET, supports, _list_support_rows(line)),
            _build_sheet(DROPPER_SHEET, droppers, _list_dropper_rows(line)),
        ]
    )


def _build_sheet(name: str, columns: list[SheetColumn], rows: list[dict[str, Cell]]) -> WrittenSheet:
    cells = [[row.get(column.name) for column in columns] for row in rows]
    return WrittenSheet(name, tuple(columns), cells, is_filled_in=True)


class _PlaceColumns(SupportPlace):
    """Columns of both tables that are not keys of the line file."""

    name: str | None = None
    """Name of the support, for the reader."""
    x_m: float | None = None
    """Position along the track, from anywhere [m]."""
    span_m: Annotated[float | None, Field(gt=0)] = None
    """Length of the span that begins at the support [m]; empty in the last row."""
    span: Annotated[int, Field(ge=1)] = 1
    """Number of the span, from 1."""


def _find_key(column: str) -> tuple[type[BaseModel], str]:
    """Table and key of a column of the table of supports."""
    path = SUPPORT_KEYS.get(column, (column,))
    return (CHANGED_TABLES[path[0]] if len(path) == 2 else _PlaceColumns), path[-1]


def _list_support_rows(line: LineFile) -> list[dict[str, Cell]]:
    layout, rows = line.layout, list[dict[str, Cell]]()
    for limit, length in zip(layout.limits, (*line.geometry.span_lengths, None), strict=True):
        places: dict[str, Cell] = {"number": limit.number, POSITION: limit.position, SPAN_LENGTH: length}
        rows.append(places | {key: value.read(limit) for key, value in LIMIT_VALUES.items()})
    inner = {column: path for column, path in SUPPORT_KEYS.items() if len(path) == 2}
    for support in layout.supports:
        tables = {key: support.overlay(key, table) for key in SUPPORT_CHANGES if (table := getattr(line, key))}
        values = {column: getattr(tables.get(table), key, None) for column, (table, key) in inner.items()}
        rows[support.limit.number] |= values
    return rows


def _list_dropper_rows(line: LineFile) -> list[dict[str, Cell]]:
    rows: list[dict[str, Cell]] = []
    for number, schedule in enumerate(line.dropper_schedules, 1):
        lists = schedule.list_values()
        rows += ({"span": number} | {key: values[i] for key, values in lists.items()} for i in range(len(schedule.x_m)))
    return rows


def _write_table(columns: Sequence[str], rows: list[dict[str, Cell]], mark: DecimalMark) -> str:
    filled = [column for column in columns if any(row.get(column) is not None for row in rows)]
    buffer = io.StringIO()
    writer = csv.writer(buffer, delimiter=DELIMITER_BY_MARK[mark], lineterminator="\n")
    writer.writerow(filled)
    writer.writerows([_format_cell(row.get(column), mark) for column in filled] for row in rows)
    return buffer.getvalue()


def _format_cell(value: Cell, mark: DecimalMark) -> str:
    text = "" if value is None else str(value)
    return text.replace(".", ",") if mark == "comma" and isinstance(value, float) else text

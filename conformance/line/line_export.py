"""Export of a line as tables of its supports and droppers."""

import csv
import io
from collections.abc import Sequence
from typing import Literal

from pantocheck.conformance.line.line_columns import (
    DROPPER_COLUMNS,
    POSITION,
    SPAN_LENGTH,
    SUPPORT_COLUMNS,
    SUPPORT_KEYS,
)
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.support_table import LIMIT_VALUES, SUPPORT_CHANGES

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
    layout, rows = line.layout, list[dict[str, Cell]]()
    for limit, length in zip(layout.limits, (*line.geometry.span_lengths, None), strict=True):
        places: dict[str, Cell] = {"number": limit.number, POSITION: limit.position, SPAN_LENGTH: length}
        rows.append(places | {key: value.read(limit) for key, value in LIMIT_VALUES.items()})
    inner = {column: path for column, path in SUPPORT_KEYS.items() if len(path) == 2}
    for support in layout.supports:
        tables = {key: support.overlay(key, table) for key in SUPPORT_CHANGES if (table := getattr(line, key))}
        values = {column: getattr(tables.get(table), key, None) for column, (table, key) in inner.items()}
        rows[support.limit.number] |= values
    return _write_table(SUPPORT_COLUMNS, rows, mark)


def export_droppers(line: LineFile, mark: DecimalMark = "point") -> str:
    """Write the table of the droppers of every span; parameters and return value as in `export_supports`."""
    rows: list[dict[str, Cell]] = []
    for number, schedule in enumerate(line.dropper_schedules, 1):
        lists = schedule.list_values()
        rows += ({"span": number} | {key: values[i] for key, values in lists.items()} for i in range(len(schedule.x_m)))
    return _write_table(DROPPER_COLUMNS, rows, mark)


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

"""Export of a line as tables of its supports and droppers."""

import csv
import io
from collections.abc import Sequence
from typing import Literal

from pantocheck.conformance.line.line_columns import DROPPER_COLUMNS, SUPPORT_COLUMNS, SUPPORT_KEYS
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_layout import LineLayout, SpanLimit

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
    layout = line.layout
    rows = [
        _list_support(limit, length, layout)
        for limit, length in zip(layout.limits, (*line.geometry.span_lengths, None), strict=True)
    ]
    return _write_table(SUPPORT_COLUMNS, rows, mark)


def export_droppers(line: LineFile, mark: DecimalMark = "point") -> str:
    """Write the table of the droppers of every span; parameters and return value as in `export_supports`."""
    rows: list[dict[str, Cell]] = []
    for number, schedule in enumerate(line.dropper_schedules, 1):
        level = {} if schedule.contact_wire_height_m is not None else {"presag_m": (0.0,) * len(schedule.x_m)}
        lists = level | schedule.model_dump(exclude_none=True)
        rows += ({"span": number} | {key: values[i] for key, values in lists.items()} for i in range(len(schedule.x_m)))
    return _write_table(DROPPER_COLUMNS, rows, mark)


def _list_support(limit: SpanLimit, length: float | None, layout: LineLayout) -> dict[str, Cell]:
    """Values of a support or end of the line by column."""
    row: dict[str, Cell] = {
        "number": limit.number,
        "x_m": limit.position,
        "span_m": length,
        "stagger_contact_wire_m": limit.contact_wire_stagger + 0.0,  # no negative zero
        "stagger_messenger_m": limit.messenger_wire_stagger + 0.0,
        "contact_wire_height_m": limit.contact_wire_height,
        "encumbrance_m": limit.encumbrance,
    }
    support = next((support for support in layout.supports if support.limit.number == limit.number), None)
    if support is not None:
        inner = {column: path for column, path in SUPPORT_KEYS.items() if len(path) == 2}
        row |= {column: getattr(getattr(support, table), key) for column, (table, key) in inner.items()}
    return row


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

"""Sheets of numbers: one column per channel below its name; rows have the numbers of the sheet in messages."""

from pathlib import Path

import numpy as np

from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.measured_table import ChannelNames, MeasuredTable, TableColumn
from pantocheck.conformance.core.spreadsheet import list_faults, list_table_rows
from pantocheck.conformance.core.text_reading import is_number, is_thousands
from pantocheck.conformance.core.workbook_reading import EMPTY, SheetRow, read_sheet


def read_sheet_table(path: Path, names: ChannelNames, largest: int) -> list[MeasuredTable]:
    """Read the only sheet of a workbook; arguments and errors as in `measured_table.Reader`.

    An empty cell is a missing value, and so is every cell of a column without a number. A text is a number if it can be
    read as one only.
    """
    del names
    sheet = read_sheet(path, f"record '{path.name}'")
    head, *rows = list_table_rows(sheet.rows, sheet.where)
    width = len(head.cells)
    if not rows:
        raise InputError(sheet.where, "has a head line but no rows", "Export the record again.")
    if len(rows) * width > largest:
        raise InputError(sheet.where, f"holds more than {largest} numbers", "Shorten the record.")
    values, problems = np.full((len(rows), width), np.nan), list[InputError]()
    for column, name in enumerate(head.cells):
        part = [SheetRow(row.number, (row.cells[column],)) for row in (head, *rows)]
        if not any(cell.is_number or is_number(cell.text, None) for _, (cell,) in part[1:]):
            continue  # a column of texts
        problems += list_faults(part, sheet.where)
        for place, (number, (cell,)) in enumerate(part[1:]):
            if cell == EMPTY or cell.fault is not None:
                continue
            if cell.is_number or (is_number(cell.text, None) and not is_thousands(cell.text)):
                values[place, column] = float(cell.text.replace(",", "."))
            else:
                where = f"{sheet.where}, row {number}, column {name.text[:80]!r}"
                problems.append(InputError(where, f"{cell.text[:40]!r} is not a number", "Write a number."))
    if problems:
        raise join_errors(problems)
    return [MeasuredTable(path.name, values, tuple(TableColumn(cell.text) for cell in head.cells))]

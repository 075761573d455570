"""Columns of the tables of supports and droppers: the keys of a line file, those of inner tables behind their name."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal

from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.core.spreadsheet import Spreadsheet
from pantocheck.conformance.core.text_reading import is_thousands
from pantocheck.conformance.core.units import convert_key, find_unit, suggest_key
from pantocheck.conformance.line.elements.dropper_schedule import DropperSchedule
from pantocheck.conformance.line.support_table import LIMIT_VALUES, SUPPORT_CHANGES

SUPPORT_KEYS: dict[str, tuple[str, ...]] = {
    **{key: (key,) for key in LIMIT_VALUES},
    **{f"{table}_{key}": (table, key) for table, model in SUPPORT_CHANGES.items() for key in model.model_fields},
}
"""Path inside the table of a support, by the name of a column: `steady_arm_length_m` is `steady_arm.length_m`."""

POSITION, SPAN_LENGTH = "x_m", "span_m"

SUPPORT_COLUMNS = ("number", "name", POSITION, SPAN_LENGTH, *SUPPORT_KEYS)
"""Columns of the table of supports."""

DROPPER_KEYS = tuple(DropperSchedule.model_fields)
"""Columns of the table of droppers that are keys of a schedule."""

DROPPER_COLUMNS = ("span", *DROPPER_KEYS)
"""Columns of the table of droppers."""

SUPPORT_SHEET, DROPPER_SHEET = "supports", "droppers"
"""Names of the tables in a workbook with several sheets."""


# Typed rows of a table: known columns, numbers in the units of the line file, whole numbers and words.
WHOLE_NUMBERS = frozenset({"number", "span", "column", "sensor"})
"""Columns of whole numbers; a column with a unit holds numbers, any other words."""

LONGEST_NUMBER = 40
"""Largest number of characters of a number."""

_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d{1,3})?")
_WHOLE = re.compile(r"\d{1,6}")

CellValue = Decimal | int | str


@dataclass(frozen=True)
class TypedRow:
    """Row with the values of its filled cells."""

    values: dict[str, CellValue]
    """Values by the name of the column, in the units of the line file."""
    places: dict[str, str]
    """Place of every cell in messages, by the name of the column; also of empty cells."""
    place: str
    """Place of the row in messages."""

    def number(self, column: str) -> float | None:
        """Number of a column; None for an empty cell."""
        value = self.values.get(column)
        return None if value is None else float(value)


def read_typed_rows(table: Spreadsheet, known: Sequence[str], problems: list[InputError]) -> list[TypedRow]:
    """Read the cells of a table by the units and kinds of their columns.

    Args:
        table: The table.
        known: Known columns, in the units of the line file.
        problems: List to which every problem is added: unknown and repeated columns, and cells that cannot be read.

    Returns:
        Rows; a cell that cannot be read is missing.
    """
    columns: dict[int, tuple[str, float]] = {}
    for index, heading in enumerate(table.head.cells):
        converted = convert_key(heading, known)
        place = table.locate(table.head, index)
        if converted is None:
            hint = suggest_key(heading, None, list(known)) or suggest_names(heading, known)
            problems.append(
                InputError(place, "unknown column", f"{hint} Remove columns that are not part of the line.")
            )
        elif converted[0] in (name for name, _ in columns.values()):
            problems.append(InputError(place, f"repeats the column {converted[0]}", "Give each value once."))
        else:
            columns[index] = converted
    problems += _find_mixed_decimals(table, columns)
    rows = []
    for row in table.rows:
        values: dict[str, CellValue] = {}
        for index, (name, factor) in columns.items():
            try:
                is_text = not table.delimiter and index not in row.numbers
                value = _read_cell(name, row.cells[index], factor, table.delimiter == ",", is_text)
            except ValueError as error:
                problems.append(InputError(table.locate(row, index), f"found {row.cells[index][:40]!r}", str(error)))
                continue
            if value is not None:
                values[name] = value
        places = {name: table.locate(row, index) for index, (name, _) in columns.items()}
        rows.append(TypedRow(values, places, f"{table.where}, row {row.number}"))
    return rows


def _read_cell(name: str, text: str, factor: float, only_points: bool, in_workbook: bool) -> CellValue | None:
    """Value of a cell; None if it is empty. A ValueError has the hint for the user.

    Args:
        name: Column.
        text: Content of the cell.
        factor: Factor of the unit.
        only_points: Whether commas separate the columns.
        in_workbook: Whether a workbook stores the cell as text, beside numbers whose decimal mark is certain.
    """
    if not text:
        return None
    if name in WHOLE_NUMBERS:
        if not _WHOLE.fullmatch(text):
            raise ValueError("Write a whole number, such as 3.")
        return int(text)
    if find_unit(name) is None:
        return text
    if in_workbook and is_thousands(text):
        raise ValueError("Its mark may separate decimals or thousands: format the cell as a number.")
    if len(text) > LONGEST_NUMBER or not _NUMBER.fullmatch(text) or (only_points and "," in text):
        raise ValueError("Write a number such as 1.5, or 1,5 in a table with semicolons; leave out thousands marks.")
    return Decimal(text.replace(",", ".")) * Decimal(repr(factor))


def _find_mixed_decimals(table: Spreadsheet, columns: dict[int, tuple[str, float]]) -> Iterator[InputError]:
    """Decimal points beside decimal commas: one of them could be a thousands mark."""
    numbers = [index for index, (name, _) in columns.items() if find_unit(name) is not None]
    texts = [(row, i) for row in table.rows for i in numbers if i not in row.numbers]
    places = {mark: next(((row, i) for row, i in texts if mark in row.cells[i]), None) for mark in ".,"}
    point, comma = places["."], places[","]
    if table.delimiter != "," and point is not None and comma is not None:
        yield InputError(
            table.locate(*comma),
            f"has a decimal comma, but row {point[0].number} has a decimal point",
            "Write all decimals of a table alike, and no thousands marks.",
        )

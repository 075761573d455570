"""Cells of a text table: splitting of lines, numbers under a decimal mark, and thousands marks."""

import csv
import re

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.text_settings import DecimalSign

_NUMBER = {
    ".": re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(nan|inf)", re.IGNORECASE),
    ",": re.compile(r"[+-]?\d+(,\d+)?([eE][+-]?\d+)?|[+-]?(nan|inf)", re.IGNORECASE),
}
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}([.,]\d{3})+")
"""Number whose mark may separate thousands; `0,123` cannot be such a number."""


def split_cells(line: str, separator: str) -> list[str]:
    """Cells of a line without quotes and blanks around them."""
    text = line.strip("\r\n")
    if separator == " ":
        return [cell for cell in text.strip().split(" ") if cell]
    if '"' in text:
        return [cell.strip().strip('"') for cell in next(csv.reader([text], delimiter=separator))]
    return [cell.strip() for cell in text.split(separator)]


def is_number(cell: str, decimal: DecimalSign | None) -> bool:
    """Whether a cell is a number; without a decimal mark, either mark is accepted."""
    if decimal is None:
        return any(number.fullmatch(cell) for number in _NUMBER.values())
    return _NUMBER[decimal].fullmatch(cell) is not None


def number_error(place: str, column: int, cell: str) -> InputError:
    """Error of a cell that is not a number; columns count from 0."""
    return InputError(
        f"{place}, column {column + 1}",
        f"{cell[:40]!r} is not a number",
        "Write 1.5 with commas between columns, or 1,5 with semicolons; nan marks a missing value.",
    )


def is_thousands(cell: str) -> bool:
    """Whether the marks of a number may separate thousands."""
    return _THOUSANDS.fullmatch(cell) is not None


def thousands_error(where: str, cell: str) -> InputError:
    """Error of a number whose mark may separate thousands."""
    mark = "," if "," in cell else "."
    return InputError(
        where,
        f"the mark in {cell!r} may separate decimals or thousands",
        f'State decimal = "{mark}" in [table] of the sidecar if it marks decimals; thousands marks are not read.',
    )

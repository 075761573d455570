"""Check of a table of supports or droppers without its line."""

from pathlib import Path

from pantocheck.conformance.input_files.input_error import InputError, join_errors
from pantocheck.conformance.input_files.spreadsheet import Spreadsheet, read_spreadsheet
from pantocheck.conformance.input_files.units import convert_key
from pantocheck.conformance.line_tables.line_columns import DROPPER_COLUMNS, SUPPORT_COLUMNS
from pantocheck.conformance.line_tables.support_rows import read_span_lengths
from pantocheck.conformance.line_tables.typed_rows import read_typed_rows

FEWEST_COLUMNS = 2
"""Fewest known columns by which a table is recognised."""


def read_line_table(path: Path) -> Spreadsheet | None:
    """Read a table of supports or droppers; None for any other file.

    A table is recognised by its columns: at least `FEWEST_COLUMNS`, and at least half of them, are known.
    """
    try:
        table = read_spreadsheet(path)
    except InputError:
        return None
    headings = table.head.cells
    known = sum(convert_key(heading, [*SUPPORT_COLUMNS, *DROPPER_COLUMNS]) is not None for heading in headings)
    return table if known >= FEWEST_COLUMNS and 2 * known >= len(headings) else None


def check_line_table(table: Spreadsheet) -> str:
    """Check the cells of a table of supports or droppers, and the spans between supports.

    Returns:
        Kind and size of the table, for one line of output.

    Raises:
        InputError: Columns or cells are invalid; the error lists all problems.
    """
    problems: list[InputError] = []
    of_droppers = "span" in table.head.cells
    rows = read_typed_rows(table, DROPPER_COLUMNS if of_droppers else SUPPORT_COLUMNS, problems)
    if not of_droppers:
        read_span_lengths(rows, table.where, problems)
    if problems:
        raise join_errors(problems)
    kind = "droppers" if of_droppers else "supports and ends"
    return f"table of {len(rows)} {kind}; `pantocheck line import` checks it with its line"

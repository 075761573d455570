"""Rows of the table of supports: lengths of the spans, and the values of every support."""

from decimal import Decimal
from itertools import pairwise
from pathlib import Path
from typing import Any

from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.spreadsheet import Spreadsheet, read_spreadsheet
from pantocheck.conformance.core.units import convert_key
from pantocheck.conformance.core.workbook_reading import WORKBOOK_SUFFIXES, list_sheet_names
from pantocheck.conformance.line.line_columns import (
    DROPPER_COLUMNS,
    DROPPER_SHEET,
    POSITION,
    SPAN_LENGTH,
    SUPPORT_COLUMNS,
    SUPPORT_KEYS,
    SUPPORT_SHEET,
    TypedRow,
    read_typed_rows,
)

LARGEST_DISAGREEMENT = Decimal("0.001")
"""Largest difference between a span length and the distance of two positions, both rounded to a millimetre [m]."""


def read_span_lengths(rows: list[TypedRow], where: str, problems: list[InputError]) -> list[float | None]:
    """Lengths of the spans, from their own column or from the positions of the supports.

    The positions increase or decrease in running order.

    Args:
        rows: Rows of the table, ends of the line included.
        where: Name of the table in messages.
        problems: List to which every problem is added.

    Returns:
        Length of the span behind every row but the last [m]; None where there is none.
    """
    if len(rows) < 2:
        problems.append(InputError(where, "has one row", "Give a row per support, and one for each end of the line."))
    _check_numbers(rows, problems)
    by_length = any(SPAN_LENGTH in row.values for row in rows)
    if not by_length and not any(POSITION in row.values for row in rows):
        problems.append(
            InputError(where, f"has neither {SPAN_LENGTH} nor {POSITION}", "Give the spans, or the positions.")
        )
        return [None] * (len(rows) - 1)
    if by_length and SPAN_LENGTH in rows[-1].values:
        problems.append(
            InputError(
                rows[-1].places[SPAN_LENGTH],
                "a span begins at the end of the line",
                f"{SPAN_LENGTH} is the length of the span that begins at the support: leave the last cell empty. A row "
                "without any value is skipped, so give the last row its number.",
            )
        )
    distances = _measure_distances(rows)
    lengths: list[Decimal | None] = [
        _read_length(here, distance, problems) if by_length else _read_distance(here, behind, distance, problems)
        for (here, behind), distance in zip(pairwise(rows), distances, strict=True)
    ]
    return [None if length is None else float(length) for length in lengths]


def _check_numbers(rows: list[TypedRow], problems: list[InputError]) -> None:
    if not any("number" in row.values for row in rows):
        return
    for number, row in enumerate(rows):
        found = row.values.get("number", "an empty cell")
        if found != number:
            hint = "Number the rows in running order: 0 is the start of the line, the last row its end."
            problems.append(InputError(row.places["number"], f"found {found}, expected {number}", hint))


def _measure_distances(rows: list[TypedRow]) -> list[Decimal | None]:
    """Distances between neighbouring positions in the direction from the first to the last one; None: not known [m]."""
    positions = [x if isinstance(x := row.values.get(POSITION), Decimal) else None for row in rows]
    known = [x for x in positions if x is not None]
    direction = -1 if known and known[-1] < known[0] else 1
    return [None if start is None or end is None else direction * (end - start) for start, end in pairwise(positions)]


def _read_distance(
    here: TypedRow, behind: TypedRow, distance: Decimal | None, problems: list[InputError]
) -> Decimal | None:
    """Length of the span between two positions; None if one is missing, or if they run backwards."""
    if distance is None:
        missing = here if POSITION not in here.values else behind
        problems.append(InputError(missing.places[POSITION], "the position is missing", "Give every position."))
        return None
    if distance <= 0:
        hint = "List the supports in running order, with increasing or with decreasing positions."
        problems.append(InputError(behind.places[POSITION], "the position runs backwards", hint))
        return None
    return distance


def _read_length(here: TypedRow, distance: Decimal | None, problems: list[InputError]) -> Decimal | None:
    """Length of the span that begins at a support; None if it is missing."""
    length = here.values.get(SPAN_LENGTH)
    if not isinstance(length, Decimal):
        problems.append(InputError(here.places[SPAN_LENGTH], "the span length is missing", "Give the length."))
        return None
    if distance is not None and abs(distance - length) > LARGEST_DISAGREEMENT:
        problems.append(
            InputError(
                here.places[SPAN_LENGTH],
                f"the span is {length.normalize():f} m, but the positions are {distance.normalize():f} m apart",
                f"Correct one of them, or leave out the column {POSITION}.",
            )
        )
    return length


def build_support_tables(rows: list[TypedRow]) -> list[dict[str, Any]]:
    """Tables `geometry.support` with the filled cells of every row."""
    tables = []
    for number, row in enumerate(rows):
        table: dict[str, Any] = {"number": number}
        for column, path in SUPPORT_KEYS.items():
            if (value := row.values.get(column)) is not None:
                inner = table if len(path) == 1 else table.setdefault(path[0], {})
                inner[path[-1]] = float(value) if isinstance(value, Decimal) else value
        tables.append(table)
    return tables


def locate_supports(rows: list[TypedRow]) -> dict[str, str]:
    """Place in the table by key of the line file, for messages."""
    places: dict[str, str] = {}
    for i, row in enumerate(rows, 1):
        length = row.places.get(SPAN_LENGTH, row.places.get(POSITION, row.place))
        places |= {f"geometry.span_list[{i}]": length, f"geometry.span_list[{i}].length_m": length}
        places[f"geometry.support[{i}]"] = row.place
        for column, path in SUPPORT_KEYS.items():
            key = ".".join((f"geometry.support[{i}]", *path))
            places[key] = row.places.get(column, row.place)
            if column in row.values:
                places.setdefault(key.rpartition(".")[0], places[key])  # the first value of an inner table
    return places


# Check of a table of supports or droppers without its line.
FEWEST_COLUMNS = 2
"""Fewest known columns by which a table is recognised."""


def read_line_tables(path: Path) -> list[Spreadsheet]:
    """Read tables of supports or droppers: a text, or the sheets of a workbook; none for any other file.

    A table is recognised by its columns: at least `FEWEST_COLUMNS`, and at least half of them, are known. Sheets that
    are named `supports` or `droppers` are recognised, too.

    Raises:
        InputError: A sheet of this name cannot be read.
    """
    names: list[str | None] = [None]
    if path.suffix.lower() in WORKBOOK_SUFFIXES:
        try:
            found = {name.strip().lower() for name in list_sheet_names(path, f"table '{path.name}'")}
        except InputError:
            return []
        names = [name for name in (SUPPORT_SHEET, DROPPER_SHEET) if name in found] or names
    tables = []
    for name in names:
        try:
            table = read_spreadsheet(path, name)
        except InputError:
            if name is not None:
                raise
            continue
        headings = table.head.cells
        known = sum(convert_key(heading, [*SUPPORT_COLUMNS, *DROPPER_COLUMNS]) is not None for heading in headings)
        if name is not None or (known >= FEWEST_COLUMNS and 2 * known >= len(headings)):
            tables.append(table)
    return tables


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

"""Rows of a table in messages."""

from pantocheck.conformance.array_types import IntegerArray

MOST_NAMED_ROWS = 8
"""Largest number of rows that a message names."""


def name_rows(rows: IntegerArray, most: int = MOST_NAMED_ROWS) -> str:
    """Name rows by their numbers; the first ones of many, `rows 2, 3, ... and 5 more`."""
    names = ", ".join(map(str, rows[:most]))
    further = rows.size - most
    return f"row{'s' if rows.size > 1 else ''} {names}" + (f" and {further} more" if further > 0 else "")

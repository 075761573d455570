"""Values of single supports, in place of those of the line."""

from typing import TypeVar

from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.sourced_table import InputTable

Table = TypeVar("Table", bound=InputTable)

SINGLE_SUPPORTS = Feature("single_supports")
"""Feature of values of single supports, in place of those of the line."""

MOST_SPANS = 1000
"""Largest number of spans of a line."""


def overlay_changes(table: Table, changes: InputTable | None) -> Table:
    """Table of the line with the values that differ at one support."""
    if changes is None:
        return table
    return type(table).model_validate(table.model_dump() | changes.model_dump(exclude_none=True))

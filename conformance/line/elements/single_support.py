"""Values of single supports, in place of those of the line."""

from operator import getitem
from typing import Annotated, Any, TypeVar, cast

from pydantic import Field, create_model

from pantocheck.conformance.core.features import Feature, find_declaration
from pantocheck.conformance.core.sourced_table import PROVENANCE, InputTable, SourcedTable

Table = TypeVar("Table", bound=InputTable)

SINGLE_SUPPORTS = Feature("single_supports")
"""Feature of values of single supports, in place of those of the line."""

MOST_SPANS = 1000
"""Largest number of spans of a line."""


def create_changes(table: type[SourcedTable], key: str) -> type[InputTable]:
    """Create the model of the values at one support that differ from a table of the line.

    Args:
        table: Table of the line; its keys need their descriptions as part of their types.
        key: Key of the table in the line file.

    Returns:
        Model with the keys of the table, all of them optional.
    """
    fields: dict[str, Any] = {}
    for own, field in table.model_fields.items():
        if own not in PROVENANCE:
            limits = (item for item in field.metadata if not isinstance(item, Feature))
            value = getitem(cast(Any, Annotated), (field.annotation, *limits, Field(description=field.description)))
            fields[own] = (Annotated[value | None, find_declaration(field) or SINGLE_SUPPORTS], None)
    name = f"{table.__name__.removesuffix('Table')}Changes"
    title = f"Values of the {key.replace('_', ' ')} at one support that differ from the table {key} of the line."
    return create_model(name, __base__=InputTable, __doc__=title, **fields)


def overlay_changes(table: Table, changes: InputTable | None) -> Table:
    """Table of the line with the values that differ at one support."""
    if changes is None:
        return table
    return type(table).model_validate(table.model_dump() | changes.model_dump(exclude_none=True))

"""Support of a line with its own values: heights, staggers, and changes of the tables that elements declare."""

from collections.abc import Iterator
from dataclasses import dataclass
from operator import getitem
from typing import Annotated, Any, cast

from pydantic import Field, create_model

from pantocheck.conformance.core.features import Feature, find_declaration
from pantocheck.conformance.core.key_paths import find_model
from pantocheck.conformance.core.sourced_table import PROVENANCE, InputTable, SourcedTable
from pantocheck.conformance.line.elements.element_registry import ELEMENTS
from pantocheck.conformance.line.elements.line_layout import MOST_SPANS, SINGLE_SUPPORTS, SpanLimit

Encumbrance = Annotated[
    float,
    Field(gt=0, le=5, description="vertical distance between messenger wire and contact wire at a support [m]"),
]
SignedStagger = Annotated[float, Field(ge=-1, le=1, description="lateral position, as built [m]")]
Height = Annotated[
    float, Field(ge=-20, le=20, description="height of the contact wire above a datum, for example the rail [m]")
]


@dataclass(frozen=True)
class LimitValue:
    """Value of every support and end of the line, which the table `geometry` can state once for all of them."""

    name: str
    """Name of the value in the layout."""
    factor: float = 1.0
    """Factor from one support to the next."""

    def read(self, limit: SpanLimit) -> float:
        """Value at a support or end of the line."""
        return float(getattr(limit, self.name)) + 0.0  # no negative zero


class SupportPlace(InputTable):
    """Support, or end of the line, with its own heights and staggers."""

    number: Annotated[int, Field(ge=0, le=MOST_SPANS)]
    """Number of the support in running order, from 1; 0 and the number of spans: ends of the line."""
    stagger_contact_wire_m: Annotated[
        SignedStagger | None, Feature("stagger", bool), LimitValue("contact_wire_stagger", -1.0)
    ] = None
    stagger_messenger_m: Annotated[
        SignedStagger | None, Feature("stagger", bool), LimitValue("messenger_wire_stagger", -1.0)
    ] = None
    contact_wire_height_m: Annotated[Height | None, SINGLE_SUPPORTS, LimitValue("contact_wire_height")] = None
    encumbrance_m: Annotated[Encumbrance | None, SINGLE_SUPPORTS, LimitValue("encumbrance")] = None


LIMIT_VALUES = {
    key: item
    for key, field in SupportPlace.model_fields.items()
    for item in field.metadata
    if isinstance(item, LimitValue)
}
"""Values of every support and end of the line, by key."""


def _list_changed_tables() -> Iterator[tuple[str, type[SourcedTable]]]:
    """Tables of the elements that a support may change, by their keys."""
    for element in ELEMENTS:
        for key in element.support_tables:
            table, _ = find_model(element.model_fields[key].annotation, set())
            if table is None or not issubclass(table, SourcedTable):
                raise TypeError(f"{element.__name__}: {key} is not a table of the line file")
            yield key, table


def _create_changes(table: type[SourcedTable], key: str) -> type[InputTable]:
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


CHANGED_TABLES = dict(_list_changed_tables())
"""Tables of the line that a support may change, by their keys."""

SUPPORT_CHANGES = {key: _create_changes(table, key) for key, table in CHANGED_TABLES.items()}
"""Models of the changes at one support, by the key of the table of the line."""

_CHANGES: dict[str, Any] = {
    key: (Annotated[model | None, SINGLE_SUPPORTS], None) for key, model in SUPPORT_CHANGES.items()
}
_ChangedTables: Any = create_model("_ChangedTables", __base__=SupportPlace, **_CHANGES)


class SupportTable(_ChangedTables, SupportPlace):
    """Support, or end of the line, with its own values; the other values are those of the line."""

    @property
    def changes(self) -> dict[str, InputTable]:
        """Own values of the support, by the key of the table of the line that they change."""
        return {key: table for key in SUPPORT_CHANGES if (table := getattr(self, key)) is not None}

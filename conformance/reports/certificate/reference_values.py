"""Values of the reference simulator beside those of the system under test, on request; they decide no verdict."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.page_text import format_value

REFERENCE_PLACE = 4
"""Place of the column in a table of criteria: behind value and error."""


def reference_note(case: dict[str, Any]) -> tuple[doc.Block, ...]:
    """Sentence on the reference of a case; empty if none was requested."""
    reference = case.get("reference")
    if reference is None:
        return ()
    name = f"{reference['name']} {reference['version']}"
    if reference["reason"] is not None:
        return (doc.Paragraph(f"{name}: no values for comparison, {reference['reason']}."),)
    return (doc.Paragraph(f"Reference: values of the {name}, for information. They take part in no verdict."),)


def insert_reference(case: dict[str, Any], table: doc.Table, criteria: Sequence[dict[str, Any]]) -> doc.Table:
    """Table of criteria with a column of the values of the reference, if the case has them.

    Parameters
    ----------
    case : dict
        Case of results.json.
    table : Table
        Table of criteria.
    criteria : sequence of dict
        Criterion of each row.
    """
    if not has_reference(case):
        return table
    column = doc.Column("Reference", number=True, short="Refer-\nence")
    values = [format_value(find_reference(case, item)) for item in criteria]
    return replace(
        table,
        columns=(*table.columns[:REFERENCE_PLACE], column, *table.columns[REFERENCE_PLACE:]),
        rows=tuple(
            (*row[:REFERENCE_PLACE], value, *row[REFERENCE_PLACE:])
            for row, value in zip(table.rows, values, strict=True)
        ),
    )


def has_reference(case: dict[str, Any]) -> bool:
    """Whether a case has values of the reference."""
    return case.get("reference") is not None and case["reference"]["reason"] is None


def find_reference(case: dict[str, Any], criterion: dict[str, Any]) -> float | None:
    """Value of the reference for a criterion; None if it has none."""
    found = case["reference"]["quantities"].get(str(criterion["pantograph"]), {}).get(criterion["quantity"])
    values = found if isinstance(found, list) else [found]
    item = criterion["item"] or 1
    return values[item - 1] if item <= len(values) else None


def select_reference_force(case: dict[str, Any], key: str) -> list[float]:
    """Filtered force of the reference at the drawn positions of a pantograph; empty if there is none."""
    reference = case.get("reference")
    force: list[float] = [] if reference is None else reference["force_20_N"].get(key, [])
    return force

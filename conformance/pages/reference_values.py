"""Values of the reference simulator beside those of the system under test, on request; they decide no verdict."""

from collections.abc import Sequence
from dataclasses import replace

from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.results_part import select_item
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.words import format_value
from pantocheck.conformance.results.results_format import CaseResult

REFERENCE_PLACE = 4
"""Place of the column in a table of criteria: behind value and error."""


def reference_note(case: CaseResult) -> tuple[doc.Block, ...]:
    """Sentence on the reference of a case; empty if none was requested."""
    reference = case.reference
    if reference is None:
        return ()
    name = f"{reference.name} {reference.version}"
    if reference.reason is not None:
        return (doc.Paragraph(f"{name}: no values for comparison, {reference.reason}."),)
    return (doc.Paragraph(f"Reference: values of the {name}, for information. They take part in no verdict."),)


def insert_reference(case: CaseResult, table: doc.Table, criteria: Sequence[Criterion]) -> doc.Table:
    """Table of criteria with a column of the values of the reference, if the case has them."""
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


def has_reference(case: CaseResult) -> bool:
    """Whether a case has values of the reference."""
    return case.reference is not None and case.reference.reason is None


def find_reference(case: CaseResult, criterion: Criterion) -> float | None:
    """Value of the reference for a criterion; None if it has none."""
    quantities = {} if case.reference is None else case.reference.quantities
    return select_item(quantities.get(str(criterion.pantograph), {}).get(criterion.quantity), criterion.item)


def select_reference_force(case: CaseResult, key: str) -> list[float]:
    """Filtered force of the reference at the drawn positions of a pantograph; empty if there is none."""
    return [] if case.reference is None else case.reference.force_20_N.get(key, [])

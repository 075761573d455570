"""Table of the values that the suite derives from the inputs of a case."""

from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.page_text import format_value
from pantocheck.conformance.results.results_format import CaseResult

DERIVED_COLUMNS = (
    doc.Column("Value", share=3),
    doc.Column("Result", number=True),
    doc.Column("Unit"),
    doc.Column("Follows from", share=4),
)
SHOWN_DIGITS = 5
"""Significant digits of a derived value: an uplift force to 0.01 N."""


def derived_blocks(case: CaseResult) -> tuple[doc.Block, ...]:
    """Table of derived values, and by whom they were computed; nothing if there are none."""
    if not case.derived:
        return ()
    rows = tuple(
        (fact.name, format_value(fact.value, SHOWN_DIGITS), fact.unit or "–", fact.basis) for fact in case.derived
    )
    text = "Computed by the suite from the inputs of the case. A tuned uplift force is a result of the run."
    return doc.Table(DERIVED_COLUMNS, rows), doc.SmallPrint(text)

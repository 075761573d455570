"""List of all quantities as comma-separated values: value, uncertainty by component, limits, verdict, input changes."""

import csv
import io
from collections.abc import Iterator
from typing import Any

from pantocheck.conformance.core.criterion import COMPONENT_NAMES
from pantocheck.conformance.pages.words import quantity_unit
from pantocheck.conformance.results.results_format import CaseResult, Results

COLUMNS = (
    *("case", "pantograph", "quantity", "item", "value", "unit", "uncertainty"),
    *COMPONENT_NAMES,
    *("lower", "upper", "verdict", "changes"),
)
NOT_KNOWN = "NA"
"""Cell of a value that is not known: it is not zero."""


def render_quantity_list(results: Results) -> str:
    """Table of all quantities of a run; numbers have all their digits."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(row for case in results.cases for row in _list_rows(case))
    return text.getvalue()


def _list_rows(case: CaseResult) -> Iterator[list[Any]]:
    """One row per quantity, or per item of a quantity with several values."""
    rows = [row for row in case.criteria if not row.is_drift]
    graded = {(str(row.pantograph), row.quantity, row.item): row for row in rows}
    for key, quantities in case.quantities.items():
        for name, value in quantities.items():
            for item, number in enumerate(value, 1) if isinstance(value, list) else ((None, value),):
                components = case.uncertainty_components.get(key, {}).get(name, {})
                widths = (case.uncertainty.get(key, {}).get(name), *map(components.get, COMPONENT_NAMES))
                criterion = graded.get((key, name, item))
                yield [
                    *(case.id, key, name, "" if item is None else item, number, quantity_unit(name)),
                    *(_select_item(width, item) for width in widths),
                    *map(_blank, (criterion and criterion.lower, criterion and criterion.upper)),
                    "" if criterion is None else criterion.verdict,
                    "; ".join(case.changes),
                ]


def _select_item(width: float | list[float] | None, item: int | None) -> float | str:
    if isinstance(width, list):
        return width[item - 1] if item is not None and item <= len(width) else NOT_KNOWN
    return NOT_KNOWN if width is None else width


def _blank(value: object) -> object:
    return "" if value is None else value

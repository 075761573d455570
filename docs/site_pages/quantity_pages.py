"""Reference of the quantities, from the registry."""

from itertools import groupby

from pantocheck.conformance.quantities.quantity import Quantity
from pantocheck.conformance.quantities.registry import QUANTITIES
from site_pages.markdown_table import build_markdown_table, escape_text

SCOPES = {
    "pantograph": "Of a pantograph",
    "line": "Of the line during a passage",
    "static": "Of the line at rest",
    "mass_drop": "Of a mass drop",
    "study": "Of a study",
}


def build_quantity_page() -> str:
    """Page with the definition of every quantity, by the object that it belongs to."""
    parts = ["# Quantities", "A criterion is one of these names with a limit."]
    ordered = sorted(QUANTITIES.values(), key=lambda quantity: list(SCOPES).index(quantity.scope))
    for scope, group in groupby(ordered, key=lambda quantity: quantity.scope):
        rows = [_describe_quantity(quantity) for quantity in group]
        headings = ("name", "unit", "definition", "needs", "source")
        parts += [f"## {SCOPES[scope]}", build_markdown_table(headings, rows)]
    return "\n\n".join(parts) + "\n"


def _describe_quantity(quantity: Quantity) -> tuple[str, ...]:
    texts = (quantity.unit or "-", f"{quantity.label}. {quantity.definition}", quantity.needs.text, quantity.source)
    return (f"`{quantity.name}`", *map(escape_text, texts))

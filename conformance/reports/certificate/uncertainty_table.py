"""Table of the uncertainty of every quantity by component."""

from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.certificate.quantity_tables import list_owners
from pantocheck.conformance.reports.page_text import format_value
from pantocheck.conformance.reports.words import name_pantograph, quantity_label, quantity_unit
from pantocheck.conformance.results.criterion_format import ComponentName
from pantocheck.conformance.results.incomplete_uncertainty import list_unknown, mark_half_width
from pantocheck.conformance.results.results_format import CaseResult

UNCERTAINTY_KEY = (
    "Uncertainties are half-widths of 95 % intervals. The combined one is the root of the sum of the squares of the "
    "components. A dash: the component does not apply to the quantity, or is not known. A quantity with several values "
    "has the largest of its half-widths. An asterisk marks a half-width that lacks a component that is not known."
)
"""Meaning of the uncertainties by component of all cases."""


def uncertainty_blocks(case: CaseResult) -> tuple[doc.Block, ...]:
    """Basis of each component, model uncertainty, and the half-widths of all quantities of a case."""
    names = list(case.uncertainty_basis)
    basis = tuple(f"{name.capitalize()}: {text}." for name, text in case.uncertainty_basis.items())
    basis += tuple(f"Model, not part of the combined width: {sentence}" for sentence in case.model_uncertainty)
    rows = tuple(_row(case, key, name, names) for key in list_owners(case) for name in _quantities(case, key))
    if not rows:
        return (doc.SmallPrint(" ".join(basis)),)
    numbers = ("Combined", *(name.capitalize() for name in names))
    columns = (
        doc.Column("Quantity", share=1),
        doc.Column("Of"),
        doc.Column("Unit"),
        *(doc.Column(heading, number=True, short=SHORT_COMPONENTS.get(heading, "")) for heading in numbers),
    )
    return (doc.BulletList(basis), doc.Table(columns, rows))


SHORT_COMPONENTS = {"Discretisation": "Discr."}
"""Headings of components on paper."""


def _quantities(case: CaseResult, key: str) -> list[str]:
    """Quantities of an owner with a known component, in the order of the registry."""
    order = list(QUANTITIES)
    known = case.uncertainty_components.get(key, {})
    return sorted(known, key=lambda name: (order.index(name) if name in order else len(order), name))


def _row(case: CaseResult, key: str, quantity: str, names: list[ComponentName]) -> tuple[doc.RichText, ...]:
    components = case.uncertainty_components[key][quantity]
    widths = [_format_largest(components.get(name)) for name in names]
    combined = case.uncertainty[key][quantity]
    largest = max(combined, default=0.0) if isinstance(combined, list) else combined
    marked = mark_half_width(largest, _format_largest(combined), list_unknown(case.uncertainty_basis))
    label = (f"{quantity_label(quantity)} ", doc.Code(quantity))
    return (label, name_pantograph(key), quantity_unit(quantity) or "–", marked, *widths)


def _format_largest(width: float | list[float] | None) -> str:
    """Largest half-width of the items of a quantity; a dash without one."""
    return format_value(max(width, default=None) if isinstance(width, list) else width, 2)

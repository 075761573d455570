"""Registry of all quantities by name. A criterion is one of these names with limits."""

from pantocheck.conformance.quantities.delivered_quantities import DELIVERED_QUANTITIES
from pantocheck.conformance.quantities.force_quantities import LINE_QUANTITIES, PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.quantity import Quantity, QuantityTable
from pantocheck.conformance.quantities.stated_quantities import STATED_QUANTITIES
from pantocheck.conformance.quantities.stretch_quantities import OVERLAP_QUANTITIES

QUANTITIES: dict[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        *PANTOGRAPH_QUANTITIES,
        *STATED_QUANTITIES,
        *OVERLAP_QUANTITIES,
        *LINE_QUANTITIES,
        *DELIVERED_QUANTITIES,
    )
}
"""All quantities, in the order of reports."""


def unit_of(name: str) -> str:
    """Unit of a quantity; empty if it is not known, as in a baseline of another version."""
    return QUANTITIES[name].unit if name in QUANTITIES else ""


def table_quantities(table: QuantityTable) -> list[str]:
    """Names of the quantities in a fixed table, in the order of reports."""
    return [quantity.name for quantity in QUANTITIES.values() if table in quantity.tables]

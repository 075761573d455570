"""Registry of all quantities by name. A criterion is one of these names with limits."""

from pantocheck.conformance.quantities.delivered_quantities import DELIVERED_QUANTITIES
from pantocheck.conformance.quantities.force_quantities import LINE_QUANTITIES, PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.plug_in_quantity import find_own_quantity
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


def find_quantity(name: str) -> Quantity | None:
    """Quantity of the suite, or of another distribution, by name; None if there is none.

    Raises
    ------
    InputError
        A quantity of another distribution cannot be loaded.
    """
    return QUANTITIES.get(name) or find_own_quantity(name)


def unit_of(name: str) -> str:
    """Unit of a quantity; empty if it is not known: a baseline can have quantities of an older registry."""
    quantity = find_quantity(name)
    return "" if quantity is None else quantity.unit


def table_quantities(table: QuantityTable) -> list[str]:
    """Names of the quantities in a fixed table, in the order of reports."""
    return [quantity.name for quantity in QUANTITIES.values() if table in quantity.tables]

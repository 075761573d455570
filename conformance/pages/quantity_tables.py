"""Tables of quantities: values of a case, uncertainties by component, and the list of all quantities as CSV."""

import csv
import io
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Any

from pantocheck.conformance.core.criterion import COMPONENT_NAMES, ComponentName
from pantocheck.conformance.pages.condition_sections import BAND_MARK, CONDITIONED, describe_condition
from pantocheck.conformance.pages.criteria_table import has_reference
from pantocheck.conformance.pages.document import Code, Column, RichText, Table, make_table
from pantocheck.conformance.pages.verdict_marks import list_criteria
from pantocheck.conformance.pages.words import format_value, name_pantograph, quantity_label, quantity_unit
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.results.incomplete_uncertainty import describe_half_width, list_unknown
from pantocheck.conformance.results.results_format import CaseResult, Quantities, Results
from pantocheck.conformance.results.supported_frequency import describe_supported

LONGEST_PRINTED_LIST = 5
"""Longest list that is printed in full; results.json has the values of a longer one."""


def list_owners(case: CaseResult) -> list[str]:
    """Keys of the quantities of a case: pantographs in running order, then the line as "0"."""
    keys = set(case.quantities) | set(case.skipped)
    return sorted(keys, key=lambda key: (key == "0", len(key), key))


def _format_list(values: list[float]) -> str:
    """Values separated by commas; of a long list its range."""
    if len(values) <= LONGEST_PRINTED_LIST:
        return ", ".join(format_value(number, 5) for number in values)
    return f"{len(values)} values, {format_value(min(values), 5)} to {format_value(max(values), 5)}"


def list_definitions(cases: Iterable[CaseResult]) -> tuple[RichText, ...]:
    """Definitions that depend on a choice of filter or band, with the change of the value by another choice."""
    shown = {name for case in cases for values in case.quantities.values() for name in values}
    return tuple(
        (Code(name), f": {quantity.definition}; {quantity.other_definition}.")
        for name, quantity in QUANTITIES.items()
        if name in shown and quantity.other_definition
    )


def list_skipped(case: CaseResult) -> tuple[str, ...]:
    """Skipped quantities with their reasons."""
    return tuple(
        f"{name_pantograph(key).capitalize()}, {quantity_label(quantity)}: {reason}"
        for key in list_owners(case)
        for quantity, reason in sorted(case.skipped.get(key, {}).items())
    )


# Table of all quantities with their uncertainty by component.
ABOVE = "above"
"""Cell of a value that the table of criteria has."""

UNCERTAINTY_KEY = (
    "The columns behind the uncertainty show each component alone; one that is zero or not known for all quantities "
    "has no column. Start and section are largest changes with a factor, and the joint sample takes them as "
    "alternatives, not as a sum: a component can exceed the uncertainty. How often an interval contains the truth is "
    "stated with its component. A dash: it does not apply to the quantity, or is not known. A quantity with several "
    "values has the largest of its half-widths. "
    f"'{ABOVE}': in the table of criteria. 'exact': a closed form, without mesh and time step."
)
"""Meaning of the uncertainties by component of all cases."""

SHIFT_KEY = "Shift: largest change when the analysis section is shifted span by span, no part of the uncertainty."
"""Meaning of the column of shifts."""


def list_uncertainty_basis(case: CaseResult) -> tuple[str, ...]:
    """Sentences on the basis of each component, and on effects that the equations leave out."""
    names: dict[str, list[str]] = {}
    for name, text in case.uncertainty_basis.items():
        names.setdefault(text, []).append(name)
    basis = tuple(f"{', '.join(parts).capitalize()}: {text}." for text, parts in names.items())
    return basis + tuple(f"Model, not part of the uncertainty: {text}" for text in case.model_uncertainty)


QuantityKey = tuple[str, str]
"""Owner and name of a quantity."""


def build_quantity_table(case: CaseResult) -> Table:
    """Every quantity with its uncertainty by component and the value of the reference; graded values stand above."""
    keys = [(owner, name) for owner in list_owners(case) for name in _sort_quantities(case.quantities.get(owner, ()))]
    graded = {(str(row.pantograph), row.quantity) for row in list_criteria(case, "criteria") if row.item is None}
    missing = list_unknown(case.uncertainty_basis)

    def format_uncertainty(key: QuantityKey) -> str:
        width = _find_largest(case.uncertainty.get(key[0], {}).get(key[1]))
        return "–" if width is None else describe_half_width(width, format_value(width, 2), missing, key[1])

    columns: dict[Column, Callable[[QuantityKey], RichText]] = {
        Column("Quantity", share=2): lambda key: (f"{quantity_label(key[1])} ", Code(key[1])),
        Column("Pantograph", number=True, short="Pant."): lambda key: name_pantograph(key[0]).removeprefix(
            "pantograph "
        ),
        Column("Unit"): lambda key: quantity_unit(key[1]) or "–",
        Column("Value", share=1, number=True): lambda key: (
            ABOVE if key in graded else _format_quantity(case.quantities, key)
        ),
    }
    if case.reference is not None and has_reference(case):
        columns[Column("Reference", number=True)] = partial(_format_quantity, case.reference.quantities)
    if case.uncertainty_basis:
        columns[Column("Uncertainty", number=True)] = lambda key: ABOVE if key in graded else format_uncertainty(key)
    for component in case.uncertainty_basis:
        find_width = partial(_find_component, case, component)
        if any(map(find_width, keys)):
            heading = component.capitalize()
            column = Column(heading, number=True, short=SHORT_COMPONENTS.get(heading, ""))
            columns[column] = partial(_format_width, find_width)
    if case.supported:
        columns[Column("Supported", number=True)] = lambda key: describe_supported(case.supported, key[0])
    if any(case.spread.values()):
        columns[Column("Shift", number=True)] = lambda key: format_value(case.spread.get(key[0], {}).get(key[1]), 2)
    return make_table(keys, columns)


SHORT_COMPONENTS = {"Discretisation": "Discr."}
"""Headings of components on paper."""


def _format_quantity(quantities: Quantities, key: QuantityKey) -> str:
    value = quantities.get(key[0], {}).get(key[1])
    return _format_list(value) if isinstance(value, list) else format_value(value, 5)


def _find_component(case: CaseResult, component: ComponentName, key: QuantityKey) -> float | None:
    return _find_largest(case.uncertainty_components.get(key[0], {}).get(key[1], {}).get(component))


def _format_width(find_width: Callable[[QuantityKey], float | None], key: QuantityKey) -> str:
    return format_value(find_width(key), 2)


def _sort_quantities(names: Iterable[str]) -> list[str]:
    """Names in the order of the registry, then unknown ones."""
    order = {name: place for place, name in enumerate(QUANTITIES)}
    return sorted(names, key=lambda name: (order.get(name, len(order)), name))


def _find_largest(width: float | list[float] | None) -> float | None:
    """Largest half-width of the items of a quantity; None without one."""
    return max(width, default=None) if isinstance(width, list) else width


# All quantities as comma-separated values: value, uncertainty by component, limits, verdict, condition, input changes.
COLUMNS = (
    *("case", "pantograph", "quantity", "item", "value", "unit", "uncertainty"),
    *COMPONENT_NAMES,
    *("lower", "upper", "verdict", "condition", "changes", "supported"),
)
NOT_KNOWN = "NA"
"""Cell of a value that is not known: it is not zero."""


def render_quantity_list(results: Results) -> str:
    """Table of all quantities of a run; numbers have all their digits."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(row for case in results.cases for row in list_quantity_rows(case))
    return text.getvalue()


def list_quantity_rows(case: CaseResult) -> Iterator[list[Any]]:
    """One row per quantity, or per item of a quantity with several values."""
    rows = [row for row in case.criteria if not row.is_drift]
    graded = {(str(row.pantograph), row.quantity, row.item): row for row in rows}
    condition = describe_condition(case).removeprefix(f"{BAND_MARK} ")
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
                    condition if name == CONDITIONED else "",
                    "; ".join(case.changes),
                    describe_supported(case.supported, key) if case.supported else "",
                ]


def _select_item(width: float | list[float] | None, item: int | None) -> float | str:
    if isinstance(width, list):
        return width[item - 1] if item is not None and item <= len(width) else NOT_KNOWN
    return NOT_KNOWN if width is None else width


def _blank(value: object) -> object:
    return "" if value is None else value

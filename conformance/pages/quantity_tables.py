"""Tables of quantities: values of a case, uncertainties by component, and the list of all quantities as CSV."""

import csv
import io
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

from pantocheck.conformance.core.criterion import COMPONENT_NAMES, ComponentName
from pantocheck.conformance.core.results_part import select_single
from pantocheck.conformance.pages.criteria_table import has_reference
from pantocheck.conformance.pages.document import Block, BulletList, Code, Column, Drawing, RichText, SmallPrint, Table
from pantocheck.conformance.pages.two_verdicts import list_criteria
from pantocheck.conformance.pages.words import (
    format_value,
    name_pantograph,
    name_verdict,
    quantity_label,
    quantity_unit,
)
from pantocheck.conformance.quantities.registry import QUANTITIES, list_table_quantities
from pantocheck.conformance.results.case_facts_format import ReferenceValues
from pantocheck.conformance.results.incomplete_uncertainty import list_unknown, mark_half_width
from pantocheck.conformance.results.results_format import CaseResult, Results

BAND_CAPTION = (
    "Standard deviation, coefficient of variation and RMS by band. Each value has its verdict by the EN 50318 "
    "criteria, and by verification where the converged solution limits it."
)

LONGEST_PRINTED_LIST = 10
"""Longest list that is printed in full; a longer one is drawn, and results.json has its values."""


def list_owners(case: CaseResult) -> list[str]:
    """Keys of the quantities of a case: pantographs in running order, then the line as "0"."""
    keys = set(case.quantities) | set(case.skipped)
    return sorted(keys, key=lambda key: (key == "0", len(key), key))


def build_band_table(case: CaseResult) -> Table:
    """Quantities of the bands up to 50 Hz with their verdicts; empty if none of them is graded."""

    def cell(quantity: str, key: str) -> str:
        value = case.quantities.get(key, {}).get(quantity)
        if value is None:
            return "not available"
        return f"{format_value(select_single(value))} ({'; '.join(_list_verdicts(case, quantity, key))})"

    rows = (*list_criteria(case, "criteria"), *list_criteria(case, "verification"))
    graded = any(row.quantity in list_table_quantities("bands") for row in rows)
    pantographs = [key for key in list_owners(case) if key != "0" and graded]
    cells: dict[str, Callable[[str], RichText]] = {
        name_pantograph(key).capitalize(): partial(cell, key=key) for key in pantographs
    }
    return _table(list_table_quantities("bands") if pantographs else (), cells, BAND_CAPTION)


def _list_verdicts(case: CaseResult, quantity: str, key: str) -> Iterator[str]:
    """Verdict of a quantity by the criteria, or the reason why it has none, and its verdict by verification."""
    criteria, verification = (
        [row.verdict for row in list_criteria(case, name)
         if (row.quantity, str(row.pantograph), row.baseline) == (quantity, key, None)]
        for name in ("criteria", "verification")
    )  # fmt: skip
    found = criteria[0] if criteria else None
    yield "no published limit" if found is None else "limit does not count" if found == "info" else name_verdict(found)
    yield from (f"verification {name_verdict(verdict)}" for verdict in verification)


def build_quantity_table(case: CaseResult) -> Table:
    """Every quantity of a case, beside that of the reference; a quantity that a pantograph does not have is a dash."""
    keys = list_owners(case)
    names = {name for key in keys for name in (*case.quantities.get(key, {}), *case.skipped.get(key, {}))}

    def cell(quantity: str, key: str, values: CaseResult | ReferenceValues) -> RichText:
        value = values.quantities.get(key, {}).get(quantity)
        if value is None:
            skipped = isinstance(values, CaseResult) and quantity in values.skipped.get(key, {})
            return "skipped" if skipped else "–"
        error = values.uncertainty.get(key, {}).get(quantity)
        if isinstance(value, list):
            return _format_list(value)
        text = format_value(value, 5)
        if error is None or isinstance(error, list):
            return text
        missing = list_unknown(values.uncertainty_basis) if isinstance(values, CaseResult) else ()
        return f"{text} {mark_half_width(error, format_value(error, 2), missing, '± ')}"

    cells: dict[str, Callable[[str], RichText]] = {}
    for key in keys:
        name = name_pantograph(key)
        cells[name.capitalize()] = partial(cell, key=key, values=case)
        if case.reference is not None and has_reference(case):
            cells[f"Reference, {name}"] = partial(cell, key=key, values=case.reference)
    return _table(_sort_quantities(names), cells)


def _format_list(values: list[float]) -> RichText:
    """Values separated by commas; of a long list a drawing with its range."""
    if len(values) <= LONGEST_PRINTED_LIST:
        return ", ".join(format_value(number, 5) for number in values)
    text = f"{len(values)} values, {format_value(min(values), 5)} to {format_value(max(values), 5)}"
    return Drawing(draw_spark_line(values), text), f" {text}"


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


def _table(quantities: Iterable[str], cells: Mapping[str, Callable[[str], RichText]], caption: str = "") -> Table:
    """One row per quantity; one column per heading, with the function of its values."""
    share = 1 if len(cells) > 1 else 2
    columns = (Column(heading, share=share, number=True) for heading in cells)
    rows = tuple(
        (_label(name), quantity_unit(name) or "–", *(cell(name) for cell in cells.values())) for name in quantities
    )
    return Table((Column("Quantity", share=2.4), Column("Unit"), *columns), rows, caption)


# Table of the uncertainty of every quantity by component.
UNCERTAINTY_KEY = (
    "Uncertainties are half-widths of 95 % intervals. The combined one is the root of the sum of the squares of the "
    "components. A dash: the component does not apply to the quantity, or is not known. A quantity with several values "
    "has the largest of its half-widths. An asterisk marks a half-width that lacks a component that is not known."
)
"""Meaning of the uncertainties by component of all cases."""


def uncertainty_blocks(case: CaseResult) -> tuple[Block, ...]:
    """Basis of each component, model uncertainty, and the half-widths of all quantities of a case."""
    names = list(case.uncertainty_basis)
    basis = tuple(f"{name.capitalize()}: {text}." for name, text in case.uncertainty_basis.items())
    basis += tuple(f"Model, not part of the combined width: {sentence}" for sentence in case.model_uncertainty)
    components = case.uncertainty_components
    rows = tuple(
        _row(case, key, name, names) for key in list_owners(case) for name in _sort_quantities(components.get(key, ()))
    )
    if not rows:
        return (SmallPrint(" ".join(basis)),)
    numbers = ("Combined", *(name.capitalize() for name in names))
    columns = (
        Column("Quantity", share=1),
        Column("Of"),
        Column("Unit"),
        *(Column(heading, number=True, short=SHORT_COMPONENTS.get(heading, "")) for heading in numbers),
    )
    return (BulletList(basis), Table(columns, rows))


SHORT_COMPONENTS = {"Discretisation": "Discr."}
"""Headings of components on paper."""


def _sort_quantities(names: Iterable[str]) -> list[str]:
    """Names in the order of the registry, then unknown ones."""
    order = {name: place for place, name in enumerate(QUANTITIES)}
    return sorted(names, key=lambda name: (order.get(name, len(order)), name))


def _label(quantity: str) -> RichText:
    return f"{quantity_label(quantity)} ", Code(quantity)


def _row(case: CaseResult, key: str, quantity: str, names: list[ComponentName]) -> tuple[RichText, ...]:
    components = case.uncertainty_components[key][quantity]
    widths = [_format_largest(components.get(name)) for name in names]
    combined = case.uncertainty[key][quantity]
    largest = max(combined, default=0.0) if isinstance(combined, list) else combined
    marked = mark_half_width(largest, _format_largest(combined), list_unknown(case.uncertainty_basis))
    return (_label(quantity), name_pantograph(key), quantity_unit(quantity) or "–", marked, *widths)


def _format_largest(width: float | list[float] | None) -> str:
    """Largest half-width of the items of a quantity; a dash without one."""
    return format_value(max(width, default=None) if isinstance(width, list) else width, 2)


# A list of values drawn as a small curve without axes: its shape beside its range in words.
WIDTH, HEIGHT = 100.0, 18.0
INSET = 2.0
"""Distance of the extremes from the edges."""


def draw_spark_line(values: Sequence[float]) -> str:
    """SVG of at least two values at equal distances, from the lowest to the highest over the height of the drawing."""
    low, high = min(values), max(values)
    size = (HEIGHT - 2 * INSET) / (high - low) if high > low else 0.0
    step = (WIDTH - 2 * INSET) / (len(values) - 1)
    points = " ".join(f"{INSET + n * step:.2f},{HEIGHT - INSET - (y - low) * size:.2f}" for n, y in enumerate(values))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" width="{WIDTH:g}" '
        f'height="{HEIGHT:g}"><polyline points="{points}" fill="none" stroke="#1a1d21" stroke-width="1.2"/></svg>'
    )


# List of all quantities as comma-separated values: value, uncertainty by component, limits, verdict, input changes.
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

"""Tables of quantities: one row per quantity, one column per pantograph."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial

from pantocheck.conformance.quantities.registry import QUANTITIES, table_quantities
from pantocheck.conformance.reports.certificate.reference_values import has_reference
from pantocheck.conformance.reports.certificate.two_verdicts import list_criteria
from pantocheck.conformance.reports.document import Code, Column, Drawing, RichText, Table
from pantocheck.conformance.reports.figures.spark_line import draw_spark_line
from pantocheck.conformance.reports.page_text import format_value
from pantocheck.conformance.reports.words import name_pantograph, quantity_label, quantity_unit, read_words
from pantocheck.conformance.results.incomplete_uncertainty import list_unknown, mark_half_width
from pantocheck.conformance.results.reference_format import ReferenceValues
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.results.results_part import select_single

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
    graded = any(row.quantity in table_quantities("bands") for row in rows)
    pantographs = [key for key in list_owners(case) if key != "0" and graded]
    cells: dict[str, Callable[[str], RichText]] = {
        name_pantograph(key).capitalize(): partial(cell, key=key) for key in pantographs
    }
    return _table(table_quantities("bands") if pantographs else (), cells, BAND_CAPTION)


def _list_verdicts(case: CaseResult, quantity: str, key: str) -> Iterator[str]:
    """Verdict of a quantity by the criteria, or the reason why it has none, and its verdict by verification."""
    words = {verdict: entry["word"] for verdict, entry in read_words()["verdict"].items()}
    criteria, verification = (
        [row.verdict for row in list_criteria(case, name)
         if (row.quantity, str(row.pantograph), row.baseline) == (quantity, key, None)]
        for name in ("criteria", "verification")
    )  # fmt: skip
    yield (words | {"none": "no published limit", "info": "limit does not count"})[criteria[0] if criteria else "none"]
    yield from (f"verification {words[verdict]}" for verdict in verification)


def build_quantity_table(case: CaseResult) -> Table:
    """Every quantity of a case, beside that of the reference; a quantity that a pantograph does not have is a dash."""
    keys = list_owners(case)
    order = list(QUANTITIES)
    names = {name for key in keys for name in (*case.quantities.get(key, {}), *case.skipped.get(key, {}))}
    ordered = sorted(names, key=lambda name: (order.index(name) if name in order else len(order), name))

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
    return _table(ordered, cells)


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
    rows: list[tuple[RichText, ...]] = []
    for name in quantities:
        label = (f"{quantity_label(name)} ", Code(name))
        rows.append((label, quantity_unit(name) or "–", *(cell(name) for cell in cells.values())))
    return Table((Column("Quantity", share=2.4), Column("Unit"), *columns), tuple(rows), caption)

"""Workbook of a run: verdicts, criteria, quantities with their units in the head, and uncertainties by component."""

from collections.abc import Iterator, Sequence

from pantocheck.conformance.core.criterion import COMPONENT_NAMES, Criterion
from pantocheck.conformance.core.workbook_writing import CellContent, SheetColumn, WrittenSheet, write_workbook
from pantocheck.conformance.pages.quantity_tables import COLUMNS, list_owners, list_quantity_rows
from pantocheck.conformance.pages.verdict_marks import list_criteria
from pantocheck.conformance.pages.words import quantity_label, quantity_unit
from pantocheck.conformance.results.results_format import Results, name_case

PART_COLUMNS = ("case", "pantograph", "quantity", "item", "unit", "value", "uncertainty", *COMPONENT_NAMES)
"""Columns of the sheet of uncertainties, among those of the list of quantities; half-widths of 95 % intervals."""


def render_workbook(results: Results) -> bytes:
    """XLSX file with the numbers of a run in all their digits."""
    parts = _build_sheet("uncertainty", PART_COLUMNS, list(_list_parts(results)))
    return write_workbook((_build_verdicts(results), _build_criteria(results), _build_quantities(results), parts))


def _build_sheet(name: str, head: Sequence[str], rows: list[list[CellContent]]) -> WrittenSheet:
    return WrittenSheet(name, tuple(map(SheetColumn, head)), rows)


def _build_verdicts(results: Results) -> WrittenSheet:
    """Run, then its cases."""
    head = ("case", "title", "verdict", "criteria verdict", "verification verdict", "reason", "input", "limits")
    system = f"{results.system.name} {results.system.version}".strip()
    total: list[CellContent] = ["all", f"{system}; {results.statement}", results.verdict, results.criteria_verdict]
    rows = [[*total, results.verification_verdict, *[None] * 3]]
    for case in results.cases:
        verification = None if case.verification is None else case.verification.verdict
        verdicts = (case.verdict, case.criteria_verdict, verification)
        names = (name_case(case.id, case.library), case.title)
        rows.append([*names, *verdicts, case.reason, case.input_digest, case.limits_digest])
    return _build_sheet("verdicts", head, rows)


def _build_criteria(results: Results) -> WrittenSheet:
    """Criteria of both verdicts."""
    head = (
        *("case", "by", "pantograph", "quantity", "item", "unit", "value", "lower limit", "upper limit"),
        *("uncertainty", "probability inside", "verdict", "margin", "trust", "source", "remarks"),
    )
    rows = [
        [case.id, kind, *_list_cells(row)]
        for case in results.cases
        for kind in ("criteria", "verification")
        for row in list_criteria(case, kind)
    ]
    return _build_sheet("criteria", head, rows)


def _list_cells(row: Criterion) -> list[CellContent]:
    numbers = (row.value, row.lower, row.upper, row.uncertainty, row.conformity)
    remarks = "; ".join(filter(None, (row.reason, *row.close, *row.readings, row.doubt)))
    owner = (row.pantograph, quantity_label(row.quantity), row.item, row.unit)
    return [*owner, *numbers, row.verdict, row.margin, row.trust, row.source, remarks]


def _build_quantities(results: Results) -> WrittenSheet:
    """One row per case and pantograph (0: the line), one column per quantity or item of it."""
    values: dict[tuple[str, str], dict[str, CellContent]] = {}
    heads: dict[str, None] = {}
    for case in results.cases:
        for owner in list_owners(case):
            for name, value in case.quantities.get(owner, {}).items():
                for item, number in enumerate(value, 1) if isinstance(value, list) else ((None, value),):
                    head = _name_column(name, item)
                    heads[head] = None
                    values.setdefault((case.id, owner), {})[head] = number
    rows = [[case, int(owner), *map(found.get, heads)] for (case, owner), found in values.items()]
    return _build_sheet("quantities", ("case", "pantograph", *heads), rows)


def _name_column(name: str, item: int | None) -> str:
    """Quantity with its item and unit: `mean force [N]`, `uplift at supports 2 [m]`."""
    unit = quantity_unit(name)
    parts = (quantity_label(name), "" if item is None else str(item), f"[{unit}]" if unit else "")
    return " ".join(filter(None, parts))


def _list_parts(results: Results) -> Iterator[list[CellContent]]:
    """Uncertainties by component."""
    places, quantity = [COLUMNS.index(name) for name in PART_COLUMNS], COLUMNS.index("quantity")
    for case in results.cases:
        for row in list_quantity_rows(case):
            yield [quantity_label(row[place]) if place == quantity else row[place] for place in places]

"""Tables of quantities: one row per quantity, one column per pantograph."""

from typing import Any

from pantocheck.conformance.quantities.registry import QUANTITIES, table_quantities
from pantocheck.conformance.reports.certificate.page_content import QuantityTable
from pantocheck.conformance.reports.page_text import format_value
from pantocheck.conformance.reports.words import holder, quantity_label, quantity_unit, read_words


def columns(case: dict[str, Any]) -> list[str]:
    """Keys of whatever has quantities: pantographs in running order, then the line as "0"."""
    keys = set(case["quantities"]) | set(case["skipped"])
    return sorted(keys, key=lambda key: (key == "0", len(key), key))


def heading(key: str) -> str:
    """Name of a column."""
    return holder(key).capitalize()


def bands(case: dict[str, Any]) -> QuantityTable:
    """The extended band table: each cell with its verdict where graded, else marked informative."""
    pantographs = [key for key in columns(case) if key != "0"]
    graded = {
        (row["quantity"], str(row.get("pantograph"))): row["verdict"]
        for row in case["criteria"]
        if row["verdict"] != "info"
    }

    def cell(name: str, key: str) -> str:
        value = case["quantities"].get(key, {}).get(name)
        if value is None:
            return "not available"
        verdict = graded.get((name, key))
        return f"{format_value(value)} ({read_words()['verdict'][verdict]['word'] if verdict else 'informative'})"

    return QuantityTable(
        tuple(heading(key) for key in pantographs),
        tuple(
            (quantity_label(name), name, quantity_unit(name), tuple(cell(name, key) for key in pantographs))
            for name in table_quantities("bands")
        )
        if pantographs
        else (),
    )


def quantities(case: dict[str, Any]) -> QuantityTable:
    """Every quantity of a case; what is neither there nor skipped is left blank."""
    keys = columns(case)
    order = list(QUANTITIES)
    names = {name for key in keys for name in (*case["quantities"].get(key, {}), *case["skipped"].get(key, {}))}
    ordered = sorted(names, key=lambda name: (order.index(name) if name in order else len(order), name))

    def cell(name: str, key: str) -> str:
        value = case["quantities"].get(key, {}).get(name)
        if value is None:
            return "skipped" if name in case["skipped"].get(key, {}) else ""
        error = (case.get("uncertainty") or {}).get(key, {}).get(name)
        shown = ", ".join(format_value(one, 5) for one in (value if isinstance(value, list) else [value]))
        return shown if error is None else f"{shown} ± {format_value(error, 2)}"

    return QuantityTable(
        tuple(heading(key) for key in keys),
        tuple(
            (quantity_label(name), name, quantity_unit(name), tuple(cell(name, key) for key in keys))
            for name in ordered
        ),
    )


def skipped(case: dict[str, Any]) -> tuple[tuple[str, str, str], ...]:
    """What was skipped: whose, which quantity, why."""
    return tuple(
        (heading(key), quantity_label(name), reason)
        for key in columns(case)
        for name, reason in sorted(case["skipped"].get(key, {}).items())
    )

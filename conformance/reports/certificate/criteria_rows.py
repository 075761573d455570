"""Rows of the table of criteria."""

from typing import Any

from pantocheck.conformance.reports.certificate.page_content import CriterionRow
from pantocheck.conformance.reports.figures.margin_bar import draw_margin_bar
from pantocheck.conformance.reports.page_text import format_beside_limits, format_limits, format_value
from pantocheck.conformance.reports.words import owner, quantity_label, read_words


def build_criterion_row(row: dict[str, Any], sources: list[str]) -> CriterionRow:
    """One criterion of results.json as a row; its source is added to `sources` unless it is there."""
    value, lower, upper = row["value"], row["lower"], row["upper"]
    error, _ = total_error(row)
    shown = format_beside_limits(value, lower, upper)
    source = row.get("source") or None
    if source is not None and source not in sources:
        sources.append(source)
    limited = lower is not None or upper is not None
    drawn = value is not None and limited
    return CriterionRow(
        quantity=row["quantity"],
        label=criterion_title(row),
        pantograph=owner(row).removeprefix("pantograph "),
        value=shown,
        error="–" if error is None else f"± {format_value(error, 2)}",
        unit="" if value is None else row.get("unit") or "",
        limits=format_limits(lower, upper),
        margin="–" if row.get("margin") is None else format_signed(row["margin"]),
        bar=draw_margin_bar(value, lower, upper, error, row["verdict"]) if drawn else "",
        bar_text=f"{read_words()['verdict'][row['verdict']]['meaning']}: {shown}, limits {format_limits(lower, upper)}",
        verdict=row["verdict"],
        trust=row["trust"] if limited else "",
        source=None if source is None else sources.index(source) + 1,
        remarks=tuple(filter(None, (row.get("reason"), is_unresolved(row), shifted(row)))),
    )


def total_error(row: dict[str, Any]) -> tuple[float | None, str]:
    """How uncertain a value is, and what by: the length of a record, or the mesh and time step of a simulation."""
    if row.get("uncertainty") is not None:
        return row["uncertainty"], "uncertainty"
    return row.get("discretisation_error"), "discretisation error"


def criterion_title(row: dict[str, Any]) -> str:
    """What is graded: a quantity, or its drift from a baseline."""
    drift = "" if row.get("baseline") is None else ", drift from the baseline"
    return f"{quantity_label(row['quantity'])}{drift}"


def format_signed(margin: float) -> str:
    """A margin with its sign and two decimals, three or more where two would show no distance to the limit."""
    for decimals in range(2, 13):
        text = f"{margin:+.{decimals}f}"
        if margin == 0 or float(text) != 0:
            return "0.00" if margin == 0 else text.replace("-", "−")
    return f"{margin:+.1e}".replace("-", "−")


def is_unresolved(row: dict[str, Any]) -> str | None:
    """A remark if a value is closer to a limit than its discretisation error: refinement could turn the verdict."""
    value, (error, name) = row["value"], total_error(row)
    if value is None or not error or row["verdict"] not in ("pass", "fail") or row["lower"] == row["upper"]:
        return None
    distances = [abs(value - limit) for limit in (row["lower"], row["upper"]) if limit is not None]
    if distances and min(distances) < error:
        return f"closer to its limit than its {name}"
    return None


def shifted(row: dict[str, Any]) -> str | None:
    """A remark on how far a value moves with the stretch that is evaluated, where the case asks for it."""
    spread = row.get("spread")
    if spread is None or row["value"] is None:
        return None
    return (
        f"moves by up to {format_value(spread, 2)} {row.get('unit') or ''}".rstrip()
        + " when the evaluated stretch is shifted"
    )

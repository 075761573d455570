"""Section on the validation: computed values of the library cases against published ranges."""

from collections.abc import Iterator
from typing import Any

from pantocheck.conformance.core.figure_data import Chart, Series
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.study_chart import draw_chart
from pantocheck.conformance.pages.words import format_beside_limits, format_value, quantity_label, quantity_unit
from verification.guide.guide_format import INSIDE

VALIDATION_SCOPE = (
    "Every library case with published limits runs on the reference simulator of this version. The limits stand with "
    "their trust and source. A value inside its range reproduces the publication; it does not show that the "
    "publication describes a real line. Findings that were imposed on the inputs of a case are marked: meeting them "
    "counts nothing."
)

SCATTER_KEY = (
    "A point is the computed value against the middle of the published range, a bar is the range. A bar that crosses "
    "the line of equal values contains the computed value. A cross marks a value outside its range. Ranges with one "
    "bound stand in the tables only."
)

FAMILIES = {
    "en50318-2002/": "EN 50318:2002",
    "en50318-2018/ac-simple/": "2018, AC simple",
    "en50318-2018/ac-stitched/": "2018, AC stitched",
    "vovan2015/": "Vo Van 2015",
}
"""Families of cases by the start of their ids; other cases are a family of their own."""

FEWEST_RANGES = 3
"""Fewest points of a figure: fewer are read from the table."""

ROLES = {"imposed": ", imposed", "held_out": ", held out", "inferred": ", inferred"}


def build_validation_section(library: list[dict[str, Any]]) -> doc.Section:
    """Section with scatter plots and one table per case."""
    cases = [case for case in library if case["published"]]
    rows = [row for case in cases for row in case["published"]]
    inside = sum(row["verdict"] in INSIDE for row in rows)
    summary = (
        f"{inside} of {len(rows)} values lie inside their published range. "
        f"{_count(rows, 'primary')} of the ranges are of trust primary, {_count(rows, 'secondary')} secondary, "
        f"{_count(rows, 'provisional')} provisional."
    )
    figures = tuple(_draw_scatters(cases))
    return doc.Section(
        "Validation against published cases",
        (
            doc.Paragraph(VALIDATION_SCOPE),
            doc.Paragraph(summary),
            doc.Figures(figures),
            doc.SmallPrint(SCATTER_KEY),
            *map(_build_case, cases),
        ),
        anchor="validation",
    )


def _count(rows: list[dict[str, Any]], trust: str) -> int:
    return sum(row["trust"] == trust for row in rows)


def _build_case(case: dict[str, Any]) -> doc.Section:
    columns = (
        doc.Column("Quantity", share=3.0),
        doc.Column("Computed", number=True),
        doc.Column("Uncertainty", number=True),
        doc.Column("Published range"),
        doc.Column("Inside"),
        doc.Column("Trust"),
    )
    rows = tuple(_list_cells(row) for row in case["published"])
    edition = "" if case["edition"] is None else f" Edition: {case['edition']}."
    superseded = "" if case["superseded_by"] is None else f" Superseded by {case['superseded_by']}."
    sources = "; ".join(dict.fromkeys(row["source"] for row in case["published"]))
    return doc.Section(
        case["case"],
        (
            doc.Paragraph(f"{case['title']}.{edition}{superseded}"),
            doc.Table(columns, rows, layout="grid"),
            doc.SmallPrint(f"Source of the ranges: {sources}. Digest of the inputs: {case['input_digest']}."),
        ),
    )


def _list_cells(row: dict[str, Any]) -> tuple[doc.RichText, ...]:
    value, bounds = format_beside_limits(row["value"], row["lower"], row["upper"])
    role = ROLES[row["finding"]["role"]] if row["finding"] else ""
    return (
        _name_value(row) + role,
        value,
        format_value(row["uncertainty"], 2),
        bounds,
        "–" if row["value"] is None else "yes" if row["verdict"] in INSIDE else "no",
        doc.TrustMark(row["trust"]),
    )


def _name_value(row: dict[str, Any]) -> str:
    """Label with its unit, item and pantograph."""
    unit = quantity_unit(row["quantity"])
    item = "" if row["item"] is None else f" {row['item']}"
    pantograph = f", pantograph {row['pantograph']}" if row["pantograph"] > 1 else ""
    return f"{quantity_label(row['quantity'])}{item}{f' [{unit}]' if unit else ''}{pantograph}"


def _draw_scatters(cases: list[dict[str, Any]]) -> Iterator[doc.Figure]:
    """One figure per unit, for ranges with two bounds."""
    by_unit: dict[str, dict[str, list[dict[str, Any]]]] = {}
    for case in cases:
        family = next((name for start, name in FAMILIES.items() if case["case"].startswith(start)), case["case"])
        for row in case["published"]:
            if row["value"] is not None and row["lower"] is not None and row["upper"] is not None:
                named = row | {"case": case["case"]}
                by_unit.setdefault(quantity_unit(row["quantity"]), {}).setdefault(family, []).append(named)
    for unit, families in by_unit.items():
        if sum(map(len, families.values())) >= FEWEST_RANGES:
            yield _draw_scatter(unit or "-", families)


def _draw_scatter(unit: str, families: dict[str, list[dict[str, Any]]]) -> doc.Figure:
    rows = [row for family in families.values() for row in family]
    ends = [row[key] for row in rows for key in ("value", "lower", "upper")]
    low, high = min(ends), max(ends)
    margin = 0.05 * (high - low)
    series = [Series(label="equal values", style="line", x=[low, high], y=[low, high])]
    series += [
        Series(
            label=family,
            style="points",
            x=[row["value"] for row in points],
            y=[(row["lower"] + row["upper"]) / 2 for row in points],
            error=[(row["upper"] - row["lower"]) / 2 for row in points],
        )
        for family, points in families.items()
    ]
    outside = [row for row in rows if row["verdict"] == "fail"]
    if outside:
        x, y = [row["value"] for row in outside], [(row["lower"] + row["upper"]) / 2 for row in outside]
        series.append(Series(label="outside its range", style="crosses", x=x, y=y))
    labels = {"x_label": f"computed [{unit}]", "y_label": f"published [{unit}]"}
    chart = Chart(caption="", alternative="", **labels, series=series)
    inside = sum(row["verdict"] in INSIDE for row in rows)
    return doc.Figure(
        draw_chart(chart, (low - margin, high + margin)),
        f"{inside} of {len(rows)} published ranges in {unit} contain the computed value, from {format_value(low, 3)} "
        f"to {format_value(high, 3)} {unit}.{_list_outside(outside)}",
        f"Published against computed values [{unit}].{_list_outside(outside)}",
    )


def _list_outside(rows: list[dict[str, Any]]) -> str:
    """Sentence that names the values outside their range, by case."""
    by_case: dict[str, list[str]] = {}
    for row in rows:
        by_case.setdefault(row["case"], []).append(_name_value(row))
    cases = "; ".join(f"{case}: {', '.join(dict.fromkeys(names))}" for case, names in by_case.items())
    return f" Outside their range: {cases}." if rows else ""

"""Section on second formulations: values of this version beside stored converged values and the exact model."""

from typing import Any

from pantocheck.conformance.core.figure_data import Chart, Series
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.study_chart import draw_chart
from pantocheck.conformance.pages.words import format_plain, format_value, quantity_label, quantity_unit

FORMULATION_SCOPE = (
    "Two formulations of the equations share no code: finite elements with the method of Fox and Goodwin, and explicit "
    "finite differences. Their extrapolated values are stored with each case. The value of this version, with the "
    "default discretisation, stands beside them. The limits are those of the verification up to 50 Hz: the "
    "interval of both, widened by a tolerance."
)

EFFECT_SCOPE = (
    "A third model is geometrically exact in three dimensions: mass points joined by elastic wires and bars. It is too "
    "slow for this command. The table has the largest differences that its benchmark found; they are stored, not "
    "computed now."
)

DRAWN_QUANTITIES = ("std_force_N", "rms_0_5_N", "rms_5_20_N", "rms_20_50_N")
"""Quantities of the figure."""


def build_formulation_section(guide: dict[str, Any]) -> doc.Section:
    """Section with one table per case, a figure of the differences, and the exact model."""
    cases = [case for case in guide["library"] if case["converged"]]
    rows = [row for case in cases for row in case["converged"]]
    inside = sum(row["inside"] for row in rows)
    largest = max((abs(_difference_pct(row)) for row in _list_shown(cases)), default=0.0)
    summary = (
        f"{inside} of {len(rows)} values lie inside the limits of the verification. Standard deviation and bands "
        f"differ from the second formulation by at most {format_value(largest, 2)} %."
    )
    figure = (doc.Figures((_draw_differences(cases),)),) if list(_list_shown(cases)) else ()
    return doc.Section(
        "Second formulations",
        (
            doc.Paragraph(FORMULATION_SCOPE),
            doc.Paragraph(summary),
            *figure,
            *map(_build_case_table, cases),
            *_build_effects(guide["effects"]),
        ),
        anchor="formulations",
    )


def _list_shown(cases: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [row for case in cases for row in case["converged"] if row["quantity"] in DRAWN_QUANTITIES]


def _difference_pct(row: dict[str, Any]) -> float:
    """Value of this version minus that of the second formulation, relative to it [%]."""
    return float(100 * (row["value"] / row["second"] - 1)) if row["second"] else 0.0


def _build_case_table(case: dict[str, Any]) -> doc.Section:
    columns = (
        doc.Column("Quantity", share=2.0),
        doc.Column("Pantograph"),
        doc.Column("This version", number=True),
        doc.Column("Extrapolated", number=True),
        doc.Column("Second formulation", number=True),
        doc.Column("Difference", number=True),
        doc.Column("Limits", number=True),
        doc.Column("Inside"),
    )
    rows = tuple(
        (
            _name_quantity(row),
            str(row["pantograph"] or "line"),
            *(format_value(row[key], 5) for key in ("value", "first", "second")),
            format_value(row["value"] - row["second"], 2),
            f"{format_value(row['lower'], 5)} to {format_value(row['upper'], 5)}",
            "yes" if row["inside"] else "NO",
        )
        for row in case["converged"]
    )
    return doc.Section(case["case"], (doc.Table(columns, rows, layout="grid"),))


def _name_quantity(row: dict[str, Any]) -> str:
    unit = quantity_unit(row["quantity"])
    return f"{quantity_label(row['quantity'])}{f' [{unit}]' if unit else ''}"


def _draw_differences(cases: list[dict[str, Any]]) -> doc.Figure:
    passages = [case for case in cases if any(row["quantity"] in DRAWN_QUANTITIES for row in case["converged"])]
    names = [case["case"].removeprefix("en50318-") for case in passages]
    series = [
        Series(
            label=quantity_label(quantity),
            style="bars",
            x=list(range(len(passages))),
            y=[_largest_difference(case, quantity) for case in passages],
        )
        for quantity in DRAWN_QUANTITIES
    ]
    chart = Chart(caption="", alternative="", x_label="", y_label="difference [%]", ticks=names, series=series)
    largest = "; ".join(f"{name}: {format_value(max(s.y[k] for s in series), 2)} %" for k, name in enumerate(names))
    return doc.Figure(
        draw_chart(chart),
        f"Largest difference of each case over the pantographs and bands: {largest}.",
        "Largest difference of this version from the second formulation, of the pantographs of each case.",
    )


def _largest_difference(case: dict[str, Any], quantity: str) -> float:
    rows = [row for row in case["converged"] if row["quantity"] == quantity]
    return max((abs(_difference_pct(row)) for row in rows), default=0.0)


def _build_effects(effects: list[dict[str, Any]]) -> tuple[doc.Block, ...]:
    """Section on the exact model."""
    if not effects:
        return ()
    rows = tuple(
        (quantity_label(name), f"{format_plain(size)} {'%' if relative else quantity_unit(name)}", effect["effect"])
        for effect in effects
        for relative, sizes in ((True, effect["relative_pct"]), (False, effect["absolute"]))
        for name, size in sizes.items()
    )
    columns = (doc.Column("Quantity", share=2.0), doc.Column("Difference", number=True), doc.Column("Model", share=3.0))
    compared = " ".join(f"{effect['effect']}: {effect['compared']}." for effect in effects)
    compared += f" Source: {effects[0]['source']}."
    blocks = (doc.Paragraph(EFFECT_SCOPE), doc.Table(columns, rows), doc.SmallPrint(compared))
    return (doc.Section("Exact three-dimensional model", blocks),)

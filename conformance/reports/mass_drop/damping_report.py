"""Report on a damping fit, from damping.json."""

from typing import Any

from pantocheck.conformance.reports.document import (
    Block,
    CodeBlock,
    Document,
    Figure,
    Figures,
    Paragraph,
    PlainHeader,
    Section,
    Table,
    WarningBox,
    make_grid,
)
from pantocheck.conformance.reports.figures.damping_figures import draw_comparison, draw_observability
from pantocheck.conformance.reports.page_text import clean_tree, format_value

COEFFICIENT_UNITS = {"stiffness": "s", "mass": "1/s"}
RESULT = (
    "The block replaces [damping] in the line file. Mass coefficients multiply M, stiffness coefficients multiply K."
)
COMPARISON = "The line as it is has the damping of its present file."


def build_damping_document(results: dict[str, Any], block: str) -> Document:
    """The report.

    Parameters
    ----------
    results : dict
        damping.json as a dictionary.
    block : str
        The result as a TOML block for the line file.
    """
    results = clean_tree(results)
    observable = [row for row in results["observability"] if row["observable"]]
    kinds = dict.fromkeys(row["kind"].replace("_", " ") for row in observable)
    headline = (
        f"Rayleigh damping fitted to {len(results['pairs'])} modes leaves {100 * results['residual']:.2g} % "
        f"of their damping ratios. Observable: {', '.join(kinds) or 'nothing'}."
    )
    header = PlainHeader("Damping model from mass drops", headline)
    blocks: list[Block] = []
    if results["unpaired"]:
        frequencies = ", ".join(format_value(frequency) for frequency in results["unpaired"])
        blocks.append(WarningBox((f"measured modes without a counterpart in the model: {frequencies} Hz",)))
    blocks += [
        Section("Result", (Paragraph(RESULT), CodeBlock(block), _coefficients(results))),
        Section("Comparison", (Paragraph(COMPARISON), Figures((_comparison(results),)))),
        Section(
            "Observability",
            (
                Paragraph(describe_observability(results["thresholds"])),
                Figures((_observability_figure(results),)),
                _observability(results),
            ),
        ),
        Section("Pairs of modes", (_pairs(results),)),
    ]
    return Document(header.heading, header, tuple(blocks))


def describe_observability(thresholds: dict[str, float]) -> str:
    """Meaning of an observable coefficient, by the `thresholds` of damping.json."""
    return (
        "A coefficient is observable if its plausible value contributes at least "
        f"{100 * thresholds['largest_share']:g} % of the damping of some mode and is at least "
        f"{thresholds['plausible_over_std']:g} times its standard deviation. "
        "The standard deviation takes the coefficients of the wires as unknown as well."
    )


def _coefficients(results: dict[str, Any]) -> Table:
    rows = [
        (
            row["kind"].replace("_", " "),
            row["matrix"],
            f"{format_value(row['value'])} {COEFFICIENT_UNITS[row['matrix']]}",
            f"{format_value(row['low_95'], 3)} to {format_value(row['high_95'], 3)}",
        )
        for row in results["coefficients"]
    ]
    return make_grid("Coefficients", ("Component", "Multiplies", "Value", "95 % interval"), rows)


def _comparison(results: dict[str, Any]) -> Figure:
    return Figure(
        draw_comparison(results["comparison"]),
        "Damping ratio over frequency, measured and of the models; the pairs are in the table.",
        "Damping ratio: measured (95 % intervals), of the line as it is, of Rayleigh, and of Rayleigh + modal damping.",
    )


def _observability(results: dict[str, Any]) -> Table:
    rows = [
        (
            row["kind"].replace("_", " "),
            row["matrix"],
            format_value(100 * row["largest_share"], 3),
            format_value(row["std"], 2),
            format_value(row["plausible_over_std"], 3),
            format_value(row["variance_inflation"], 3),
            format_value(row["residual_without"], 3),
            "yes" if row["observable"] else "no",
        )
        for row in results["observability"]
    ]
    headings = (
        "Component",
        "Multiplies",
        "Share [%]",
        "Std",
        "Plausible / std",
        "Inflation",
        "Residual without",
        "Observable",
    )
    return make_grid("Information of the modes on each coefficient", headings, rows)


def _observability_figure(results: dict[str, Any]) -> Figure:
    return Figure(
        draw_observability(results["observability"], results["thresholds"]),
        "Bars of the numbers in the table; filled bars are observable.",
        "Observability: filled bars are observable, dashed lines are the thresholds.",
    )


def _pairs(results: dict[str, Any]) -> Table:
    rows = [
        (
            format_value(pair["measured_Hz"], 5),
            format_value(pair["computed_Hz"], 5),
            format_value(pair["mac"], 4),
            str(pair["group"]),
            format_value(100 * pair["measured"], 4),
            format_value(100 * pair["fitted"], 4),
            "yes" if pair["used"] else "no: outlier of its group",
        )
        for pair in results["pairs"]
    ]
    headings = ("Measured [Hz]", "Computed [Hz]", "MAC", "Group", "Measured ζ [%]", "Fitted ζ [%]", "Used")
    return make_grid("Measured modes and their computed counterparts", headings, rows)

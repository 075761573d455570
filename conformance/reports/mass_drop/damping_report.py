"""The report of a damping fit, from damping.json alone."""

from typing import Any

from pantocheck.conformance.identification.damping.observability import RATIO_NEEDED, SHARE_NEEDED
from pantocheck.conformance.reports.document import Document, Grid, Picture, Section
from pantocheck.conformance.reports.figures import mass_drop_figures as figures
from pantocheck.conformance.reports.page_text import format_value

COEFFICIENT_UNITS = {"stiffness": "s", "mass": "1/s"}


def build_damping_document(results: dict[str, Any], block: str) -> Document:
    """The report.

    Parameters
    ----------
    results : dict[str, Any]
        Of damping.json.
    block : str
        The TOML block of the result.
    """
    seen = [row for row in results["observability"] if row["observable"]]
    kinds = dict.fromkeys(row["kind"].replace("_", " ") for row in seen)
    headline = (
        f"Rayleigh damping fitted to {len(results['pairs'])} modes leaves {100 * results['residual']:.2g} % "
        f"of their damping ratios. Observable: {', '.join(kinds) or 'nothing'}."
    )
    without = ", ".join(format_value(f) for f in results["unpaired"])
    warnings = (f"measured modes without a counterpart in the line's model: {without} Hz",) if without else ()
    return Document(
        "Damping model from mass drops",
        headline,
        warnings,
        (
            Section("Result", texts=(RESULT,), code=block, grids=(_coefficients(results),)),
            Section("Comparison", texts=(COMPARISON,), pictures=(_comparison(results),)),
            Section("Observability", (OBSERVABILITY,), (_observability(results),), (_observability_picture(results),)),
            Section("Pairs of modes", grids=(_pairs(results),)),
        ),
    )


RESULT = (
    "The block takes the place of [damping] in the line file; mass coefficients multiply M, stiffness coefficients K."
)
COMPARISON = "Line as it is: with the damping its file has now."
OBSERVABILITY = (
    f"A coefficient is observable if its plausible value would make up at least {100 * SHARE_NEEDED:g} % of some "
    f"mode's damping and is at least {RATIO_NEEDED:g} times the standard deviation with which the modes determine it, "
    "the wires' coefficients being unknown too."
)


def _coefficients(results: dict[str, Any]) -> Grid:
    rows = [
        (
            c["kind"].replace("_", " "),
            c["matrix"],
            f"{format_value(c['value'])} {COEFFICIENT_UNITS[c['matrix']]}",
            f"{format_value(c['low_95'], 3)} to {format_value(c['high_95'], 3)}",
        )
        for c in results["coefficients"]
    ]
    return Grid(("Component", "Multiplies", "Value", "95 % interval"), tuple(rows), "Coefficients")


def _comparison(results: dict[str, Any]) -> Picture:
    return Picture(
        figures.draw_comparison(results["comparison"]),
        "Damping ratio over frequency, measured and of the models; the pairs are in the table.",
        "Damping ratio: measured (95 % intervals), of the line as it is, of Rayleigh, and of Rayleigh + modal damping.",
    )


def _observability(results: dict[str, Any]) -> Grid:
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
    heads = (
        "Component",
        "Multiplies",
        "Share [%]",
        "Std",
        "Plausible / std",
        "Inflation",
        "Residual without",
        "Observable",
    )
    return Grid(heads, tuple(rows), "What the modes tell of each coefficient")


def _observability_picture(results: dict[str, Any]) -> Picture:
    return Picture(
        figures.draw_observability(results["observability"]),
        "Bars of the numbers in the table; filled bars are observable.",
        "Observability: filled bars are observable, dashed lines are the thresholds.",
    )


def _pairs(results: dict[str, Any]) -> Grid:
    rows = [
        (
            format_value(p["measured_Hz"], 5),
            format_value(p["computed_Hz"], 5),
            format_value(p["mac"], 4),
            str(p["group"]),
            format_value(100 * p["measured"], 4),
            format_value(100 * p["fitted"], 4),
            "yes" if p["used"] else "no: outlier of its group",
        )
        for p in results["pairs"]
    ]
    heads = ("Measured [Hz]", "Computed [Hz]", "MAC", "Group", "Measured ζ [%]", "Fitted ζ [%]", "Used")
    return Grid(heads, tuple(rows), "Measured modes and their computed counterparts")

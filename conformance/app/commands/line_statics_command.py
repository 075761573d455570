"""`pantocheck line statics`: elasticities and contact wire heights measured along a line beside its model."""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import RenderableType

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.comparison_output import build_comparison_output, write_comparison_files
from pantocheck.conformance.app.commands.console import build_table, format_number
from pantocheck.conformance.app.commands.options import ElementOption, LineOption, read_line
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.comparison.static_comparison import build_tolerances, compare_statics
from pantocheck.conformance.comparison.static_record import read_static_record
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.files import check_writable, produce_atomically
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.results.comparison_format import ComparedValues, StaticComparison

ToleranceOption = float | None


def line_statics_command(
    table: Annotated[
        Path, typer.Argument(help=f"Table of the measured values, or its sidecar: {DocumentationPage.LINE_TABLES}.")
    ],
    line: LineOption,
    out: Annotated[Path, typer.Option(help="Folder for static_comparison.json, .html and .pdf, and a CSV per value.")],
    elasticity_tolerance: Annotated[
        ToleranceOption,
        typer.Option("--elasticity-tolerance-mm-N", help="Largest accepted difference of the elasticity.", min=0.0),
    ] = None,
    elasticity_tolerance_pct: Annotated[
        ToleranceOption,
        typer.Option("--elasticity-tolerance-pct", help="The same, relative to the measured elasticity.", min=0.0),
    ] = None,
    height_tolerance: Annotated[
        ToleranceOption,
        typer.Option("--height-tolerance-mm", help="Largest accepted difference of the contact wire height.", min=0.0),
    ] = None,
    element: ElementOption = 0.5,
) -> CommandOutput:
    """Compare measured static values with those of a line.

    A tolerance makes a criterion; without one, the differences are shown and not graded. No standard states a
    tolerance, so there is no default. A criterion is skipped if a part of the evaluated section was not measured.

    Example: pantocheck line statics measured.csv --line my-line.toml --out statics --height-tolerance-mm 10
    """
    tolerances = build_tolerances(
        {
            "elasticity_difference_mm_N": elasticity_tolerance,
            "elasticity_difference_pct": elasticity_tolerance_pct,
            "contact_wire_height_difference_mm": height_tolerance,
        }
    )
    line_file = read_line(line)
    record = read_static_record(table, line_file.geometry)
    check_writable(out)
    with follow_steps("line at rest"):
        comparison = compare_statics(record, line_file, element, tolerances)
        files = write_comparison_files(comparison, out / "static_comparison")
        files += [_write_differences(values, out / f"{values.name}.csv") for values in comparison.values]
    return build_comparison_output(comparison, [_tabulate_differences(comparison)], files)


def _write_differences(values: ComparedValues, path: Path) -> Path:
    unit = values.unit.replace("/", "_")
    names = ["row", "position_m", f"measured_{unit}", f"model_{unit}", f"difference_{unit}"]
    columns = (values.row, values.position_m, values.measured, values.model, values.difference)
    produce_atomically(path, lambda temporary: write_csv_table(temporary, names, np.column_stack(columns), 8))
    return path


def _tabulate_differences(comparison: StaticComparison) -> RenderableType:
    """Differences of all values."""
    numbers = ("mean", "RMS", "outliers", "missing")
    rows = (
        (
            values.name.replace("_", " "),
            values.unit,
            *(format_number(difference, 3) for difference in (values.mean_difference, values.rms_difference)),
            *(str(len(numbered)) for numbered in (values.outlier_rows, values.missing_rows)),
        )
        for values in comparison.values
    )
    return build_table("model - measured", "unit", *numbers, title="Evaluated section", right=numbers, rows=rows)

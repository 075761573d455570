"""`pantocheck line statics`: elasticities and contact wire heights measured along a line beside its model."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import RenderableType

from pantocheck.conformance.command_line.case_completion import complete_case
from pantocheck.conformance.command_line.command_output import CommandOutput
from pantocheck.conformance.command_line.console import (
    build_table,
    escape_text,
    format_number,
    indent_text,
    style_verdict,
)
from pantocheck.conformance.command_line.options import read_line
from pantocheck.conformance.command_line.progress_display import follow_steps
from pantocheck.conformance.command_line.results_output import EXIT_CODES
from pantocheck.conformance.comparison.static_comparison import compare_statics
from pantocheck.conformance.comparison.static_comparison_format import ComparedValues, StaticComparison
from pantocheck.conformance.comparison.static_record import read_static_record
from pantocheck.conformance.identification.rounded_model import write_model
from pantocheck.conformance.input_files.atomic_writing import check_writable, produce_atomically
from pantocheck.conformance.input_files.documentation_pages import DocumentationPage
from pantocheck.conformance.input_files.formats.csv_table import write_csv_table
from pantocheck.conformance.reports.comparison.static_comparison_page import (
    HEADLINES,
    build_static_comparison,
    list_remarks,
)
from pantocheck.conformance.reports.formats.report_writers import remark_missing_formats, write_document

ToleranceOption = float | None


def line_statics_command(
    table: Annotated[
        Path, typer.Argument(help=f"Table of the measured values, or its sidecar: {DocumentationPage.LINE_TABLES}.")
    ],
    line: Annotated[
        str,
        typer.Option(help="Measured line: id of a case, or path of a case or line file.", autocompletion=complete_case),
    ],
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
    element: Annotated[float, typer.Option(help="Element length [m].", min=0.05, max=5.0)] = 0.5,
) -> CommandOutput:
    """Compare measured static values with those of a line.

    A tolerance makes a criterion; without one, the differences are shown and not graded. No standard states a
    tolerance, so there is no default. A criterion is skipped if a part of the evaluated section was not measured.

    Example: pantocheck line statics measured.csv --line my-line.toml --out statics --height-tolerance-mm 10
    """
    tolerances = {
        "elasticity_difference_mm_N": elasticity_tolerance,
        "elasticity_difference_pct": elasticity_tolerance_pct,
        "contact_wire_height_difference_mm": height_tolerance,
    }
    line_file = read_line(line)
    record = read_static_record(table, line_file.geometry)
    check_writable(out)
    with follow_steps("line at rest"):
        given = {name: tolerance for name, tolerance in tolerances.items() if tolerance is not None}
        comparison = compare_statics(record, line_file, element, given)
        files = _write(comparison, out)
    return CommandOutput(
        style_verdict(comparison.verdict) + escape_text(f" {HEADLINES[comparison.verdict]}"),
        comparison,
        [*_describe_differences(comparison)],
        files=files,
        remarks=remark_missing_formats(),
        exit_code=EXIT_CODES[comparison.verdict],
    )


def _write(comparison: StaticComparison, folder: Path) -> list[Path]:
    """Write all files of a comparison; return their paths."""
    files = [folder / "static_comparison.json"]
    write_model(files[0], comparison)
    document = build_static_comparison(comparison.model_dump(mode="json", by_alias=True))
    files += write_document(document, folder / "static_comparison")
    for values in comparison.values:
        files.append(folder / f"{values.name}.csv")
        _write_differences(values, files[-1])
    return files


def _write_differences(values: ComparedValues, path: Path) -> None:
    unit = values.unit.replace("/", "_")
    names = ["row", "position_m", f"measured_{unit}", f"model_{unit}", f"difference_{unit}"]
    columns = (values.row, values.position_m, values.measured, values.model, values.difference)
    produce_atomically(path, lambda temporary: write_csv_table(temporary, names, np.column_stack(columns), 8))


def _describe_differences(comparison: StaticComparison) -> Iterator[RenderableType]:
    """Differences of all values, and criteria."""
    numbers = ("mean", "RMS", "outliers", "missing")
    table = build_table("model - measured", "unit", *numbers, title="Evaluated section", right=numbers)
    for values in comparison.values:
        table.add_row(
            values.name.replace("_", " "),
            values.unit,
            format_number(values.mean_difference, 3),
            format_number(values.rms_difference, 3),
            str(len(values.outlier_rows)),
            str(len(values.missing_rows)),
        )
    yield table
    if comparison.criteria:
        criteria = build_table("criterion", "value", "tolerance", "verdict", right=("value", "tolerance"))
        for item in comparison.criteria:
            verdict = style_verdict(item.verdict)
            criteria.add_row(item.quantity, format_number(item.value), format_number(item.tolerance), verdict)
        yield criteria
    for item in comparison.criteria:
        if item.reason:
            yield indent_text(f"{item.quantity}: {item.reason}")
    for remark in list_remarks(comparison.model_dump(mode="json")):
        yield indent_text(remark)

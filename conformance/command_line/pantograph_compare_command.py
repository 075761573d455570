"""`pantocheck pantograph compare`: frequency responses measured at a pantograph head beside those of its model."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType

from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.command_line.command_output import CommandOutput
from pantocheck.conformance.command_line.console import (
    build_table,
    escape_text,
    format_number,
    indent_text,
    style_verdict,
)
from pantocheck.conformance.command_line.progress_display import follow_steps
from pantocheck.conformance.command_line.results_output import EXIT_CODES
from pantocheck.conformance.comparison.response_comparison import compare_responses
from pantocheck.conformance.comparison.response_comparison_format import ResponseComparison
from pantocheck.conformance.comparison.response_deviation import ResponseQuantity
from pantocheck.conformance.comparison.response_limits import read_response_limits
from pantocheck.conformance.comparison.response_record import read_response
from pantocheck.conformance.identification.rounded_model import write_model
from pantocheck.conformance.input_files.atomic_writing import check_writable
from pantocheck.conformance.input_files.documentation_pages import DocumentationPage
from pantocheck.conformance.input_files.toml_file import read_model
from pantocheck.conformance.reports.comparison.response_comparison_page import (
    RESPONSE_HEADLINES,
    build_response_comparison,
    list_response_remarks,
    name_response_criterion,
)
from pantocheck.conformance.reports.formats.report_writers import remark_missing_formats, write_document

PRINTED_DEVIATIONS: tuple[ResponseQuantity, ...] = (
    "modulus_deviation_pct",
    "phase_deviation_deg",
    "complex_deviation_pct",
)


def pantograph_compare_command(
    responses: Annotated[
        list[Path],
        typer.Argument(
            help=f"Tables of measured responses, or their sidecars: {DocumentationPage.PANTOGRAPH_RESPONSE}."
        ),
    ],
    pantograph: Annotated[Path, typer.Option(help="Pantograph file.")],
    out: Annotated[Path, typer.Option(help="Folder for response_comparison.json, .html and .pdf.")],
    limits: Annotated[
        Path | None, typer.Option(help=f"File of limits: {DocumentationPage.PANTOGRAPH_RESPONSE}.")
    ] = None,
) -> CommandOutput:
    """Compare measured responses with a pantograph.

    A table holds frequency, modulus and phase of one measurement; give one per static force and height. Limits make
    criteria; without them, the deviations are shown and not graded.

    Example: pantocheck pantograph compare at-55N.csv at-70N.csv --pantograph my-pantograph.toml --out response
    """
    records = [read_response(path) for path in responses]
    model = read_model(pantograph, PantographFile, "pantograph")
    graded = None if limits is None else read_response_limits(limits)
    check_writable(out)
    with follow_steps("comparing"):
        comparison = compare_responses(records, model, graded)
        files = _write(comparison, out)
    return CommandOutput(
        style_verdict(comparison.verdict) + escape_text(f" {RESPONSE_HEADLINES[comparison.verdict]}"),
        comparison,
        [*_describe_deviations(comparison)],
        files=files,
        remarks=remark_missing_formats(),
        exit_code=EXIT_CODES[comparison.verdict],
    )


def _write(comparison: ResponseComparison, folder: Path) -> list[Path]:
    """Write all files of a comparison; return their paths."""
    files = [folder / "response_comparison.json"]
    write_model(files[0], comparison)
    document = build_response_comparison(comparison.model_dump(mode="json", by_alias=True))
    files += write_document(document, folder / "response_comparison")
    return files


def _describe_deviations(comparison: ResponseComparison) -> Iterator[RenderableType]:
    """RMS deviations of every band, criteria and warnings."""
    numbers = ("modulus %", "phase °", "complex %")
    table = build_table("response", "band", *numbers, title="RMS deviation of the model", right=numbers)
    for response in comparison.responses:
        for band in response.bands:
            if band.deviations:
                values = (format_number(band.deviations[key], 3) for key in PRINTED_DEVIATIONS)
                table.add_row(escape_text(response.name), f"{band.band_Hz[0]:g} to {band.band_Hz[1]:g} Hz", *values)
    yield table
    if comparison.criteria:
        criteria = build_table("criterion", "value", "limit", "verdict", right=("value", "limit"))
        for item in comparison.criteria:
            name, verdict = name_response_criterion(item.model_dump(mode="json")), style_verdict(item.verdict)
            criteria.add_row(escape_text(name), format_number(item.value), format_number(item.upper), verdict)
        yield criteria
    for item in comparison.criteria:
        if item.reason:
            yield indent_text(f"{name_response_criterion(item.model_dump(mode='json'))}: {item.reason}")
    for remark in list_response_remarks(comparison.model_dump(mode="json")):
        yield indent_text(remark, "warning: ")

"""`pantocheck pantograph compare`: frequency responses measured at a pantograph head beside those of its model."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.comparison_output import build_comparison_output, write_comparison_files
from pantocheck.conformance.app.commands.console import build_table, escape_text, format_number
from pantocheck.conformance.app.commands.options import ResponsesArgument
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.comparison.comparison_limits import RESPONSES, read_comparison_limits
from pantocheck.conformance.comparison.response_comparison import compare_responses
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.response_record import read_response
from pantocheck.conformance.results.comparison_format import ResponseComparison, ResponseQuantity

PRINTED_DEVIATIONS: tuple[ResponseQuantity, ...] = (
    "modulus_deviation_pct",
    "phase_deviation_deg",
    "complex_deviation_pct",
)


def pantograph_compare_command(
    responses: ResponsesArgument,
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
    graded = read_comparison_limits(limits, RESPONSES)
    check_writable(out)
    with follow_steps("comparing"):
        comparison = compare_responses(records, model, graded)
        files = write_comparison_files(comparison, out / "response_comparison")
    return build_comparison_output(comparison, [_tabulate_deviations(comparison)], files)


def _tabulate_deviations(comparison: ResponseComparison) -> RenderableType:
    """RMS deviations of every band."""
    numbers = ("modulus %", "phase °", "complex %")
    table = build_table("response", "band", *numbers, title="RMS deviation of the model", right=numbers)
    for response in comparison.responses:
        for band in response.bands:
            if band.deviations:
                values = (format_number(band.deviations[key], 3) for key in PRINTED_DEVIATIONS)
                table.add_row(escape_text(response.name), f"{band.band_Hz[0]:g} to {band.band_Hz[1]:g} Hz", *values)
    return table

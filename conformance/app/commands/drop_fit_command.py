"""`pantocheck drop fit`: damping model of a line from identified modes."""

from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.app.commands.command_output import CommandOutput, Unwrapped
from pantocheck.conformance.app.commands.console import escape_text, indent_text
from pantocheck.conformance.app.commands.options import ElementOption, LineOption, read_line
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.app.notebook.identified_lines import refuse_other_modes, write_damping_fit
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.drops.damping_model import MODAL_GROUPS
from pantocheck.conformance.drops.damping_results import (
    FitOptions,
    WireCoefficients,
    build_damping_results,
    write_damping_toml,
)
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.pages.report_writers import remark_missing_formats
from pantocheck.conformance.results.identified_modes import read_modes


def drop_fit_command(
    modes: Annotated[Path, typer.Argument(help="modes.json of `pantocheck drop identify`.")],
    line: LineOption,
    out: Annotated[
        Path, typer.Option(help="Folder for damping.toml, damping_with_modal.toml, damping.json, .html and .pdf.")
    ],
    element: ElementOption = 0.5,
    wires: Annotated[
        WireCoefficients,
        typer.Option(help="separate: each wire has its own coefficients; common: both wires have the same."),
    ] = "separate",
    modal_groups: Annotated[
        int,
        typer.Option(
            help="Groups of span modes with a band of modal damping in damping_with_modal.toml.", min=1, max=8
        ),
    ] = MODAL_GROUPS,
    other_line: Annotated[
        bool,
        typer.Option("--other-line", help="Permit a line that differs from that of the record; the result is marked."),
    ] = False,
) -> CommandOutput:
    """Fit a damping model of a line to identified modes.

    The model is Rayleigh damping per component, with and without modal damping. The report states which coefficients
    the modes determine. A line whose spans, tensions or wires at the sensors differ from those of the record is
    refused.

    Example: pantocheck drop fit T1/modes.json --line my-line.toml --out T1
    """
    identified, catenary = read_modes(modes), build_catenary(read_line(line))
    if not other_line:
        refuse_other_modes(identified, catenary, modes.name)
    check_writable(out)
    with follow_steps("damping fit", 2) as progress:
        progress.begin_task("modes of the line")
        results = build_damping_results(identified, catenary, element, modes.name, FitOptions(wires, modal_groups))
        progress.begin_task("report")
        document, files = write_damping_fit(results, out)
    return CommandOutput(
        escape_text(document.header.headline),
        results,
        [
            *(indent_text(text, "warning: ") for text in results.warnings),
            Unwrapped(escape_text(write_damping_toml(results)).plain),
        ],
        files=files,
        remarks=remark_missing_formats(),
    )

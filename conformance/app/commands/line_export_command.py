"""`pantocheck line export`: tables of the supports and droppers of a line."""

from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.app.commands.cases_option import complete_case
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import escape_text
from pantocheck.conformance.app.commands.options import read_line
from pantocheck.conformance.core.files import check_writable, write_atomically
from pantocheck.conformance.line.line_export import DecimalMark, export_droppers, export_supports


def line_export_command(
    line: Annotated[
        str, typer.Argument(help="Id of a case, or path of a case or line file.", autocompletion=complete_case)
    ],
    out: Annotated[Path, typer.Option(help="Folder for supports.csv and droppers.csv.")],
    decimal: Annotated[
        DecimalMark, typer.Option(help="Decimal mark; beside commas, columns are separated by semicolons.")
    ] = "point",
) -> CommandOutput:
    """Write supports and droppers of a line as tables.

    `pantocheck line import` turns the tables, with the same line file as base, into the same line.

    Example: pantocheck line export en50318-2018/ac-simple/static --out tables --decimal comma
    """
    line_file = read_line(line)
    check_writable(out)
    files = [out / "supports.csv", out / "droppers.csv"]
    for path, export in zip(files, (export_supports, export_droppers), strict=True):
        # Spreadsheets recognise UTF-8 by the byte order mark.
        write_atomically(path, export(line_file, decimal).encode("utf-8-sig"))
    spans = line_file.geometry.spans
    return CommandOutput(escape_text(f"{line_file.title}: {spans} spans"), {"spans": spans}, files=files)

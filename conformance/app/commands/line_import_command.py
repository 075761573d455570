"""`pantocheck line import`: line file from tables of supports and droppers."""

from pathlib import Path
from typing import Annotated

import tomli_w
import typer

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import escape_text
from pantocheck.conformance.core.files import check_writable, write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.line.dropper_rows import LengthMeaning
from pantocheck.conformance.line.line_import import import_line


def line_import_command(
    supports: Annotated[
        Path, typer.Argument(help=f"CSV table of the supports and both ends: {DocumentationPage.LINE_TABLES}.")
    ],
    base: Annotated[
        Path, typer.Option(help="Line file with the wires, arms and damping, and the values of empty cells.")
    ],
    out: Annotated[Path, typer.Option(help="Line file to write.")],
    droppers: Annotated[
        Path | None, typer.Option(help="CSV table of the droppers. Default: those of [droppers] in the base file.")
    ] = None,
    dropper_lengths: Annotated[
        LengthMeaning,
        typer.Option(
            help="Meaning of the column length_m: published, for comparison only; or unloaded, so that the heights of "
            "the contact wire follow from the lengths."
        ),
    ] = "published",
) -> CommandOutput:
    """Write a line file from tables of supports and droppers.

    All problems of all files are reported at once, with file, row and column.

    Example: pantocheck line import supports.csv --droppers droppers.csv --base base.toml --out my-line.toml

    Then: pantocheck check my-line.toml
    """
    inputs = [path for path in (supports, droppers, base) if path is not None]
    if out.resolve() in [path.resolve() for path in inputs]:
        raise InputError(f"option --out {out}", "is a file of the import", "Give another name for the line file.")
    tree = import_line(base, supports, droppers, dropper_lengths)
    check_writable(out.parent)
    names = ", ".join(path.name for path in inputs)
    head = f"# Written by `pantocheck line import` from {names}.\n"
    write_atomically(out, (head + tomli_w.dumps(tree)).encode())
    geometry = tree["geometry"]
    facts = {
        "spans": len(geometry["span_list"]),
        "length_m": sum(span["length_m"] for span in geometry["span_list"]),
    }
    return CommandOutput(escape_text(f"{facts['spans']} spans, {facts['length_m']:g} m"), facts, files=(out,))

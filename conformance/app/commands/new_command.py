"""`pantocheck new`: commented input files to start from."""

from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import escape_text
from pantocheck.conformance.app.new_files import (
    NEW_KINDS,
    choose_parts,
    fill_case_template,
    read_template,
    write_new_file,
)
from pantocheck.conformance.core.input_error import InputError, suggest_names


def new_command(
    kind: Annotated[str, typer.Argument(help=f"Kind of the file: {', '.join(NEW_KINDS)}.")],
    file: Annotated[Path | None, typer.Argument(help="File to write.", show_default="KIND.toml")] = None,
    line: Annotated[
        str | None,
        typer.Option(help="Line of a new case.", show_default="line.toml beside the case, or one of the library"),
    ] = None,
    pantograph: Annotated[
        str | None,
        typer.Option(
            help="Pantograph of a new case.", show_default="pantograph.toml beside the case, or one of the library"
        ),
    ] = None,
) -> CommandOutput:
    """Write a commented, valid input file to start from.

    Examples:

    pantocheck new line my-line.toml

    pantocheck new case my-case.toml --line my-line.toml
    """
    chosen = next((known for known in NEW_KINDS if known == kind), None)
    if chosen is None:
        raise InputError(f"kind '{kind}'", "there is no template of this kind", suggest_names(kind, NEW_KINDS))
    path = file or Path(f"{kind}.toml")
    if chosen == "case":
        parts = choose_parts(path, {"line": line, "pantograph": pantograph})
        write_new_file(path, fill_case_template(path, parts))
        text = f"new case with {parts['line']} and {parts['pantograph']}"
        return CommandOutput(escape_text(text), {"kind": kind, **parts}, files=(path,))
    if line is not None or pantograph is not None:
        raise InputError("options --line and --pantograph", f"given for a {kind}", "Only a case names other files.")
    write_new_file(path, read_template(chosen))
    return CommandOutput(escape_text(f"new {kind}"), {"kind": kind}, files=(path,))

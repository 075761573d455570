"""`pantocheck check`: check of input files, with all their problems."""

from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.command_line.cases_option import CasesOption
from pantocheck.conformance.command_line.console import console, escape_text
from pantocheck.conformance.command_line.guard import BAD_INPUT, strip_control_characters
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.own_files.file_check import check_input_file
from pantocheck.conformance.own_files.folder_search import list_input_files
from pantocheck.conformance.schemas import READ_FORMATS


def check_command(
    files: Annotated[
        list[Path] | None, typer.Argument(metavar="FILE...", help="Files of any kind, or folders with them.")
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option(help=f"Kind of the files: {', '.join(READ_FORMATS)}.", show_default="recognised by the keys"),
    ] = None,
    folders: CasesOption = None,
) -> None:
    """Check input files and report all their problems at once.

    Examples:

    pantocheck check my-line.toml my-case.toml

    pantocheck check records

    pantocheck check --cases my-cases
    """
    output, problems, faulty = console(), 0, 0
    if not (files or folders):
        raise InputError("command line", "no file is named", "Name files or folders, or a folder of cases by --cases.")
    open_catalogue(folders or ())  # refuses ids and names of the library
    files = [*(files or ()), *(folders or ())]
    # A folder without input files stays in the list, so that it is reported like a faulty file.
    paths = [file for name in files for file in ([*list_input_files(name)] or [name] if name.is_dir() else [name])]
    for path in paths:
        try:
            output.print(escape_text(f"{path}: valid {check_input_file(path, kind)}"), soft_wrap=True)
        except InputError as error:
            typer.echo(strip_control_characters(str(error)), err=True)
            problems, faulty = problems + len(error.problems), faulty + 1
    if faulty:
        typer.echo(f"{problems} problem(s) in {faulty} of {len(paths)} file(s)", err=True)
        raise typer.Exit(BAD_INPUT)
    if any(name.is_dir() for name in files):
        output.print(f"{len(paths)} file(s) checked, all valid")

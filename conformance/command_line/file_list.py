"""Output of the files that a command has written."""

from collections.abc import Sequence
from pathlib import Path

import typer

from pantocheck.conformance.command_line.console import console, escape_text
from pantocheck.conformance.reports.formats.report_writers import remark_missing_formats


def print_files(files: Sequence[Path], stated: Sequence[str] | None = None) -> None:
    """Print the paths of the files of a report; a default format that is not written is named on standard error.

    Parameters
    ----------
    files : sequence of Path
        The written files.
    stated : sequence of str or None
        Formats that the user states; None: the default formats.
    """
    for path in files:
        console().print(escape_text(str(path)), soft_wrap=True)
    for remark in remark_missing_formats(stated) if files else ():
        typer.echo(f"remark: {remark}", err=True)

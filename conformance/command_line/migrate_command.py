"""`pantocheck migrate`: files in the current version of their format."""

from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from pantocheck.conformance.command_line.command_output import CommandOutput, Unwrapped
from pantocheck.conformance.command_line.console import escape_text
from pantocheck.conformance.counted_noun import count_noun
from pantocheck.conformance.own_files.migrated_file import migrate_file


def migrate_command(
    files: Annotated[list[Path], typer.Argument(metavar="FILE...", help="TOML or JSON files with the key schema.")],
    out: Annotated[Path, typer.Option(help="Folder of the new files; no file is overwritten.")],
) -> CommandOutput:
    """Write files in the current version of their format into a folder.

    The suite reads earlier versions without this command. Comments of TOML files are not kept.

    Example: pantocheck migrate my-profile.toml --out migrated
    """
    lines = [escape_text(migrate_file(path, out)).plain for path in files]
    return CommandOutput(Text(count_noun(len(files), "file")), lines, [Unwrapped(line) for line in lines])

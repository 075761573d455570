"""`pantocheck schema`: JSON Schemas of the file formats."""

from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from pantocheck.conformance.app.commands.command_output import CommandOutput, Unwrapped
from pantocheck.conformance.app.schemas import FORMAT_NAMES, build_schema, format_schema
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.input_error import InputError, suggest_names


def schema_command(
    name: Annotated[
        str | None, typer.Argument(help=f"Format: {', '.join(FORMAT_NAMES)}; all if omitted.", show_default=False)
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Write NAME.schema.json to this folder instead of printing.")] = None,
) -> CommandOutput:
    """Print the JSON Schema of a file format.

    Example: pantocheck schema case > case.schema.json
    """
    if name is not None and name not in FORMAT_NAMES:
        raise InputError(f"schema '{name}'", "there is no such format", suggest_names(name, FORMAT_NAMES))
    schemas = {each: build_schema(each) for each in (FORMAT_NAMES if name is None else (name,))}
    if out is None:
        shown = schemas if name is None else schemas[name]
        return CommandOutput(Text(), shown, [Unwrapped(format_schema(shown).rstrip("\n"))])
    files = [out / f"{each}.schema.json" for each in schemas]
    for path, schema in zip(files, schemas.values(), strict=True):
        write_atomically(path, format_schema(schema).encode())
    return CommandOutput(Text(f"{len(files)} schemas"), schemas, files=files)

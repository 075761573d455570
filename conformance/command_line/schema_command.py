"""`pantocheck schema`: the file formats, for editors and validators."""

from pathlib import Path
from typing import Annotated

import typer


def schema_command(
    name: Annotated[
        str | None,
        typer.Argument(
            help="case, line, pantograph, damping, limits, plan, record, summary, profile, results, command-request or "
            "command-answer; without: all"
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder to write NAME.schema.json to, in place of printing.")] = None,
) -> None:
    """Print the JSON Schema of a file format.

    Example: pantocheck schema case > case.schema.json
    """
    from pantocheck.conformance.input_files.atomic_writing import write_atomically
    from pantocheck.conformance.input_files.input_error import InputError
    from pantocheck.conformance.input_files.suggestions import suggest_names
    from pantocheck.conformance.schemas import NAMES, schema_of

    if name is not None and name not in NAMES:
        raise InputError(f"schema '{name}'", "there is no such format", suggest_names(name, NAMES))
    wanted = {each: schema_of(each) for each in (NAMES if name is None else (name,))}
    if out is None:
        typer.echo(_text(wanted if name is None else wanted[name]), nl=False)
        return
    for each, content in wanted.items():
        write_atomically(out / f"{each}.schema.json", _text(content).encode())


def _text(content: object) -> str:
    import json

    return json.dumps(content, indent=2) + "\n"

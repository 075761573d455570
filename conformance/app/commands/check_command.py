"""`pantocheck check` and `schema`: check of input files, with all their problems, and the schemas of their formats."""

from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from pantocheck.conformance.app.commands.cases_option import CasesOption
from pantocheck.conformance.app.commands.command_output import CommandOutput, Unwrapped, list_problems
from pantocheck.conformance.app.commands.console import indent_text
from pantocheck.conformance.app.commands.guard import BAD_INPUT, strip_control_characters
from pantocheck.conformance.app.file_check import check_input_file, list_input_files
from pantocheck.conformance.app.schemas import FORMAT_NAMES, READ_FORMATS, build_schema, format_schema
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.core.texts import count_noun


def check_command(
    files: Annotated[
        list[Path] | None, typer.Argument(metavar="FILE...", help="Files of any kind, or folders with them.")
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option(help=f"Kind of the files: {', '.join(READ_FORMATS)}.", show_default="recognised by the keys"),
    ] = None,
    folders: CasesOption = None,
) -> CommandOutput:
    """Check input files and report all their problems.

    Examples:

    pantocheck check my-line.toml my-case.toml

    pantocheck check records

    pantocheck check --cases my-cases
    """
    if not (files or folders):
        raise InputError("command line", "no file is named", "Name files or folders, or a folder of cases by --cases.")
    if folders:
        from pantocheck.conformance.cases.catalogue import open_catalogue

        open_catalogue(folders)  # refuses ids and names of the library
    files = [*(files or ()), *(folders or ())]
    checked: list[dict[str, object]] = []
    problems = faulty = 0
    # A folder without input files stays in the list, so that it is reported like a faulty file.
    paths = [file for name in files for file in ([*list_input_files(name)] or [name] if name.is_dir() else [name])]
    for path in paths:
        try:
            checked.append({"file": str(path), "kind": check_input_file(path, kind), "problems": []})
        except InputError as error:
            typer.echo(strip_control_characters(str(error)), err=True)
            problems, faulty = problems + len(error.problems), faulty + 1
            checked.append({"file": str(path), "kind": None, "problems": list_problems(error)})
    lines = [indent_text(f"{item['file']}: valid {item['kind']}", "") for item in checked if item["kind"] is not None]
    if faulty:
        conclusion = Text(f"{count_noun(problems, 'problem')} in {faulty} of {count_noun(len(paths), 'file')}")
        return CommandOutput(conclusion, checked, lines, exit_code=BAD_INPUT)
    if len(lines) == 1 and not files[0].is_dir():
        return CommandOutput(lines[0].text, checked)
    return CommandOutput(Text(f"{count_noun(len(paths), 'file')} checked, all valid"), checked, lines)


# `pantocheck schema`: JSON Schemas of the file formats.
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
    return CommandOutput(Text(count_noun(len(files), "schema")), schemas, files=files)

"""`pantocheck new`: commented input files and sheets to start from."""

import json
import re
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Literal, get_args

import typer

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import escape_text
from pantocheck.conformance.core.input_error import InputError, suggest_names

NewKind = Literal["line", "case", "pantograph", "response", "static", "administration", "dossier"]
"""Kinds of input files with a template."""

SheetKind = Literal["line", "static", "sensors"]
"""Kinds of sheets to fill in."""

NEW_KINDS: tuple[NewKind, ...] = get_args(NewKind)
SHEET_KINDS: tuple[SheetKind, ...] = get_args(SheetKind)

LIBRARY_PARTS = {"line": "en50318-2002/line.toml", "pantograph": "en50318-2002/pantograph.toml"}
"""Files of the library to which a new case refers if there are none beside it."""


def read_template(kind: NewKind) -> str:
    """Text of the template of a kind; `@id@`, `@line@` and `@pantograph@` stand for values of a case."""
    return (files("pantocheck.templates") / f"new-{kind}.toml").read_text(encoding="utf-8")


def choose_parts(path: Path, named: Mapping[str, str | None]) -> dict[str, str]:
    """Line and pantograph of a new case: files that the user names, files beside the case, or those of the library."""
    beside = {part: f"{part}.toml" for part in LIBRARY_PARTS}
    default = {part: name if (path.parent / name).is_file() else LIBRARY_PARTS[part] for part, name in beside.items()}
    return {part: named.get(part) or name for part, name in default.items()}


def fill_case_template(path: Path, parts: Mapping[str, str]) -> str:
    """Text of a new case with some parts; the name of its file becomes its id."""
    values = {**parts, "id": "own/" + (re.sub(r"[^A-Za-z0-9._-]+", "-", path.stem) or "case")}
    text = read_template("case")
    for name, value in values.items():
        text = text.replace(f"@{name}@", json.dumps(value)[1:-1])  # a TOML string has the escapes of JSON
    return text


def build_sheets(kind: SheetKind) -> bytes:
    """Workbook to fill in, with the values of the template as examples."""
    from pantocheck.conformance.core.extras import require_package
    from pantocheck.conformance.core.toml_file import validate_model
    from pantocheck.conformance.core.workbook_writing import SheetColumn, WrittenSheet, describe_column, write_workbook
    from pantocheck.conformance.drops.drop_sidecar import DropChannelTable
    from pantocheck.conformance.line.line_export import export_workbook
    from pantocheck.conformance.line.line_file import LineFile

    if kind == "line":
        return export_workbook(validate_model(tomllib.loads(read_template("line")), LineFile, "template"))
    require_package("openpyxl", "format 'xlsx'")
    if kind == "sensors":
        columns = [describe_column(key, DropChannelTable, key) for key in DropChannelTable.model_fields]
        words = {"direction": ("+x", "-x", "+y", "-y", "+z", "-z"), "wire": ("CW", "MW")}
        columns = [replace(column, words=words.get(column.name, ())) for column in columns]
        rows: list[list[str | float]] = [[n, f"S{n}_z", n, "CW", 31.5 * n, "+z", "m/s2"] for n in (1, 2)]
    else:
        columns = [
            SheetColumn("position_m", "position, as the table counts [m]", rule="a number"),
            SheetColumn("contact_wire_height_m", "height of the contact wire at rest [m]", rule="a number"),
            SheetColumn("elasticity_mm_N", "uplift over static force [mm/N]", rule="a positive number", bounds=(">0",)),
        ]
        rows = [[1001.5, 5.2986, 0.0609], [1007.5, 5.2965, 0.2235], [1013.5, 5.2969, 0.3365]]
    return write_workbook([WrittenSheet(kind, tuple(columns), rows, is_filled_in=True)])


def write_new_file(path: Path, content: str | bytes, suffix: str = ".toml") -> None:
    """Write a file that does not exist yet."""
    where = f"file '{path}'"
    if path.suffix != suffix:
        raise InputError(where, f"has the suffix {path.suffix!r}", f"Give a name that ends in {suffix} .")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("xb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
    except FileExistsError:
        raise InputError(where, "exists already", "Give another name. No file is overwritten.") from None
    except OSError as error:
        raise InputError(where, f"cannot be written ({error.strerror})", "Name a folder you may write to.") from None


def new_command(
    kind: Annotated[
        str, typer.Argument(help=f"Kind of the file: {', '.join(NEW_KINDS)}; of a sheet: {', '.join(SHEET_KINDS)}.")
    ],
    file: Annotated[
        Path | None, typer.Argument(help="File to write: .toml, or .xlsx for a sheet.", show_default="KIND.toml")
    ] = None,
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

    A name that ends in .xlsx gives a sheet to fill in.

    Examples:

    pantocheck new line my-line.toml

    pantocheck new case my-case.toml --line my-line.toml

    pantocheck new static heights.xlsx
    """
    sheet = next((known for known in SHEET_KINDS if known == kind), None)
    if sheet is not None and file is not None and file.suffix == ".xlsx":
        return _write_sheets(sheet, file)
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
        raise InputError("options --line and --pantograph", f"are given for a {kind}", "Only a case names other files.")
    write_new_file(path, _fill_template(chosen, f"{path.stem}.csv"))
    return CommandOutput(escape_text(f"new {kind}"), {"kind": kind}, files=(path,))


def _fill_template(kind: NewKind, table: str) -> str:
    """Template with the name of its table as a TOML string."""
    return read_template(kind).replace("@table@", json.dumps(table)[1:-1])


def _write_sheets(kind: SheetKind, path: Path) -> CommandOutput:
    """Write a workbook; beside that of static values, its sidecar."""
    content, sidecar = build_sheets(kind), path.with_suffix(".toml")
    files = [path, sidecar] if kind == "static" else [path]
    if found := [file for file in files if file.exists()]:
        raise InputError(f"file '{found[0]}'", "exists already", "Give another name. No file is overwritten.")
    write_new_file(path, content, ".xlsx")
    if kind == "static":
        write_new_file(sidecar, _fill_template("static", path.name))
    return CommandOutput(escape_text(f"new sheets: {kind}"), {"kind": kind}, files=files)

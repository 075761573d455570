"""`pantocheck new`: commented input files to start from."""

import json
import re
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Literal, get_args

import typer

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import escape_text
from pantocheck.conformance.core.input_error import InputError, suggest_names

NewKind = Literal["line", "case", "pantograph", "response", "administration", "dossier"]
"""Kinds of input files with a template."""

NEW_KINDS: tuple[NewKind, ...] = get_args(NewKind)

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


def write_new_file(path: Path, text: str) -> None:
    """Write a TOML file that does not exist yet."""
    where = f"file '{path}'"
    if path.suffix != ".toml":
        raise InputError(where, f"has the suffix {path.suffix!r}", "Give a name that ends in .toml .")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise InputError(where, "exists already", "Give another name. No file is overwritten.") from None
    except OSError as error:
        raise InputError(where, f"cannot be written ({error.strerror})", "Name a folder you may write to.") from None


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
        raise InputError("options --line and --pantograph", f"are given for a {kind}", "Only a case names other files.")
    write_new_file(path, read_template(chosen))
    return CommandOutput(escape_text(f"new {kind}"), {"kind": kind}, files=(path,))

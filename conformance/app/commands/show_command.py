"""`pantocheck show`: content of a case and the provenance of each number."""

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType
from rich.text import Text

from pantocheck.conformance.app.commands.case_tables import (
    build_case_tables,
    build_derived_tables,
    build_rest_tables,
    describe_case,
)
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.options import CasesOption, complete_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.files import check_writable, write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.runs.command_system import build_case_message


def show_command(
    case: Annotated[
        str,
        typer.Argument(
            help="Id, glob or path of a case, e.g. en50318-2002/250.",
            autocompletion=complete_case,
        ),
    ],
    at_rest: Annotated[
        bool,
        typer.Option("--at-rest", help="Also compute the line at rest and the frequency response of the pantographs."),
    ] = False,
    derived: Annotated[
        bool,
        typer.Option("--derived", help="Also compute the values that follow from the inputs by the conventions."),
    ] = False,
    request: Annotated[
        Path | None,
        typer.Option(help=f"JSON file for one case, as a program receives it: {DocumentationPage.SYSTEMS}."),
    ] = None,
    folders: CasesOption = None,
) -> CommandOutput:
    """Show inputs, limits and notes of a case.

    Examples:

    pantocheck show en50318-2018/ac-simple/275 --at-rest

    pantocheck show en50318-2002/250 --derived --request case.json
    """
    cases = leave_out_required(case, select_cases([case], (), open_catalogue(folders or ())))
    if request is not None:
        _write_request(cases, request)
    parts: list[RenderableType] = []
    for each in cases:
        tables = [*(build_derived_tables(each) if derived else []), *(build_rest_tables(each) if at_rest else [])]
        parts += [*build_case_tables(each), *tables]
    return CommandOutput(
        Text(),
        [describe_case(each) for each in cases],
        parts,
        files=[] if request is None else [request],
    )


def leave_out_required(pattern: str, cases: list[Case]) -> list[Case]:
    """Cases that the pattern selects itself, without the cases that they require."""
    exact = [case for case in cases if case.id == pattern]
    required = {name for case in cases for name in case.file.requires}
    return exact or [case for case in cases if case.id not in required] or cases


def _write_request(cases: list[Case], path: Path) -> None:
    if len(cases) != 1:
        raise InputError("option --request", f"the pattern selects {len(cases)} cases", "Give the id of one case.")
    check_writable(path.parent)
    write_atomically(path, (json.dumps(build_case_message(cases[0]), indent=1) + "\n").encode())

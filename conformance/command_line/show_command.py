"""`pantocheck show`: content of a case and the provenance of each number."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType
from rich.text import Text

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.named_files import recognise_named_file
from pantocheck.conformance.command_line.case_completion import complete_case
from pantocheck.conformance.command_line.case_tables import build_case_tables, describe_case
from pantocheck.conformance.command_line.cases_option import CasesOption
from pantocheck.conformance.command_line.command_output import CommandOutput
from pantocheck.conformance.command_line.console import escape_text
from pantocheck.conformance.command_line.derived_tables import build_derived_tables
from pantocheck.conformance.command_line.rest_tables import build_rest_tables
from pantocheck.conformance.input_files.atomic_writing import check_writable, write_atomically
from pantocheck.conformance.input_files.documentation_pages import DocumentationPage
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.toml_file import read_model, read_toml
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.conformance.simulation.drawing_marks import list_labelled_marks, list_marks
from pantocheck.conformance.simulation.line_drawing import LineDrawing, draw_line_pdf, draw_line_svg
from pantocheck.conformance.systems.command.case_message import build_case_message
from pantocheck.model import discretise

DRAWING_FORMATS: dict[str, Callable[[LineDrawing], bytes]] = {
    ".svg": lambda drawing: draw_line_svg(drawing).encode(),
    ".pdf": draw_line_pdf,
}
"""Writer of a drawing by the suffix of its file."""


def show_command(
    case: Annotated[
        str,
        typer.Argument(
            help="Id, glob or path of a case, e.g. en50318-2002/250; a line file for --drawing.",
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
    drawing: Annotated[
        Path | None,
        typer.Option(help="SVG or PDF file for a drawing of the whole line to scale, in elevation and in plan."),
    ] = None,
    folders: CasesOption = None,
) -> CommandOutput:
    """Show the inputs, the limits and the notes of a case with their trust and source.

    Examples:

    pantocheck show en50318-2018/ac-simple/275 --at-rest

    pantocheck show en50318-2002/250 --derived --request case.json

    pantocheck show en50318-2018/ac-stitched/static --drawing line.svg

    pantocheck show my-line.toml --drawing line.svg
    """
    if drawing is not None and drawing.suffix.lower() not in DRAWING_FORMATS:
        raise InputError(
            str(drawing), f"format '{drawing.suffix}' cannot be written", f"Write {' or '.join(DRAWING_FORMATS)}."
        )
    if drawing is not None:
        check_writable(drawing.parent)
    if drawing is not None and not (at_rest or derived or request) and _is_line(case):
        line = read_model(Path(case), LineFile, "line")
        _draw_line(line, drawing)
        return CommandOutput(escape_text(line.title), {"title": line.title}, files=(drawing,))
    cases = _without_required(case, select_cases([case], (), open_catalogue(folders or ())))
    if request is not None:
        _write_request(cases, request)
    if drawing is not None:
        if any(each.line != cases[0].line for each in cases):
            raise InputError(f"case '{case}'", "the cases have different lines", "Give the id of one case.")
        _draw(cases[0], drawing)
    parts: list[RenderableType] = []
    for each in cases:
        tables = [*(build_derived_tables(each) if derived else []), *(build_rest_tables(each) if at_rest else [])]
        parts += [*build_case_tables(each), *tables]
    return CommandOutput(
        Text(),
        [describe_case(each) for each in cases],
        parts,
        files=[path for path in (request, drawing) if path is not None],
    )


def _without_required(pattern: str, cases: list[Case]) -> list[Case]:
    """Cases that the pattern selects itself, without the cases that they require."""
    exact = [case for case in cases if case.id == pattern]
    required = {name for case in cases for name in case.file.requires}
    return exact or [case for case in cases if case.id not in required] or cases


def _write_request(cases: list[Case], path: Path) -> None:
    if len(cases) != 1:
        raise InputError("option --request", f"the pattern selects {len(cases)} cases", "Give the id of one case.")
    check_writable(path.parent)
    write_atomically(path, (json.dumps(build_case_message(cases[0]), indent=1) + "\n").encode())


def _is_line(name: str) -> bool:
    return name.endswith(".toml") and recognise_named_file(read_toml(Path(name), "file").keys()) == "line"


def _draw_line(file: LineFile, path: Path) -> None:
    """Draw a line without a case, with the default mesh of cases."""
    line = discretise(build_catenary(file), Discretisation().element_m)
    _write_drawing(
        LineDrawing(line, file.title, file.geometry, list_labelled_marks(line.catenary), file.section_places), path
    )


def _draw(case: Case, path: Path) -> None:
    line = discretise(build_catenary(case.line), case.file.discretisation.element_m)
    marks = list_marks(case, line.catenary)
    _write_drawing(LineDrawing(line, case.line.title, case.line.geometry, marks, case.line.section_places), path)


def _write_drawing(drawing: LineDrawing, path: Path) -> None:
    write_atomically(path, DRAWING_FORMATS[path.suffix.lower()](drawing))

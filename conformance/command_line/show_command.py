"""`pantocheck show`: content of a case and the provenance of each number."""

from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.command_line.case_tables import build_case_tables
from pantocheck.conformance.command_line.console import console, escape_text
from pantocheck.conformance.command_line.rest_tables import build_rest_tables
from pantocheck.conformance.input_files.atomic_writing import check_writable, write_atomically
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.conformance.simulation.line_drawing import draw_line
from pantocheck.model import discretise

DRAWN_SPANS = 6
"""Spans of a drawing: all spans are alike, so a few show the line."""


def show_command(
    case: Annotated[str, typer.Argument(help="Id, glob or path of a case, e.g. en50318-2002/250.")],
    at_rest: Annotated[
        bool,
        typer.Option("--at-rest", help="Also compute the line at rest and the frequency response of the pantographs."),
    ] = False,
    drawing: Annotated[
        Path | None, typer.Option(help="SVG file for a drawing of the line to scale, in elevation and in plan.")
    ] = None,
) -> None:
    """Show the inputs, the limits and the notes of a case with their trust and source.

    Examples:

    pantocheck show en50318-2018/ac-simple/275 --at-rest

    pantocheck show en50318-2018/ac-stitched/static --drawing line.svg
    """
    output = console()
    cases = _without_required(case, select_cases([case]))
    if drawing is not None:
        if any(each.line != cases[0].line for each in cases):
            raise InputError(f"case '{case}'", "the cases have different lines", "Give the id of one case.")
        _draw(cases[0], drawing)
    for each in cases:
        for part in [*build_case_tables(each), *(build_rest_tables(each) if at_rest else [])]:
            output.print(part)
    if drawing is not None:
        output.print(escape_text(str(drawing)), soft_wrap=True)


def _without_required(pattern: str, cases: list[Case]) -> list[Case]:
    """Cases that the pattern selects itself, without the cases that they require."""
    exact = [case for case in cases if case.id == pattern]
    required = {name for case in cases for name in case.file.requires}
    return exact or [case for case in cases if case.id not in required] or cases


def _draw(case: Case, path: Path) -> None:
    check_writable(path.parent)
    short = case.line.model_copy(update={"geometry": case.line.geometry.shorten(DRAWN_SPANS)})
    line = discretise(build_catenary(short), case.file.discretisation.element_m)
    write_atomically(path, draw_line(line, short.title, short.geometry).encode())

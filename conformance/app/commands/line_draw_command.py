"""`pantocheck line draw`: drawing of a whole line, in elevation and in plan."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.app.commands.cases_option import CasesOption, complete_case, leave_out_required
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import escape_text
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.cases.library import recognise_named_file, select_cases
from pantocheck.conformance.cases.study_tables import MassDrop
from pantocheck.conformance.core.figure_data import DrawnSymbol
from pantocheck.conformance.core.files import check_writable, write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.elements.element import KINDS, DrawnMark
from pantocheck.conformance.line.elements.point_mass import PointMasses
from pantocheck.conformance.line.line_drawing import LineDrawing, draw_line_pdf, draw_line_svg, list_labelled_marks
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import Catenary, discretise

SENSOR = DrawnSymbol(name="sensor", marker="s")

DRAWING_FORMATS: dict[str, Callable[[LineDrawing], bytes]] = {
    ".svg": lambda drawing: draw_line_svg(drawing).encode(),
    ".pdf": draw_line_pdf,
}
"""Writer of a drawing by the suffix of its file."""


def line_draw_command(
    line: Annotated[
        str, typer.Argument(help="Line file, or id or path of a case.", autocompletion=complete_case, metavar="LINE")
    ],
    out: Annotated[Path, typer.Option(help="SVG or PDF file of the drawing.")],
    folders: CasesOption = None,
) -> CommandOutput:
    """Draw a whole line to scale, in elevation and in plan.

    The drawing of a case also has its sensors and dropped masses.

    Examples:

    pantocheck line draw my-line.toml --out line.svg

    pantocheck line draw en50318-2018/ac-stitched/static --out line.pdf
    """
    if out.suffix.lower() not in DRAWING_FORMATS:
        raise InputError(str(out), f"format '{out.suffix}' cannot be written", f"Write {' or '.join(DRAWING_FORMATS)}.")
    check_writable(out.parent)
    is_line = line.endswith(".toml") and recognise_named_file(read_toml(Path(line), "file").keys()) == "line"
    drawing = _build_line(line) if is_line else _build_case(line, folders)
    write_atomically(out, DRAWING_FORMATS[out.suffix.lower()](drawing))
    return CommandOutput(escape_text(drawing.title), {"title": drawing.title}, files=(out,))


def _build_line(name: str) -> LineDrawing:
    """Drawing of a line without a case, with the default mesh of cases."""
    file = read_model(Path(name), LineFile, "line")
    line = discretise(build_catenary(file), Discretisation().element_m)
    return LineDrawing(line, file.title, file.geometry, list_labelled_marks(line.catenary), file.section_places)


def _build_case(name: str, folders: list[Path] | None) -> LineDrawing:
    """Drawing of the line of a case with its marks; several cases must have one line."""
    cases: list[Case] = leave_out_required(name, select_cases([name], (), open_catalogue(folders or ())))
    if any(each.line != cases[0].line for each in cases):
        raise InputError(f"case '{name}'", "the cases have different lines", "Give the id of one case.")
    (case, *_) = cases
    line = discretise(build_catenary(case.line), case.file.discretisation.element_m)
    marks = list_marks(case, line.catenary)
    return LineDrawing(line, case.line.title, case.line.geometry, marks, case.line.section_places)


def list_marks(case: Case, catenary: Catenary) -> tuple[DrawnMark, ...]:
    """Masses of a line, and sensors and dropped masses of its case, numbered from 1 as in its file."""
    drops = case.file.mass_drop
    return (*list_labelled_marks(catenary), *(() if drops is None else _list_drop_marks(drops, catenary)))


def _list_drop_marks(drops: MassDrop, catenary: Catenary) -> Iterator[DrawnMark]:
    for number, sensor in enumerate(drops.sensor, 1):
        yield DrawnMark(SENSOR, _find_wire(catenary, sensor.wire, sensor.x_m), sensor.x_m, f"S{number}")
    for number, drop in enumerate(drops.drop, 1):
        text = f"drop {number}: {drop.mass_kg:g} kg"
        yield DrawnMark(PointMasses.symbol, _find_wire(catenary, drop.wire, drop.x_m), drop.x_m, text)


def _find_wire(catenary: Catenary, name: str, position: float) -> str:
    """First wire of a kind, named as in a case file, at a position."""
    return next(w.name for w in catenary.wires if w.kind is KINDS[name] and w.start <= position <= w.end)

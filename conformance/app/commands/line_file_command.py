"""`pantocheck line import`, `line export` and `line draw`: a line as tables or FMU, and its drawing."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated

import tomli_w
import typer

from pantocheck.conformance.app.commands.cases_option import CasesOption, complete_case
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import escape_text
from pantocheck.conformance.app.commands.options import choose_train_case, read_line
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.cases.library import leave_out_required, recognise_named_file, select_cases
from pantocheck.conformance.cases.study_tables import MassDrop
from pantocheck.conformance.core.figure_data import DrawnSymbol
from pantocheck.conformance.core.files import check_writable, write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.execution.plan import split_names
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.dropper_rows import LengthMeaning
from pantocheck.conformance.line.elements.element import KINDS, DrawnMark
from pantocheck.conformance.line.elements.point_mass import PointMasses
from pantocheck.conformance.line.line_drawing import LineDrawing, draw_line_pdf, draw_line_svg, list_labelled_marks
from pantocheck.conformance.line.line_export import DecimalMark, export_droppers, export_supports, export_workbook
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_import import import_line
from pantocheck.conformance.runs.line_fmu import FmiVersion, build_line_fmu
from pantocheck.model import Catenary, discretise
from pantocheck.model.dynamics.line_image import GivenInput


def line_import_command(
    supports: Annotated[
        Path,
        typer.Argument(
            help=f"Table of the supports and both ends, or workbook (XLSX, ODS): {DocumentationPage.LINE_TABLES}."
        ),
    ],
    base: Annotated[
        Path, typer.Option(help="Line file with the wires, arms and damping, and the values of empty cells.")
    ],
    out: Annotated[Path, typer.Option(help="Line file to write.")],
    droppers: Annotated[
        Path | None,
        typer.Option(help="Table of the droppers. Default: the sheet of the workbook, or the base."),
    ] = None,
    dropper_lengths: Annotated[
        LengthMeaning,
        typer.Option(
            help="Meaning of the column length_m: published, for comparison only; or unloaded, so that the heights of "
            "the contact wire follow from the lengths."
        ),
    ] = "published",
) -> CommandOutput:
    """Write a line file from tables of supports and droppers.

    All problems of all files are reported at once, with file, row and column.

    Example: pantocheck line import supports.csv --droppers droppers.csv --base base.toml --out my-line.toml

    Then: pantocheck check my-line.toml
    """
    inputs = [path for path in (supports, droppers, base) if path is not None]
    if out.resolve() in [path.resolve() for path in inputs]:
        raise InputError(f"option --out {out}", "is a file of the import", "Give another name for the line file.")
    tree = import_line(base, supports, droppers, dropper_lengths)
    check_writable(out.parent)
    names = ", ".join(path.name for path in inputs)
    head = f"# Written by `pantocheck line import` from {names}.\n"
    write_atomically(out, (head + tomli_w.dumps(tree)).encode())
    geometry = tree["geometry"]
    facts = {
        "spans": len(geometry["span_list"]),
        "length_m": sum(span["length_m"] for span in geometry["span_list"]),
    }
    return CommandOutput(escape_text(f"{facts['spans']} spans, {facts['length_m']:g} m"), facts, files=(out,))


TABLE_FILES = {"csv": ("supports.csv", "droppers.csv"), "xlsx": ("line.xlsx",)}
"""Files of the tables of a line by their format."""


# `pantocheck line export`: tables of the supports and droppers of a line, or the line as FMU.
def line_export_command(
    line: Annotated[
        str, typer.Argument(help="Id of a case, or path of a case or line file.", autocompletion=complete_case)
    ],
    out: Annotated[Path | None, typer.Option(help="Folder of the tables.")] = None,
    formats: Annotated[
        str, typer.Option(help="csv: supports.csv and droppers.csv; xlsx: line.xlsx with both as sheets to fill in.")
    ] = "csv",
    decimal: Annotated[
        DecimalMark, typer.Option(help="Decimal mark; beside commas, columns are separated by semicolons.")
    ] = "point",
    fmu: Annotated[
        Path | None, typer.Option(help=f"FMU of the line of a case with a train: {DocumentationPage.FMU}.")
    ] = None,
    fmi: Annotated[FmiVersion, typer.Option(help="Version of FMI.")] = "3.0",
    given: Annotated[
        GivenInput, typer.Option("--input", help="Input of the FMU at each head: its height or its contact force.")
    ] = "height",
) -> CommandOutput:
    """Write a line as tables, or as FMU.

    `pantocheck line import` turns the tables, with the same line file as base, into the same line. An FMU holds the
    line of a case with its data and sources, compiled by the C compiler of this machine.

    Examples:

    pantocheck line export en50318-2018/ac-simple/static --out tables --decimal comma

    pantocheck line export en50318-2018/ac-simple/static --out tables --formats xlsx

    pantocheck line export en50318-2018/ac-simple/275 --fmu line.fmu
    """
    if out is None and fmu is None:
        raise InputError("line export", "has no file to write", "Give --out, --fmu or both.")
    line_file, files = read_line(line), list[Path]()
    if out is not None:
        chosen = split_names(formats)
        if unknown := [name for name in chosen if name not in TABLE_FILES]:
            raise InputError(f"format '{unknown[0]}'", "there is no such format", "Give csv, xlsx or csv,xlsx.")
        # Spreadsheets recognise UTF-8 by the byte order mark.
        contents = {
            "supports.csv": lambda: export_supports(line_file, decimal).encode("utf-8-sig"),
            "droppers.csv": lambda: export_droppers(line_file, decimal).encode("utf-8-sig"),
            "line.xlsx": lambda: export_workbook(line_file),
        }
        check_writable(out)
        for path in (out / name for kind in chosen for name in TABLE_FILES[kind]):
            write_atomically(path, contents[path.name]())
            files.append(path)
    if fmu is not None:
        check_writable(fmu.parent)
        write_atomically(fmu, build_line_fmu(choose_train_case(line, ()), fmi, given))
        files.append(fmu)
    spans = line_file.geometry.spans
    return CommandOutput(escape_text(f"{line_file.title}: {spans} spans"), {"spans": spans}, files=files)


# `pantocheck line draw`: drawing of a whole line, in elevation and in plan.
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

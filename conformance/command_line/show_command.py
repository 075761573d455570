"""`pantocheck show`: everything a case says, with where each number comes from."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from rich.console import RenderableType

    from pantocheck.conformance.cases.case import Case
    from pantocheck.conformance.input_files.sourced_table import SourcedTable


def show_command(
    case: Annotated[str, typer.Argument(help="Id, glob or path of a case file, e.g. en50318-2002/250")],
    at_rest: Annotated[
        bool,
        typer.Option("--at-rest", help="Compute the line at rest and the frequency response of the pantograph, too."),
    ] = False,
    drawing: Annotated[
        Path | None, typer.Option(help="SVG file to draw the line to, from the side and from above, to scale.")
    ] = None,
) -> None:
    """Show the inputs, the limits and the notes of a case, each with its trust and source.

    Examples:

    pantocheck show en50318-2018/ac-simple/275 --at-rest

    pantocheck show en50318-2018/ac-stitched/static --drawing line.svg
    """
    from pantocheck.conformance.cases.library import select_cases
    from pantocheck.conformance.command_line.console import console, escape_text
    from pantocheck.conformance.input_files.input_error import InputError

    output = console()
    chosen = _named(case, select_cases([case]))
    if drawing is not None:
        if any(one.line != chosen[0].line for one in chosen):
            raise InputError(f"case '{case}'", "these cases have several lines", "Draw one case at a time.")
        _draw(chosen[0], drawing)
    for one in chosen:
        for part in _parts(one):
            output.print(part)
        if at_rest:
            from pantocheck.conformance.command_line.rest_tables import build_rest_tables

            for part in build_rest_tables(one):
                output.print(part)
    if drawing is not None:
        output.print(escape_text(str(drawing)), soft_wrap=True)


def _named(pattern: str, found: "list[Case]") -> "list[Case]":
    """The cases asked for, without those they require."""
    exact = [case for case in found if case.id == pattern]
    needed = {required for case in found for required in case.file.requires}
    return exact or [case for case in found if case.id not in needed] or found


def _draw(case: "Case", path: Path) -> None:
    from pantocheck.conformance.input_files.atomic_writing import check_writable, write_atomically
    from pantocheck.conformance.simulation.catenary_model import build_catenary
    from pantocheck.conformance.simulation.line_drawing import draw_line
    from pantocheck.model import discretise

    check_writable(path.parent)
    # All spans are alike: a few show the line as well as all of them.
    short = case.line.model_copy(update={"geometry": case.line.geometry.shorten(6)})
    line = discretise(build_catenary(short), case.file.discretisation.element_m)
    write_atomically(path, draw_line(line, short.title, short.geometry).encode())


def _parts(case: "Case") -> list["RenderableType"]:
    from rich.padding import Padding
    from rich.table import Table
    from rich.text import Text

    from pantocheck.conformance.cases.library import source_text
    from pantocheck.conformance.command_line.console import escape_text, format_number

    parts: list[RenderableType] = [Text(f"{case.id}  ", "bold") + escape_text(case.file.title)]
    if not case.is_static:
        start, end = case.analysis_section
        parts.append(escape_text(f"{case.file.speed_km_h:g} km/h, evaluated {start:g} m to {end:g} m, {case.digest}"))
    mesh = case.file.discretisation
    parts.append(escape_text(f"mesh of the reference simulator: {mesh.element_m:g} m, {mesh.time_step_s:g} s"))
    inputs = Table("input", "value", "trust", "source", title="Inputs", title_justify="left", box=None, pad_edge=False)
    for name, table in case.sourced_tables.items():
        for key, value in _numbers(table):
            trust = "provisional" if key.split(".")[0] in table.provisional else table.trust
            inputs.add_row(escape_text(f"{name}.{key}"), escape_text(value), trust, escape_text(_short(table.source)))
    limits = Table(
        "limit", "lower", "upper", "trust", "source", title="Limits", title_justify="left", box=None, pad_edge=False
    )
    for limit in case.limits:
        item = f"[{limit.item}]" if limit.item else ""
        name = f"{limit.quantity}{item}{f', pantograph {limit.owner}' if limit.owner else ''}"
        limits.add_row(
            name, format_number(limit.lower), format_number(limit.upper), limit.trust, escape_text(_short(limit.source))
        )
    said = [*(table.source for table in case.sourced_tables.values()), *(limit.source for limit in case.limits)]
    keys = dict.fromkeys(key for source in said for key in _keys(source))
    sources = [escape_text(f"{key}: {source_text(key)}") for key in keys if source_text(key) != key]
    parts += [
        Padding(inputs, (1, 0, 0, 0)),
        Padding(limits if case.limits else escape_text("No limits: informative."), (1, 0, 0, 0)),
    ]
    parts += [Padding(escape_text(text), (1, 0, 0, 0)) for text in case.notes]
    return [*parts, Text(), *sources]


def _numbers(table: "SourcedTable") -> list[tuple[str, str]]:
    """Keys of a table as its file has them, tables inside it with dots; what was left out has no source to show."""
    said = {"trust", "source", "provisional", "note", "id", "title", "line", "model", "requires", "limit", "pantograph"}
    said |= {"mass_drop", "study"}  # groups of their own
    return _flat(table.model_dump(mode="json", exclude={*said, "discretisation"}, exclude_unset=True))


def _flat(values: dict[str, Any]) -> list[tuple[str, str]]:
    rows = []
    for key, value in values.items():
        if isinstance(value, dict):
            rows += [(f"{key}.{inner}", text) for inner, text in _flat(value)]
        else:
            rows.append((key, ", ".join(map(str, value)) if isinstance(value, list) else str(value)))
    return rows


def _keys(source: str | list[str]) -> list[str]:
    return [source] if isinstance(source, str) else source


def _short(source: str | list[str]) -> str:
    return ", ".join(_keys(source))

"""`pantocheck show`: content of a case, and the provenance of each number, as text and tables."""

import json
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import RenderableType
from rich.padding import Padding
from rich.text import Text

from pantocheck.conformance.app.commands.cases_option import CasesOption, complete_case
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import FittedTable, build_table, escape_text, format_number
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.cases.library import leave_out_required, select_cases, source_text
from pantocheck.conformance.core.files import check_writable, write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.sourced_table import PROVENANCE, SourcedTable
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.grading.derived_facts import list_law_forces
from pantocheck.conformance.quantities.limit_text import name_value

OTHER_TABLES = {"id", "title", "line", "model", "requires", "limit", "reading", "pantograph", "mass_drop", "study"}
"""Keys of a case file that are not inputs, or that have a table of their own."""


def build_case_tables(case: Case) -> list[RenderableType]:
    """Header, inputs, limits, notes and sources of a case."""
    mesh = case.file.discretisation
    parts: list[RenderableType] = [Text(f"{case.id}  ", "bold") + escape_text(case.file.title)]
    if not case.is_static:
        start, end = case.analysis_section
        parts.append(escape_text(f"{case.file.speed_km_h:g} km/h, analysis section {start:g} m to {end:g} m"))
        places = ", ".join(f"{place:g} m" for place in case.start_positions)
        noun = "pantographs" if len(case.pantographs) > 1 else "pantograph"
        parts.append(escape_text(f"start of the {noun}: {places}"))
    if case.file.requires:
        remark = "added to a run; this case is skipped if a required case fails or ends with an error"
        parts.append(escape_text(f"requires: {', '.join(case.file.requires)} ({remark})"))
    for number, force in list_law_forces(case).items():
        parts.append(escape_text(f"force law of pantograph {number}: {force.text}"))
    parts.append(escape_text(f"mesh of the reference simulator: {mesh.element_m:g} m, {mesh.time_step_s:g} s"))
    parts.append(Text(case.digest, overflow="fold"))
    if case.origin is not None:
        parts.append(escape_text(f"not in the library: {case.origin.text}; its author states inputs, limits and trust"))
    blocks: list[RenderableType] = [_build_input_table(case)]
    blocks.append(
        _build_limit_table(case)
        if case.limits
        else escape_text("No published limits: the EN 50318 criteria do not judge this case.")
    )
    blocks += [escape_text(text) for text in case.notes]
    return [*parts, *(Padding(block, (1, 0, 0, 0)) for block in blocks), Text(), *_list_sources(case)]


def describe_case(case: Case) -> dict[str, object]:
    """Inputs, limits, notes and digest of a case for a program."""
    return {
        "id": case.id,
        "title": case.file.title,
        "digest": case.digest,
        "requires": list(case.file.requires),
        "start_m": list(case.start_positions),
        "analysis_section_m": None if case.is_static else list(case.analysis_section),
        "inputs": {name: table.model_dump(mode="json") for name, table in case.sourced_tables.items()},
        "limits": [limit.model_dump(mode="json") for limit in case.limits],
        "notes": list(case.notes),
    }


def _build_input_table(case: Case) -> FittedTable:
    """Inputs by table of the files; the row of a table states the source of its keys."""
    table = build_table("input", "value", "trust", title="Inputs", unbroken=("input", "trust"))
    for name, sourced in case.sourced_tables.items():
        source = escape_text(f"source: {', '.join(_source_keys(sourced.source))}")
        excluded = {*PROVENANCE, *OTHER_TABLES, "discretisation"}
        excluded |= {key for key, content in sourced if isinstance(content, SourcedTable)}
        # Defaults have no source, so only the keys that the file gives are shown.
        values = sourced.model_dump(mode="json", exclude=excluded, exclude_unset=True)
        for path, inputs in _split_tables(name, values):
            table.add_row(escape_text(path), source if path == name else "", "")
            for key, value in inputs.items():
                top_key = key if path == name else path.removeprefix(f"{name}.").split(".")[0]
                trust = "provisional" if top_key in sourced.provisional else sourced.trust
                table.add_row(escape_text(f"  {key}"), escape_text(_format_input(value)), trust)
    return table


def _format_input(value: object) -> str:
    """Value without quotes; the tables of a list are numbered, one per line, equal neighbours together."""
    if not isinstance(value, list):
        return str(value)
    if not (value and isinstance(value[0], dict)):
        return ", ".join(map(str, value))
    lines, last = [], 0
    for text, equal in groupby(
        ", ".join(f"{key} = {_format_inline(part)}" for key, part in row.items()) for row in value
    ):
        first, last = last + 1, last + len(list(equal))
        lines.append(f"{first if first == last else f'{first}-{last}'}: {text}")
    return "\n".join(lines)


def _format_inline(value: object) -> str:
    """Value inside a table, as in TOML but without quotes."""
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{key} = {_format_inline(part)}' for key, part in value.items())} }}"
    return f"[{', '.join(map(_format_inline, value))}]" if isinstance(value, list) else str(value)


def _split_tables(path: str, values: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Table without the tables inside it, followed by each of those with its dotted path."""
    yield path, {key: value for key, value in values.items() if not isinstance(value, dict)}
    for key, value in values.items():
        if isinstance(value, dict):
            yield from _split_tables(f"{path}.{key}", value)


def _build_limit_table(case: Case) -> FittedTable:
    numbers = ("lower", "upper")
    table = build_table(
        "limit", *numbers, "trust", "source", title="Limits", unbroken=(*numbers, "trust"), right=numbers
    )
    for limit in case.limits:
        pantograph = f", pantograph {limit.owner}" if limit.owner else ""
        table.add_row(
            escape_text(name_value(limit.quantity, limit.item) + pantograph),
            format_number(limit.lower),
            format_number(limit.upper),
            limit.trust,
            escape_text(", ".join(_source_keys(limit.source))),
        )
    return table


def _list_sources(case: Case) -> list[Text]:
    """Full text of the sources that are cited by key."""
    cited = [*(table.source for table in case.sourced_tables.values()), *(limit.source for limit in case.limits)]
    keys = dict.fromkeys(key for source in cited for key in _source_keys(source))
    return [escape_text(f"{key}: {source_text(key)}") for key in keys if source_text(key) != key]


def _source_keys(source: str | list[str]) -> list[str]:
    return [source] if isinstance(source, str) else source


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
        from pantocheck.conformance.runs.command_system import build_case_message

        if len(cases) != 1:
            raise InputError("option --request", f"the pattern selects {len(cases)} cases", "Give the id of one case.")
        check_writable(request.parent)
        write_atomically(request, (json.dumps(build_case_message(cases[0]), indent=1) + "\n").encode())
    parts: list[RenderableType] = []
    if derived or at_rest:  # the model of the line
        from pantocheck.conformance.app.commands.computed_tables import build_derived_tables, build_rest_tables
    for each in cases:
        tables = [*(build_derived_tables(each) if derived else []), *(build_rest_tables(each) if at_rest else [])]
        parts += [*build_case_tables(each), *tables]
    return CommandOutput(
        Text(),
        [describe_case(each) for each in cases],
        parts,
        files=[] if request is None else [request],
    )

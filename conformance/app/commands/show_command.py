"""`pantocheck show`: content of a case, and the provenance of each number, as text and tables."""

import json
from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from pydantic import BaseModel
from rich.console import RenderableType
from rich.padding import Padding
from rich.text import Text

from pantocheck.conformance.app.commands.cases_option import CasesOption, complete_case, leave_out_required
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import FittedTable, build_table, escape_text, format_number
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.cases.library import select_cases, source_text
from pantocheck.conformance.core.files import check_writable, write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.sourced_table import PROVENANCE, SourcedTable
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.core.validation_messages import describe_field
from pantocheck.conformance.grading.derived_facts import list_law_forces
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.quantities.limit_text import name_value
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.runs.command_system import build_case_message
from pantocheck.conformance.runs.derived_values import build_derived
from pantocheck.conformance.runs.static_quantities import (
    compute_quantities_along_line,
    compute_static_quantities,
    first_modes,
    sample_span,
)
from pantocheck.model import discretise
from pantocheck.model.description.pantograph import apparent_mass

OTHER_TABLES = {"id", "title", "line", "model", "requires", "limit", "reading", "pantograph", "mass_drop", "study"}
"""Keys of a case file that are no inputs, or that have a table of their own."""


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


# Tables of `pantocheck show --derived`: values that follow from the inputs of a case, and their meaning.
MOST_ENTRIES = 12
"""Longest list that is printed in full; of a longer one, the first and the last entries are printed."""


def build_derived_tables(case: Case) -> list[RenderableType]:
    """Derived values of a case; of a list by span, those of the middle span."""
    derived, middle = build_derived(case), case.line.middle_span
    parts: list[tuple[str, BaseModel | None]] = [("line", derived.line), ("train", derived.train)]
    tables = []
    for name, part in parts:
        if part is None:
            continue
        title = f"Derived values: {name} (lists by span: span {middle})"
        rows = (map(escape_text, row) for row in _rows(part, case.line.geometry.spans, middle))
        table = build_table("key", "value", "meaning", title=title, unbroken=("key",), rows=map(tuple, rows))
        tables.append(Padding(table, (1, 0, 0, 0)))
    return [*tables]


def _rows(table: BaseModel, spans: int, middle: int, prefix: str = "") -> Iterator[tuple[str, str, str]]:
    """Dotted key, value and description of every value of nested tables."""
    for key in type(table).model_fields:
        value = getattr(table, key)
        if isinstance(value, BaseModel):
            yield from _rows(value, spans, middle, f"{prefix}{key}.")
        elif isinstance(value, tuple) and value and isinstance(value[0], BaseModel):
            for number, part in enumerate(value, 1):
                yield from _rows(part, spans, middle, f"{prefix}{key} {number}.")
        else:
            yield f"{prefix}{key}", _format_value(value, spans, middle), describe_field(type(table), key)


def _format_value(value: object, spans: int, middle: int) -> str:
    if not isinstance(value, tuple):
        return str(value)
    if value and isinstance(value[0], tuple):
        lists = value[middle - 1 : middle] if len(value) == spans else value
        return "; ".join(_format_value(part, spans, middle) for part in lists)
    entries = list(map(str, value))
    if len(entries) > MOST_ENTRIES:
        entries = [*entries[:3], f"... {len(entries)} values ...", *entries[-2:]]
    return ", ".join(entries)


# Tables of `pantocheck show --at-rest`: the line under its weight, and the pantographs on a test rig.
FREQUENCIES_Hz = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0)

ALONG_SPAN = "_along_span_mm_N"
"""End of the names of quantities that have one value per position in a span."""


def build_rest_tables(case: Case) -> list[RenderableType]:
    """Quantities of the line at rest, elasticity along a span and of listed spans, apparent mass of each pantograph."""
    element = case.file.discretisation.element_m
    line = discretise(build_catenary(case.line), element)
    quantities = compute_static_quantities(case, line)
    quantities.setdefault("natural_frequency_Hz", tuple(map(float, first_modes(case.line, element).frequency)))
    tables = [
        _build_quantity_table(quantities),
        _build_elasticity_table(case, quantities),
        *_build_span_tables(case, compute_quantities_along_line(case.line, line)),
        *map(_build_apparent_mass_table, dict.fromkeys(case.pantograph_files)),
    ]
    return [Padding(table, (1, 0, 0, 0)) for table in tables]


def _build_quantity_table(quantities: dict[str, Value]) -> FittedTable:
    title = "Line at rest, middle span"
    table = build_table("quantity", "value", "unit", "definition", title=title, unbroken=("quantity", "unit"))
    for name, value in quantities.items():
        if not name.endswith(ALONG_SPAN):
            quantity = QUANTITIES[name]
            text = ", ".join(map(format_number, _as_sequence(value)))
            table.add_row(escape_text(name), escape_text(text), quantity.unit, escape_text(quantity.definition))
    return table


def _build_elasticity_table(case: Case, quantities: dict[str, Value]) -> FittedTable:
    table = _build_number_table(
        "Elasticity along the span", "position in the span [m]", "small load [mm/N]", "200 N [mm/N]"
    )
    small, large = (_as_sequence(quantities[f"{name}{ALONG_SPAN}"]) for name in ("elasticity", "elasticity_200_N"))
    start, end = case.line.geometry.span(case.line.middle_span)
    for x, at_small_load, at_large_load in zip(sample_span(0.0, end - start), small, large, strict=True):
        table.add_row(f"{x:.2f}", format_number(at_small_load), format_number(at_large_load))
    return table


def _build_span_tables(case: Case, along_line: dict[str, Value]) -> Iterator[FittedTable]:
    """Elasticity of every span, if the spans of the line are listed."""
    if not along_line:
        return
    names = ("elasticity", "elasticity_200_N")
    columns = [f"{name}_{key}" for name in names for key in ("of_spans_mm_N", "non_uniformity_of_spans_pct")]
    headings = ("small load [mm/N]", "non-uniformity [%]", "200 N [mm/N]", "non-uniformity at 200 N [%]")
    table = _build_number_table("Largest elasticity of every span", "span", "length [m]", *headings)
    values = (_as_sequence(along_line[column]) for column in columns)
    for number, row in enumerate(zip(case.line.geometry.span_lengths, *values, strict=True), 1):
        table.add_row(str(number), *map(format_number, row))
    yield table


def _build_apparent_mass_table(model: PantographFile) -> FittedTable:
    title = f"Apparent mass at the head: {model.title}"
    table = _build_number_table(title, "frequency [Hz]", "magnitude [kg]", "phase [deg]")
    masses = apparent_mass(build_pantograph(model, 0.0, 0.0), np.array(FREQUENCIES_Hz))
    for frequency, mass in zip(FREQUENCIES_Hz, masses, strict=True):
        table.add_row(format_number(frequency), format_number(abs(mass)), f"{np.degrees(np.angle(mass)):.1f}")
    return table


def _build_number_table(title: str, *headings: str) -> FittedTable:
    return build_table(*headings, title=title, right=headings)


def _as_sequence(value: Value) -> Sequence[float | None]:
    return value if isinstance(value, tuple) else (value,)


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
        if len(cases) != 1:
            raise InputError("option --request", f"the pattern selects {len(cases)} cases", "Give the id of one case.")
        check_writable(request.parent)
        write_atomically(request, (json.dumps(build_case_message(cases[0]), indent=1) + "\n").encode())
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

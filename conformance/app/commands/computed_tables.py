"""Tables of `pantocheck show` with computed values: those that follow from the inputs, and the line at rest."""

from collections.abc import Iterator, Sequence

import numpy as np
from pydantic import BaseModel
from rich.console import RenderableType
from rich.padding import Padding

from pantocheck.conformance.app.commands.console import FittedTable, build_table, escape_text, format_number
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.validation_messages import describe_field
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.runs.derived_values import build_derived
from pantocheck.conformance.runs.static_quantities import (
    compute_quantities_along_line,
    compute_static_quantities,
    first_modes,
    sample_span,
)
from pantocheck.model import discretise
from pantocheck.model.description.pantograph import apparent_mass

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

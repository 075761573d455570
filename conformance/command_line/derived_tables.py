"""Tables of `pantocheck show --derived`: values that follow from the inputs of a case, and their meaning."""

from collections.abc import Iterator

from pydantic import BaseModel
from rich.console import RenderableType
from rich.padding import Padding

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.command_line.console import build_table, escape_text
from pantocheck.conformance.input_files.key_descriptions import describe_field
from pantocheck.conformance.simulation.derived_values import build_derived

MOST_ENTRIES = 12
"""Longest list that is printed in full; of a longer one, the first and the last entries are printed."""


def build_derived_tables(case: Case) -> list[RenderableType]:
    """Derived values of a case; of a list by span, those of the middle span.

    Args:
        case: Any case, with or without a speed.
    """
    derived, middle = build_derived(case), case.line.middle_span
    parts: list[tuple[str, BaseModel | None]] = [("line", derived.line), ("train", derived.train)]
    tables = []
    for name, part in parts:
        if part is None:
            continue
        title = f"Derived values: {name} (lists by span: span {middle})"
        table = build_table("key", "value", "meaning", title=title, unbroken=("key",))
        for path, value, meaning in _rows(part, case.line.geometry.spans, middle):
            table.add_row(escape_text(path), escape_text(value), escape_text(meaning))
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

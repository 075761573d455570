"""Import of a line from tables of its supports and droppers; a base line file holds all other data."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.sourced_table import PROVENANCE
from pantocheck.conformance.core.spreadsheet import Spreadsheet, read_spreadsheet
from pantocheck.conformance.core.toml_file import read_toml, validate_model
from pantocheck.conformance.core.workbook_reading import WORKBOOK_SUFFIXES, list_sheet_names
from pantocheck.conformance.line.dropper_rows import (
    LengthMeaning,
    SpanRows,
    build_schedule,
    find_droppers_outside,
    find_height_problems,
    group_by_span,
    hang_line_on_droppers,
    locate_droppers,
)
from pantocheck.conformance.line.geometry import ListedSpans
from pantocheck.conformance.line.line_columns import (
    DROPPER_COLUMNS,
    DROPPER_SHEET,
    SUPPORT_COLUMNS,
    SUPPORT_KEYS,
    SUPPORT_SHEET,
    TypedRow,
    read_typed_rows,
)
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.support_rows import build_support_tables, locate_supports, read_span_lengths
from pantocheck.conformance.line.support_table import LIMIT_VALUES

REPLACED = frozenset({"span_m", "spans", "span_list", "schedule", "support", "gradient"}) | PROVENANCE
"""Keys of `geometry` in the base file that the tables replace."""

T = TypeVar("T")


def import_line(
    base: Path, supports: Path, droppers: Path | None, lengths: LengthMeaning = "published"
) -> dict[str, Any]:
    """Import a line from tables.

    Args:
        base: Line file with the wires, droppers, steady arm, messenger support and damping, and the values of empty
            cells.
        supports: Table of the supports and both ends of the line, or a workbook.
        droppers: Table of the droppers; None: the sheet `droppers` of the workbook or, without it, every span has those
            of the table [droppers] of the base file.
        lengths: Meaning of the lengths of the droppers: published lengths do not change the line; unloaded lengths
            determine the heights of the contact wire.

    Returns:
        Content of a line file with listed spans.

    Raises:
        InputError: A file cannot be read, or the line is invalid. The error lists all problems, with file, row and
            column.
    """
    problems: list[InputError] = []
    tree = _try(problems, lambda: read_toml(base, "line")) or {}
    base_line = _try(problems, lambda: validate_model(tree, LineFile, f"line '{base.name}'")) if tree else None
    if droppers is None and supports.suffix.lower() in WORKBOOK_SUFFIXES:
        names = _try(problems, lambda: list_sheet_names(supports, f"table '{supports.name}'")) or []
        droppers = supports if DROPPER_SHEET in (name.strip().lower() for name in names) else None
    support_table = _try(problems, lambda: read_spreadsheet(supports, SUPPORT_SHEET))
    dropper_table = None if droppers is None else _try(problems, lambda: read_spreadsheet(droppers, DROPPER_SHEET))
    if base_line is None or support_table is None or (droppers is not None and dropper_table is None):
        raise join_errors(problems)
    rows = read_typed_rows(support_table, SUPPORT_COLUMNS, problems)
    problems += _find_lost_values(base_line, f"line '{base.name}'", rows, with_droppers=droppers is not None)
    span_lengths = read_span_lengths(rows, support_table.where, problems)
    groups = {} if dropper_table is None else _read_droppers(dropper_table, len(span_lengths), problems)
    problems += [*find_droppers_outside(groups, span_lengths), *find_height_problems(groups, lengths)]
    names = list(dict.fromkeys(path.name for path in (supports, droppers) if path is not None))
    geometry = {key: value for key, value in tree["geometry"].items() if key not in REPLACED}
    geometry["source"] = f"{' and '.join(names)}, other values from {base.name}"[:500]
    spans: list[dict[str, Any]] = [{} if length is None else {"length_m": length} for length in span_lengths]
    for number, group in groups.items():
        if group:
            spans[number - 1]["droppers"] = build_schedule(group)
    geometry |= {"span_list": spans, "support": build_support_tables(rows)}
    line = tree | {"geometry": geometry}
    places = locate_supports(rows) | locate_droppers(groups)
    unused = () if dropper_table is None else ("droppers.x_m",)
    problems += _find_line_problems(line, f"line '{base.name}' with {' and '.join(names)}", places, unused)
    if problems:
        raise _join_problems(problems)
    if dropper_table is not None and lengths == "unloaded":
        line = hang_line_on_droppers(line, dropper_table.where)
    return shorten_line(line, base_line)


def _try(problems: list[InputError], read: Callable[[], T]) -> T | None:
    """Result of a reader; None if it fails, with its error added to the problems."""
    try:
        return read()
    except InputError as error:
        problems.append(error)
        return None


def _read_droppers(table: Spreadsheet, spans: int, problems: list[InputError]) -> SpanRows:
    return group_by_span(read_typed_rows(table, DROPPER_COLUMNS, problems), spans, table.where, problems)


def _find_lost_values(base: LineFile, where: str, rows: list[TypedRow], with_droppers: bool) -> list[InputError]:
    """Values of single supports, gradients and spans of the base file for which the tables have no column."""
    geometry = base.geometry
    if not isinstance(geometry, ListedSpans):
        return []
    problems = []
    filled = {SUPPORT_KEYS[column] for row in rows for column in row.values if column in SUPPORT_KEYS}
    stated = {
        (key, inner) if isinstance(value, dict) else (key,)
        for support in geometry.support
        for key, value in support.model_dump(exclude_none=True, exclude={"number"}).items()
        for inner in (value if isinstance(value, dict) else (key,))
    }
    lost = sorted("_".join(path) for path in stated - filled)
    if lost:
        problems.append(
            InputError(
                f"{where}, key geometry.support",
                f"supports have their own {', '.join(lost)}, and the table of supports does not",
                "Add these columns to the table, or remove the keys from the base file.",
            )
        )
    if geometry.gradient and not all("contact_wire_height_m" in row.values for row in rows):
        problems.append(
            InputError(
                f"{where}, key geometry.gradient",
                "the table of supports replaces the gradients, but does not give every contact wire height",
                "Fill the column contact_wire_height_m, or remove the gradients from the base file.",
            )
        )
    if not with_droppers and any(span.droppers is not None for span in geometry.span_list):
        problems.append(
            InputError(f"{where}, key geometry.span_list", "spans have their own droppers", "Give --droppers as well.")
        )
    return problems


def _find_line_problems(
    line: dict[str, Any], where: str, places: dict[str, str], unused: tuple[str, ...]
) -> Iterator[InputError]:
    """Problems of a line with the place of each in its table; those of unused keys are left out."""
    try:
        validate_model(line, LineFile, where)
    except InputError as error:
        for problem in error.problems:
            key = problem.where.removeprefix(f"{where}, key ").partition(" (number ")[0]
            # The readers of the tables report empty cells, and spans that have no droppers of their own.
            empty_cell = problem.found == "missing" and key.startswith("geometry.span_list")
            if not empty_cell and not key.startswith(unused):
                yield InputError(_locate(key, places) or problem.where, problem.found, problem.hint)


def _join_problems(problems: list[InputError]) -> InputError:
    """One error of all problems; a cell has its first problem only, because others follow from it."""
    kept = {problem.where if ", column " in problem.where else str(problem): problem for problem in reversed(problems)}
    return join_errors(list(reversed(kept.values())))


def _locate(key: str, places: dict[str, str]) -> str | None:
    """Place of a key, or of the table that contains it."""
    while key:
        if key in places:
            return places[key]
        key = key.rpartition("." if key.rfind(".") > key.rfind("[") else "[")[0]
    return None


# Short form of an imported line: named dropper schedules, and values of all supports in one place.
def shorten_line(line: dict[str, Any], base: LineFile) -> dict[str, Any]:
    """Shorten a line without a change of its meaning.

    Args:
        line: Content of a line file with all values of every span and support.
        base: Line with the same tables `droppers`, `steady_arm` and `messenger_support`.

    Returns:
        Content of a line file: equal schedules share a name, a value that all supports share is that of the line, and
        values of arms, messenger supports and droppers that are those of the base are left out.
    """
    geometry = _move_common_values(line["geometry"])
    supports = [_drop_base_values(support, base) for support in geometry.pop("support")]
    common = base.droppers.schedule.model_dump(exclude_none=True)
    schedules: dict[str, dict[str, Any]] = {}
    spans = []
    for span in geometry["span_list"]:
        short, schedule = {"length_m": span["length_m"]}, span.get("droppers")
        if schedule is not None and {key: tuple(values) for key, values in schedule.items()} != common:
            short["droppers"] = _name_schedule(schedule, span["length_m"], schedules)
        spans.append(short)
    geometry["span_list"] = spans
    if schedules:
        geometry["schedule"] = schedules
    if own := [support for support in supports if support.keys() != {"number"}]:
        geometry["support"] = own
    return line | {"geometry": geometry}


def _move_common_values(geometry: dict[str, Any]) -> dict[str, Any]:
    """Geometry with the heights that all supports share, and with staggers that alternate, as values of the line."""
    supports, moved = geometry["support"], {}
    for key, value in LIMIT_VALUES.items():
        first, factor = supports[0].get(key), value.factor
        if first is not None and all(support.get(key) == first * factor ** support["number"] for support in supports):
            moved[key] = first
    short = [{key: value for key, value in support.items() if key not in moved} for support in supports]
    return geometry | moved | {"support": short}


def _drop_base_values(support: dict[str, Any], base: LineFile) -> dict[str, Any]:
    """Support without the values of its arm and messenger support that are those of the base."""
    short: dict[str, Any] = {}
    for key, value in support.items():
        if not isinstance(value, dict):
            short[key] = value
        elif own := {name: item for name, item in value.items() if getattr(getattr(base, key), name, None) != item}:
            short[key] = own
    return short


def _name_schedule(schedule: dict[str, Any], length: float, schedules: dict[str, dict[str, Any]]) -> str:
    """Name of a schedule by the length of its first span; equal schedules share a name."""
    for name, known in schedules.items():
        if known == schedule:
            return name
    name, count = f"{length:g} m", 1
    while name in schedules:
        count += 1
        name = f"{length:g} m ({count})"
    schedules[name] = schedule
    return name

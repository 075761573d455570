"""Import of a line from tables of its supports and droppers; a base line file holds all other data."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

from pantocheck.conformance.cases.geometry import ListedSpans
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.input_files.input_error import InputError, join_errors
from pantocheck.conformance.input_files.sourced_table import PROVENANCE
from pantocheck.conformance.input_files.spreadsheet import Spreadsheet, read_spreadsheet
from pantocheck.conformance.input_files.toml_file import read_toml, validate_model
from pantocheck.conformance.line_tables.dropper_heights import hang_line_on_droppers
from pantocheck.conformance.line_tables.dropper_rows import (
    LengthMeaning,
    SpanRows,
    build_schedule,
    find_droppers_outside,
    find_height_problems,
    group_by_span,
    locate_droppers,
)
from pantocheck.conformance.line_tables.line_columns import DROPPER_COLUMNS, SUPPORT_COLUMNS, SUPPORT_KEYS
from pantocheck.conformance.line_tables.short_line import shorten_line
from pantocheck.conformance.line_tables.support_rows import (
    build_support_tables,
    locate_supports,
    read_span_lengths,
)
from pantocheck.conformance.line_tables.typed_rows import TypedRow, read_typed_rows

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
        supports: Table of the supports and both ends of the line.
        droppers: Table of the droppers; None: every span has those of the table [droppers] of the base file.
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
    support_table = _try(problems, lambda: read_spreadsheet(supports))
    dropper_table = None if droppers is None else _try(problems, lambda: read_spreadsheet(droppers))
    if base_line is None or support_table is None or (droppers is not None and dropper_table is None):
        raise join_errors(problems)
    rows = read_typed_rows(support_table, SUPPORT_COLUMNS, problems)
    problems += _find_lost_values(base_line, f"line '{base.name}'", rows, with_droppers=droppers is not None)
    span_lengths = read_span_lengths(rows, support_table.where, problems)
    groups = {} if dropper_table is None else _read_droppers(dropper_table, len(span_lengths), problems)
    problems += [*find_droppers_outside(groups, span_lengths), *find_height_problems(groups, lengths)]
    names = [path.name for path in (supports, droppers) if path is not None]
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

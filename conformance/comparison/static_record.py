"""Static record: contact wire heights and elasticities measured along a line, with their sidecar."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, get_args

import numpy as np
from pydantic import Field

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.sourced_table import Positive, PositiveList, Problems, cross_check, validation_problem
from pantocheck.conformance.core.table_sidecar import (
    NamedTableSidecar,
    TableRecord,
    read_named_columns,
    read_sidecar,
    record_digest,
)
from pantocheck.conformance.core.validation_messages import MOST_NAMED_ROWS, name_rows
from pantocheck.conformance.line.geometry import Geometry
from pantocheck.conformance.results.comparison_format import StaticValue

STATIC_SCHEMA = "pantocheck.static/1"

STATIC_VALUES: tuple[StaticValue, ...] = get_args(StaticValue)

COLUMN_UNITS = {"position": "m", "elasticity": "m_N", "contact_wire_height": "m"}
"""Columns of the table, with their SI unit as at the end of a key."""

USUAL_COLUMNS = ["position_m", "elasticity_mm_N", "contact_wire_height_m"]

LARGEST_TABLE = 300_000
"""Largest number of values in a table: a position every 0.5 m along 40 km, with both values."""


class StaticSidecar(NamedTableSidecar):
    """Sidecar of a table of contact wire heights and elasticities."""

    schema_: Annotated[Literal["pantocheck.static/1"], Field(alias="schema")]
    """Version of the format: "pantocheck.static/1"."""
    force_N: Annotated[PositiveList | None, Field(max_length=2)] = None
    """Static force of the elasticity [N]: one force, for the uplift from rest over the force; or two, for the
    difference of the uplifts over the difference of the forces.
    """
    line_start_m: Annotated[float, Field(ge=-1e7, le=1e7)] = 0.0
    """Position of the start of the line, as the table counts [m]."""
    positions: Literal["increasing", "decreasing"] = "increasing"
    """Direction in which the table counts positions, from the start of the line to its end."""
    datum_m: Annotated[float, Field(ge=-100, le=100)] = 0.0
    """Height of the datum of the line, as the table counts [m]."""
    evaluated_spans: Annotated[tuple[int, int] | None, Field(strict=False)] = None
    """First and last span of the evaluated section, from 1; default: all spans."""
    largest_distance_m: Positive | None = None
    """Largest distance between neighbouring measured positions of a complete record [m]."""
    elasticity_uncertainty_mm_N: Positive | None = None
    """Half-width of the 95 % interval of a measured elasticity [mm/N]."""
    height_uncertainty_mm: Positive | None = None
    """Half-width of the 95 % interval of a measured contact wire height [mm]."""

    @cross_check
    def _check_consistency(self) -> Problems:
        if self.force_N is not None and len(self.force_N) == 2 and self.force_N[0] >= self.force_N[1]:
            yield validation_problem(
                "force_N", "the second force is not greater than the first", "Give the smaller force first."
            )
        if self.evaluated_spans is not None and not 1 <= self.evaluated_spans[0] <= self.evaluated_spans[1]:
            yield validation_problem(
                "evaluated_spans",
                f"{list(self.evaluated_spans)} are not a first and a last span",
                "Give the first and the last span, numbered from 1, e.g. [2, 9].",
            )


@dataclass(frozen=True)
class StaticRecord(TableRecord[StaticSidecar]):
    """Values measured along a line, by increasing position; NaN marks a missing value."""

    position: RealArray
    """Positions from the start of the line, (n,) [m]."""
    values: dict[StaticValue, RealArray]
    """Elasticities [m/N]; contact wire heights above the datum of the line [m]; (n,) each."""


def read_static_table(path: Path) -> StaticRecord:
    """Read a static record without regard to its line.

    Args:
        path: Table, or its sidecar; both have the same stem.

    Returns:
        The record.

    Raises:
        InputError: A file is missing or damaged; a column is unknown, missing, repeated or empty; a value is infinite,
            a position is missing, or an elasticity is not positive; the sidecar lacks the force of the elasticities.
    """
    sidecar, table = read_sidecar(path, StaticSidecar)
    where = f"record '{table.name}'"
    known = [f"{stem}_{unit}" for stem, unit in COLUMN_UNITS.items()]
    named = read_named_columns(table, sidecar, known, USUAL_COLUMNS, LARGEST_TABLE)
    columns = {stem: named[name].values for stem, name in zip(COLUMN_UNITS, known, strict=True) if name in named}
    if "position" not in columns:
        raise InputError(where, "has no positions", f"Store {USUAL_COLUMNS[0]}, from the start of the line.")
    direction = 1.0 if sidecar.positions == "increasing" else -1.0
    position = direction * (columns["position"] - sidecar.line_start_m)
    values: dict[StaticValue, RealArray] = {name: columns[name] for name in STATIC_VALUES if name in columns}
    if "contact_wire_height" in values:
        values["contact_wire_height"] = values["contact_wire_height"] - sidecar.datum_m
    if not values:
        raise InputError(where, "has no measured value", f"Store {' or '.join(USUAL_COLUMNS[1:])} beside the position.")
    problems = list(_find_row_problems(where, position, values))
    if "elasticity" in values and sidecar.force_N is None:
        hint = (
            "Give the force of the elasticities, e.g. force_N = [100.0], or both forces of a difference; droppers that "
            "slacken make the elasticity depend on it."
        )
        problems.insert(0, InputError(f"sidecar '{path.with_suffix('.toml').name}', key force_N", "missing", hint))
    if problems:
        raise join_errors(problems)
    order = np.argsort(position, kind="stable")
    return StaticRecord(
        table.name,
        record_digest(path, table),
        sidecar,
        order + 1,
        position[order],
        {name: measured[order] for name, measured in values.items()},
    )


def read_static_record(path: Path, geometry: Geometry) -> StaticRecord:
    """Read a static record of a line.

    Args:
        path: Table, or its sidecar; both have the same stem.
        geometry: Spans of the line.

    Returns:
        The record.

    Raises:
        InputError: The record is invalid (`read_static_table`), has a position outside the line, or names other spans
            than the line has.
    """
    record = read_static_table(path)
    if problems := list(_find_line_problems(path.with_suffix(".toml"), record, geometry)):
        raise join_errors(problems)
    return record


def _find_row_problems(where: str, position: RealArray, values: dict[StaticValue, RealArray]) -> Iterator[InputError]:
    """Missing positions, infinite values, and elasticities that are not positive."""
    if (missing := np.flatnonzero(~np.isfinite(position))).size:
        yield InputError(
            f"{where}, {name_rows(missing + 1)}", "the position is missing", "Give the position of each row."
        )
    for name, measured in values.items():
        if np.isnan(measured).all():
            yield InputError(f"{where}, {_in_words(name)}", "the column holds no value", "Remove the column.")
        if (infinite := np.flatnonzero(np.isinf(measured))).size:
            yield InputError(
                f"{where}, {name_rows(infinite + 1)}", f"the {_in_words(name)} is infinite", "Write nan for no value."
            )
    if (wrong := np.flatnonzero(values.get("elasticity", np.ones(1)) <= 0)).size:
        yield InputError(
            f"{where}, {name_rows(wrong + 1)}",
            "the elasticity is not positive",
            "A force lifts the wire: correct the value, or write nan for no value.",
        )


def _find_line_problems(path: Path, record: StaticRecord, geometry: Geometry) -> Iterator[InputError]:
    """Positions outside the line, and data of the sidecar that do not fit its spans."""
    where, sidecar = f"sidecar '{path.name}'", record.sidecar
    if sidecar.evaluated_spans is not None and sidecar.evaluated_spans[1] > geometry.spans:
        yield InputError(
            f"{where}, key evaluated_spans",
            f"span {sidecar.evaluated_spans[1]} does not exist",
            f"The line has {geometry.spans} spans.",
        )
    if sidecar.largest_distance_m is not None and sidecar.largest_distance_m > geometry.shortest_span:
        yield InputError(
            f"{where}, key largest_distance_m",
            f"{sidecar.largest_distance_m:g} m is longer than the shortest span of {geometry.shortest_span:g} m",
            "Give a smaller distance: a complete record has values in every span.",
        )
    outside = np.flatnonzero((record.position < 0) | (record.position > geometry.length))
    if outside.size:
        positions = ", ".join(f"{x:g} m" for x in record.position[outside][:MOST_NAMED_ROWS])
        yield InputError(
            f"record '{record.source}', {name_rows(record.row[outside])}",
            f"the position is not on the line: {positions} from its start",
            f"The line ends at {geometry.length:g} m. If the table counts otherwise, give line_start_m and "
            "positions in the sidecar.",
        )


def _in_words(name: str) -> str:
    return name.replace("_", " ")

"""Static record: contact wire heights and elasticities measured along a line."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from pantocheck.conformance.array_types import IntegerArray, RealArray
from pantocheck.conformance.cases.geometry import Geometry
from pantocheck.conformance.comparison.static_sidecar import StaticSidecar
from pantocheck.conformance.input_files.input_error import InputError, join_errors
from pantocheck.conformance.input_files.measured_table import MeasuredTable
from pantocheck.conformance.input_files.suggestions import suggest_names
from pantocheck.conformance.input_files.table_formats import CSV, HDF5, read_tables
from pantocheck.conformance.input_files.table_rows import MOST_NAMED_ROWS, name_rows
from pantocheck.conformance.input_files.toml_file import read_model
from pantocheck.conformance.input_files.units import convert_key, suggest_key
from pantocheck.conformance.records.record_reading import locate_table, record_digest

StaticValue = Literal["elasticity", "contact_wire_height"]
"""Value measured along a line."""

STATIC_VALUES: tuple[StaticValue, ...] = get_args(StaticValue)

COLUMN_UNITS = {"position": "m", "elasticity": "m_N", "contact_wire_height": "m"}
"""Columns of the table, with their SI unit as at the end of a key."""

USUAL_COLUMNS = ["position_m", "elasticity_mm_N", "contact_wire_height_m"]

LARGEST_TABLE = 300_000
"""Largest number of values in a table: a position every 0.5 m along 40 km, with both values."""


@dataclass(frozen=True)
class StaticRecord:
    """Values measured along a line, by increasing position; NaN marks a missing value.

    Parameters
    ----------
    source : str
        Name of the table.
    digest : str
        SHA-256 of sidecar and table.
    sidecar : StaticSidecar
        Sidecar of the table.
    row : (n,) ndarray of int
        Number of each row below the head line, from 1.
    position : (n,) ndarray
        Positions, from the start of the line [m].
    values : dict of StaticValue to (n,) ndarray
        Elasticities [m/N]; contact wire heights above the datum of the line [m].
    """

    source: str
    digest: str
    sidecar: StaticSidecar
    row: IntegerArray
    position: RealArray
    values: dict[StaticValue, RealArray]


def read_static_table(path: Path) -> StaticRecord:
    """Read a static record without regard to its line.

    Parameters
    ----------
    path : Path
        Table, or its sidecar; both have the same stem.

    Returns
    -------
    StaticRecord
        The record.

    Raises
    ------
    InputError
        A file is missing or damaged; a column is unknown, missing, repeated or empty; a value is infinite, a position
        is missing, or an elasticity is not positive; the sidecar lacks the force of the elasticities.
    """
    sidecar_path = path.with_suffix(".toml")
    sidecar = read_model(sidecar_path, StaticSidecar, "sidecar")
    table = locate_table(sidecar_path, sidecar.file, sidecar.sha256)
    columns = _read_columns(read_tables(table, (), LARGEST_TABLE, (CSV, HDF5)))
    where = f"record '{table.name}'"
    direction = 1.0 if sidecar.positions == "increasing" else -1.0
    position = direction * (columns["position"] - sidecar.line_start_m)
    values: dict[StaticValue, RealArray] = {name: columns[name] for name in STATIC_VALUES if name in columns}
    if "contact_wire_height" in values:
        values["contact_wire_height"] = values["contact_wire_height"] - sidecar.datum_m
    if not values:
        raise InputError(where, "has no measured value", f"Store {' or '.join(USUAL_COLUMNS[1:])} beside the position.")
    problems = [*_find_force_problems(sidecar_path, sidecar, values), *_find_row_problems(where, position, values)]
    if problems:
        raise join_errors(problems)
    order = np.argsort(position, kind="stable")
    return StaticRecord(
        table.name,
        record_digest(sidecar_path, table),
        sidecar,
        order + 1,
        position[order],
        {name: measured[order] for name, measured in values.items()},
    )


def read_static_record(path: Path, geometry: Geometry) -> StaticRecord:
    """Read a static record of a line.

    Parameters
    ----------
    path : Path
        Table, or its sidecar; both have the same stem.
    geometry : Geometry
        Spans of the line.

    Returns
    -------
    StaticRecord
        The record.

    Raises
    ------
    InputError
        The record is invalid (`read_static_table`), has a position outside the line, or names other spans than the
        line has.
    """
    record = read_static_table(path)
    if problems := list(_find_line_problems(path.with_suffix(".toml"), record, geometry)):
        raise join_errors(problems)
    return record


def _read_columns(tables: list[MeasuredTable]) -> dict[str, RealArray]:
    """Columns in SI units, by name without unit."""
    where = tables[0].where
    if len(tables) > 1:
        raise InputError(where, f"holds {len(tables)} runs", "Write one file per run.")
    columns: dict[str, RealArray] = {}
    for column, values in zip(tables[0].columns, tables[0].values.T, strict=True):
        if column.name is None:
            raise InputError(where, "has no head line", "Write the names of the columns in the first line.")
        place = f"{where}, column {column.name[:80]!r}"
        stem, factor = _find_column(column.name, place)
        if stem in columns:
            raise InputError(place, f"repeats {stem}", "Store each value once.")
        columns[stem] = factor * values
    if "position" not in columns:
        raise InputError(where, "has no positions", f"Store {USUAL_COLUMNS[0]}, from the start of the line.")
    return columns


def _find_column(name: str, place: str) -> tuple[str, float]:
    """Name of a column without its unit, and the factor to its SI unit."""
    stems = {f"{stem}_{unit}": stem for stem, unit in COLUMN_UNITS.items()}
    if (converted := convert_key(name, list(stems))) is not None:
        return stems[converted[0]], converted[1]
    raise InputError(
        place, "unknown column", suggest_key(name, None, USUAL_COLUMNS) or suggest_names(name, USUAL_COLUMNS)
    )


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


def _find_force_problems(
    path: Path, sidecar: StaticSidecar, values: dict[StaticValue, RealArray]
) -> Iterator[InputError]:
    """Elasticities without the force that lifted the wire."""
    if "elasticity" in values and sidecar.force_N is None:
        yield InputError(
            f"sidecar '{path.name}', key force_N",
            "missing",
            "Give the force of the elasticities, e.g. force_N = [100.0], or both forces of a difference; droppers that "
            "slacken make the elasticity depend on it.",
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

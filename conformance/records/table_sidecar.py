"""Sidecar of any measured table: the keys that all kinds share, and the reading of its named columns."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, NamedTuple

from pydantic import Field

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import MeasuredTable
from pantocheck.conformance.input_files.sourced_table import InputTable
from pantocheck.conformance.input_files.suggestions import suggest_names
from pantocheck.conformance.input_files.table_formats import CSV, HDF5, read_tables
from pantocheck.conformance.input_files.text_settings import TextSettings
from pantocheck.conformance.input_files.units import convert_key, find_unit, suggest_key
from pantocheck.conformance.records.sidecar_tables import TableDigest, TableName, find_table_name_problems

ColumnName = Annotated[str, Field(min_length=1, max_length=200)]


class TableSidecar(InputTable):
    """Keys of the sidecar of a measured table: its file and the layout of the file."""

    file: TableName
    sha256: TableDigest = None
    table: TextSettings = TextSettings()
    """Layout of a text table, if it is not found from the file."""

    @cross_check
    def _check_file(self) -> Problems:
        yield from find_table_name_problems(self.file)


class NamedTableSidecar(TableSidecar):
    """Sidecar of a table whose columns have the names of this suite with their unit, or are named here."""

    columns: Annotated[dict[str, ColumnName], Field(default_factory=dict, max_length=10)]
    """Names of the columns in the table, where they are others: the name of this suite, with its unit, then that of
    the table; further columns are ignored then.
    """
    note: Annotated[str | None, Field(max_length=4000)] = None
    """Remark for the reader."""


class NamedColumn(NamedTuple):
    """Column of a table, in the unit of its name."""

    values: RealArray
    place: str
    """Column in messages."""


def read_named_columns(
    table: Path, sidecar: NamedTableSidecar, known: Sequence[str], usual: Sequence[str], largest: int
) -> dict[str, NamedColumn]:
    """Read the columns of a table with one run.

    Args:
        table: The table.
        sidecar: Its sidecar.
        known: Names of the columns of this kind, with their unit.
        usual: Names that messages suggest.
        largest: Largest accepted number of values.

    Returns:
        Columns by their known name, in its unit.

    Raises:
        InputError: The table is damaged; a column is unknown, missing or repeated.
    """
    tables = read_tables(table, (), largest, (CSV, HDF5), sidecar.table)
    where = f"record '{table.name}'"
    if len(tables) > 1:
        raise InputError(where, f"holds {len(tables)} runs", "Write one file per measurement.")
    columns: dict[str, NamedColumn] = {}
    for name, values, place in _name_columns(tables[0], sidecar.columns, table.with_suffix(".toml").name):
        if (converted := convert_key(name, list(known))) is None:
            raise InputError(place, "unknown column", _suggest_column(name, known, usual))
        if converted[0] in columns:
            raise InputError(place, f"repeats {converted[0]}", "Store each value once.")
        columns[converted[0]] = NamedColumn(converted[1] * values, place)
    return columns


def _name_columns(table: MeasuredTable, mapping: dict[str, str], sidecar_name: str) -> list[tuple[str, RealArray, str]]:
    """Name in this suite, values and place in messages of each column that is used."""
    by_name: dict[str, RealArray] = {}
    for column, values in zip(table.columns, table.values.T, strict=True):
        if column.name is None:
            raise InputError(table.where, "has no head line", "Write the names of the columns in the first line.")
        if column.name in by_name:
            raise InputError(table.where, f"has two columns {column.name[:80]!r}", "Give each column its own name.")
        by_name[column.name] = values
    if not mapping:
        return [(name, values, f"{table.where}, column {name[:80]!r}") for name, values in by_name.items()]
    for key, name in mapping.items():
        if name not in by_name:
            raise InputError(
                f"sidecar '{sidecar_name}', key columns.{key[:80]}",
                f"the table has no column {name[:80]!r}",
                suggest_names(name, list(by_name)),
            )
    return [(key, by_name[name], f"sidecar '{sidecar_name}', key columns.{key[:80]}") for key, name in mapping.items()]


def _suggest_column(name: str, known: Sequence[str], usual: Sequence[str]) -> str:
    stem = name.split("_", 1)[0]
    if (hint := suggest_key(name, None, list(usual))) is not None:
        return hint
    other_kind = [column for column in known if column.startswith(f"{stem}_") and find_unit(name) is not None]
    return f"For this kind, the column is {other_kind[0]}." if other_kind else suggest_names(name, list(usual))

"""Sidecar of any measured table: the TOML file beside it; keys that all kinds share, and the reading of both."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath
from typing import Annotated, Generic, NamedTuple, TypeVar

from pydantic import Field

from pantocheck.conformance.core.array_types import IntegerArray, RealArray
from pantocheck.conformance.core.files import MAX_FILE_BYTES, check_file, file_digest
from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.core.measured_table import CSV, HDF5, ODS, XLSX, MeasuredTable, TableFormat, read_tables
from pantocheck.conformance.core.sourced_table import InputTable, Problems, cross_check, validation_problem
from pantocheck.conformance.core.text_settings import TextSettings
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.core.units import convert_key, find_unit, suggest_key

TableName = Annotated[str, Field(min_length=1, max_length=500, description="name of the table beside the sidecar")]


def find_table_name_problems(name: str, key: str = "file") -> Problems:
    """Problem of a name of a table that is a path."""
    # On Windows, `C:table.csv` is a path, too; the same record must be valid on all systems.
    if "/" in name or "\\" in name or name in {".", ".."} or "\0" in name or PureWindowsPath(name).drive:
        yield validation_problem(
            key, f"found the path {name!r}", "Put the table beside its sidecar, and give its name only."
        )


class TableSidecar(InputTable):
    """Keys of the sidecar of a measured table: its file and the layout of the file."""

    file: TableName | None = None
    sha256: Annotated[str | None, Field(pattern="^[0-9a-f]{64}$")] = None
    """SHA-256 of the table, to detect a damaged copy."""
    table: TextSettings = TextSettings()
    """Layout of a text table, if it is not found from the file."""

    @cross_check
    def _check_file(self) -> Problems:
        if self.file is not None:
            yield from find_table_name_problems(self.file)
        elif self.sha256 is not None:
            yield validation_problem("file", "missing, although sha256 is given", "Give the name of the table.")


S = TypeVar("S", bound=TableSidecar)


def read_sidecar(path: Path, model: type[S]) -> tuple[S, Path]:
    """Read the sidecar of a table, and find the table.

    Args:
        path: Table, or its sidecar; both have the same stem.
        model: Kind of the sidecar.

    Returns:
        Sidecar, and the table that it names; `path`, if it names none.

    Raises:
        InputError: A file is missing, the sidecar is invalid, or the table is another one than the sidecar describes.
    """
    sidecar_path = path.with_suffix(".toml")
    sidecar = read_model(sidecar_path, model, "sidecar")
    if sidecar.file is None:
        return sidecar, path
    table = locate_table(sidecar_path, sidecar.file, sidecar.sha256)
    if path.suffix.lower() != ".toml" and path.exists() and not path.samefile(table):
        raise InputError(
            f"sidecar '{sidecar_path.name}', key file",
            f"found {table.name!r}, but the record is {path.name!r}",
            f"Give the record {table.name}, or correct the key.",
        )
    return sidecar, table


def locate_table(sidecar_path: Path, name: str, digest: str | None) -> Path:
    """Find the table of a sidecar.

    Args:
        sidecar_path: The sidecar.
        name: Name of the table, from the sidecar.
        digest: Its SHA-256 by the sidecar.

    Raises:
        InputError: The table is missing, is a link to a file in another folder, or has another SHA-256.
    """
    table = sidecar_path.parent / name
    check_file(table, f"record '{table.name}'", MAX_FILE_BYTES)
    if not table.resolve().is_relative_to(sidecar_path.parent.resolve()):
        raise InputError(f"record '{table.name}'", "is a link to a file outside its folder", "Copy the table itself.")
    if digest is not None and file_digest(table) != digest:
        raise InputError(
            f"record '{table.name}'",
            "the content does not agree with sha256 in the sidecar",
            "Copy table and sidecar again, or write them again.",
        )
    return table


def record_digest(sidecar_path: Path, *tables: Path) -> str:
    """SHA-256 of the sidecar and the tables of a record, or of a summary alone."""
    paths = [sidecar_path.with_suffix(".toml"), *tables]
    return "sha256:" + hashlib.sha256("\n".join(map(file_digest, paths)).encode()).hexdigest()


# Tables whose columns have names with units.
ColumnName = Annotated[str, Field(min_length=1, max_length=200)]


class NamedTableSidecar(TableSidecar):
    """Sidecar of a table whose columns have the names of this suite with their unit, or are named here."""

    file: TableName
    columns: Annotated[dict[str, ColumnName], Field(default_factory=dict, max_length=10)]
    """Names of the columns in the table, by the names of this suite with their units, where both differ; further
    columns are then ignored.
    """
    note: Annotated[str | None, Field(max_length=4000)] = None
    """Remark for the reader."""


N = TypeVar("N", bound=NamedTableSidecar)


@dataclass(frozen=True)
class TableRecord(Generic[N]):
    """Rows of a table in the order of their axis."""

    source: str
    """Name of the table."""
    digest: str
    """SHA-256 of sidecar and table."""
    sidecar: N
    row: IntegerArray
    """Number of each row below the head line, from 1, (n,)."""


class NamedColumn(NamedTuple):
    """Column of a table, in the unit of its name."""

    values: RealArray
    place: str
    """Column in messages."""


def read_named_columns(
    table: Path,
    sidecar: NamedTableSidecar,
    known: Sequence[str],
    usual: Sequence[str],
    largest: int,
    formats: tuple[TableFormat, ...] = (CSV, HDF5, XLSX, ODS),
) -> dict[str, NamedColumn]:
    """Read the columns of a table with one run.

    Args:
        table: The table.
        sidecar: Its sidecar.
        known: Names of the columns of this kind, with their unit.
        usual: Names that messages suggest.
        largest: Largest accepted number of values.
        formats: Accepted formats.

    Returns:
        Columns by their known name, in its unit.

    Raises:
        InputError: The table is damaged; a column is unknown, missing or repeated.
    """
    tables = read_tables(table, (), largest, formats, sidecar.table)
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

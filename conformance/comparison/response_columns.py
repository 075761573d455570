"""Columns of a response record: frequency, and modulus and phase or real and imaginary part, in SI units."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pantocheck.conformance.array_types import ComplexArray, RealArray
from pantocheck.conformance.comparison.response_kinds import RESPONSE_FORMS, ResponseKind
from pantocheck.conformance.comparison.response_sidecar import ResponseSidecar
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import MeasuredTable
from pantocheck.conformance.input_files.suggestions import suggest_names
from pantocheck.conformance.input_files.table_formats import CSV, HDF5, read_tables
from pantocheck.conformance.input_files.table_rows import name_rows
from pantocheck.conformance.input_files.units import convert_key, find_unit, suggest_key

LARGEST_RESPONSE_TABLE = 200_000
"""Largest number of values in a table: 50 Hz in steps of 2 mHz with seven columns."""

UNCERTAINTY_COLUMNS = ("modulus_uncertainty_pct", "phase_uncertainty_deg")


@dataclass(frozen=True)
class ResponseColumns:
    """Columns of a response in SI units, in the order of the table.

    Parameters
    ----------
    frequency : (n,) ndarray
        Frequencies [Hz].
    response : (n,) ndarray
        Complex response in the SI unit of its kind; NaN: no value.
    modulus_uncertainty_pct, phase_uncertainty_deg : (n,) ndarray or None
        Half-widths of the 95 % intervals [%, degrees]; None: not in the table.
    """

    frequency: RealArray
    response: ComplexArray
    modulus_uncertainty_pct: RealArray | None
    phase_uncertainty_deg: RealArray | None


def read_response_columns(table: Path, sidecar: ResponseSidecar) -> ResponseColumns:
    """Read the columns of a response.

    Parameters
    ----------
    table : Path
        The table.
    sidecar : ResponseSidecar
        Its sidecar.

    Returns
    -------
    ResponseColumns
        The columns.

    Raises
    ------
    InputError
        The table is damaged; a column is unknown, missing or repeated.
    """
    tables = read_tables(table, (), LARGEST_RESPONSE_TABLE, (CSV, HDF5))
    where = f"record '{table.name}'"
    if len(tables) > 1:
        raise InputError(where, f"holds {len(tables)} runs", "Write one file per measurement.")
    known = list_response_columns(sidecar.kind)
    named = _name_columns(tables[0], sidecar.columns, table.with_suffix(".toml").name)
    columns: dict[str, RealArray] = {}
    for name, values, place in named:
        key, factor = _find_known_column(name, known, place)
        if key in columns:
            raise InputError(place, f"repeats {key}", "Store each value once.")
        if (infinite := np.flatnonzero(np.isinf(values))).size:
            raise InputError(f"{place}, {name_rows(infinite + 1)}", "the value is infinite", "Write nan for no value.")
        columns[key] = factor * values
    unit = RESPONSE_FORMS[sidecar.kind].unit
    return ResponseColumns(
        _require(columns, "frequency_Hz", where),
        sidecar.scale * _join_complex(columns, unit, where),
        *(columns.get(name) for name in UNCERTAINTY_COLUMNS),
    )


def list_response_columns(kind: ResponseKind) -> list[str]:
    """Names of the columns of a kind of response, in its SI unit."""
    unit = RESPONSE_FORMS[kind].unit
    values = (f"modulus_{unit}", "phase_deg", f"real_{unit}", f"imaginary_{unit}")
    return ["frequency_Hz", *values, *UNCERTAINTY_COLUMNS]


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


def _find_known_column(name: str, known: list[str], place: str) -> tuple[str, float]:
    """Known column of a name with any unit, and the factor to the unit of the known one."""
    if (converted := convert_key(name, known)) is not None:
        return converted
    stem = name.split("_", 1)[0]
    other_kind = [column for column in known if column.startswith(f"{stem}_") and find_unit(name) is not None]
    hint = suggest_key(name, None, known) or (
        f"For this kind, the column is {other_kind[0]}." if other_kind else suggest_names(name, known)
    )
    raise InputError(place, "unknown column", hint)


def _join_complex(columns: dict[str, RealArray], unit: str, where: str) -> ComplexArray:
    """Response from modulus and phase, or from real and imaginary part."""
    polar, cartesian = {f"modulus_{unit}", "phase_deg"}, {f"real_{unit}", f"imaginary_{unit}"}
    given = columns.keys() & (polar | cartesian)
    if given not in (polar, cartesian):
        raise InputError(
            where,
            f"has {' and '.join(sorted(given)) or 'no response'}",
            f"Give modulus_{unit} and phase_deg, or real_{unit} and imaginary_{unit}.",
        )
    if given == cartesian:
        return np.asarray(columns[f"real_{unit}"] + 1j * columns[f"imaginary_{unit}"])
    modulus = columns[f"modulus_{unit}"]
    if (negative := np.flatnonzero(modulus < 0)).size:
        raise InputError(
            where,
            f"the modulus is negative in row {negative[0] + 1}",
            "Give a modulus above 0; the phase has the sign.",
        )
    return np.asarray(modulus * np.exp(1j * np.radians(columns["phase_deg"])))


def _require(columns: dict[str, RealArray], name: str, where: str) -> RealArray:
    if name not in columns:
        raise InputError(where, f"has no column {name}", f"Store {name} beside the response.")
    return columns[name]

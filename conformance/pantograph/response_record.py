"""Response record: a frequency response measured at the head of a pantograph, as dynamic stiffness."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pantocheck.conformance.core.array_types import ComplexArray, IntegerArray, RealArray
from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.core.validation_messages import name_rows
from pantocheck.conformance.pantograph.response_sidecar import (
    RESPONSE_FORMS,
    UNCERTAINTY_COLUMNS,
    ResponseSidecar,
    list_response_columns,
)
from pantocheck.conformance.records.record_reading import locate_table, record_digest
from pantocheck.conformance.records.sidecar_tables import read_named_columns

LARGEST_RESPONSE_TABLE = 200_000
"""Largest number of values in a table: 50 Hz in steps of 2 mHz with seven columns."""

LEAST_PHASE_SINE = -0.02
"""Mean sine of the phase of the dynamic stiffness below which the signs are refused: a phase error of one degree."""


@dataclass(frozen=True)
class ResponseUncertainty:
    """Half-widths of the 95 % intervals of a response, row by row: relative modulus [-], phase [rad]; (n,) each."""

    modulus: RealArray
    phase: RealArray


@dataclass(frozen=True)
class ResponseRecord:
    """Frequency response of a head, by increasing frequency; NaN marks a missing value."""

    source: str
    """Name of the table."""
    digest: str
    """SHA-256 of sidecar and table."""
    sidecar: ResponseSidecar
    row: IntegerArray
    """Number of each row below the head line, from 1, (n,)."""
    frequency: RealArray
    """Frequencies, (n,) [Hz]."""
    stiffness: ComplexArray
    """Dynamic stiffness, converted from the measured kind, (n,) [N/m]."""
    uncertainty: ResponseUncertainty | None
    """Its uncertainty, the same for every kind; None: not stated."""


def read_response(path: Path) -> ResponseRecord:
    """Read a response record.

    Args:
        path: Table, or its sidecar; both have the same stem.

    Raises:
        InputError: A file is missing or damaged; a column is unknown, missing or repeated; the number of rows is not
            the stated one; a frequency is missing, repeated or not positive, a modulus is not positive, or a value is
            infinite; force and motion evidently have other signs.
    """
    sidecar_path = path.with_suffix(".toml")
    sidecar = read_model(sidecar_path, ResponseSidecar, "sidecar")
    table = locate_table(sidecar_path, sidecar.file, sidecar.sha256)
    where = f"record '{table.name}'"
    columns = _read_columns(table, sidecar)
    if "frequency_Hz" not in columns:
        raise InputError(where, "has no column frequency_Hz", "Store frequency_Hz beside the response.")
    unsorted, response = columns["frequency_Hz"], _join_complex(columns, RESPONSE_FORMS[sidecar.kind].unit, where)
    if problems := [
        *_find_row_count_problem(where, unsorted.size, sidecar),
        *_find_frequency_problems(where, unsorted),
        *_find_value_problems(where, response, columns),
    ]:
        raise join_errors(problems)
    order = np.argsort(unsorted, kind="stable")
    frequency = unsorted[order]
    sign = 1.0 if sidecar.force_and_motion == "same_direction" else -1.0
    stiffness = RESPONSE_FORMS[sidecar.kind].to_stiffness(sign * (sidecar.scale * response)[order], frequency)
    _refuse_other_signs(where, stiffness)
    return ResponseRecord(
        table.name,
        record_digest(sidecar_path, table),
        sidecar,
        order + 1,
        frequency,
        stiffness,
        _choose_uncertainty(columns, sidecar, order),
    )


def _read_columns(table: Path, sidecar: ResponseSidecar) -> dict[str, RealArray]:
    """Finite or missing values of the columns, by their name in SI units."""
    known = list_response_columns(sidecar.kind)
    columns = read_named_columns(table, sidecar, known, known, LARGEST_RESPONSE_TABLE)
    for values, place in columns.values():
        if (infinite := np.flatnonzero(np.isinf(values))).size:
            raise InputError(f"{place}, {name_rows(infinite + 1)}", "the value is infinite", "Write nan for no value.")
    return {name: column.values for name, column in columns.items()}


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


def _choose_uncertainty(
    columns: dict[str, RealArray], sidecar: ResponseSidecar, order: IntegerArray
) -> ResponseUncertainty | None:
    """Uncertainty of the rows of the table, else that of the sidecar."""
    modulus, phase = (
        columns[name][order] if name in columns else None if stated is None else np.full(order.size, stated)
        for name, stated in zip(
            UNCERTAINTY_COLUMNS, (sidecar.modulus_uncertainty_pct, sidecar.phase_uncertainty_deg), strict=True
        )
    )
    if modulus is None or phase is None:
        return None
    return ResponseUncertainty(modulus / 100, np.radians(phase))


def _find_row_count_problem(where: str, rows: int, sidecar: ResponseSidecar) -> Iterator[InputError]:
    if rows != sidecar.rows:
        yield InputError(
            where,
            f"has {rows} rows, the sidecar states {sidecar.rows}",
            "Export the whole table again, or correct the key rows.",
        )


def _find_frequency_problems(where: str, frequency: RealArray) -> Iterator[InputError]:
    """Frequencies that are missing, not positive or repeated."""
    if (wrong := np.flatnonzero(~(np.isfinite(frequency) & (frequency > 0)))).size:
        yield InputError(
            f"{where}, {name_rows(wrong + 1)}",
            "the frequency is missing or not positive",
            "Give the frequency of each row; leave out a row at 0 Hz.",
        )
    _, first = np.unique(frequency, return_index=True)
    if (repeated := np.setdiff1d(np.flatnonzero(np.isfinite(frequency)), first)).size:
        yield InputError(
            f"{where}, {name_rows(repeated + 1)}",
            "the frequency occurs before",
            "Write one file per measurement, with one row per frequency.",
        )


def _find_value_problems(where: str, response: ComplexArray, columns: dict[str, RealArray]) -> Iterator[InputError]:
    """Responses that are zero, no response at all, and missing uncertainties."""
    if np.isnan(response).all():
        yield InputError(where, "holds no measured value", "Export the record again.")
    if (wrong := np.flatnonzero(response == 0)).size:
        yield InputError(f"{where}, {name_rows(wrong + 1)}", "the response is 0", "Write nan for no value.")
    for name in UNCERTAINTY_COLUMNS:
        width = columns.get(name, np.ones(1))
        if (wrong := np.flatnonzero(~(np.isfinite(width) & (width > 0)))).size:
            yield InputError(
                f"{where}, {name_rows(wrong + 1)}",
                f"the uncertainty of the {name.split('_', 1)[0]} is missing or not positive",
                "Give the half-width of the 95 % interval of each row.",
            )


def _refuse_other_signs(where: str, stiffness: ComplexArray) -> None:
    """Refuse a head that delivers energy: a passive one has a dynamic stiffness with a phase of 0 to 180 degrees."""
    if np.nanmean(np.sin(np.angle(stiffness))) < LEAST_PHASE_SINE:
        raise InputError(
            where,
            "the head would deliver energy: force and motion have opposite signs, or the phase counts the other way",
            'Give force_and_motion = "opposite_directions" in the sidecar, or change the sign of the phase; the phase '
            "of an apparent mass is between -180 and 0 degrees, that of a receptance as well.",
        )

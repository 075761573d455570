"""Response record: a frequency response measured at the head of a pantograph, as dynamic stiffness."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pantocheck.conformance.array_types import ComplexArray, IntegerArray, RealArray
from pantocheck.conformance.comparison.response_columns import ResponseColumns, read_response_columns
from pantocheck.conformance.comparison.response_kinds import RESPONSE_FORMS
from pantocheck.conformance.comparison.response_sidecar import ResponseSidecar
from pantocheck.conformance.input_files.input_error import InputError, join_errors
from pantocheck.conformance.input_files.table_rows import name_rows
from pantocheck.conformance.input_files.toml_file import read_model
from pantocheck.conformance.records.record_reading import locate_table, record_digest

LEAST_PHASE_SINE = -0.02
"""Mean sine of the phase of the dynamic stiffness below which the signs are refused: a phase error of one degree."""


@dataclass(frozen=True)
class ResponseUncertainty:
    """Half-widths of the 95 % intervals of a response, row by row.

    Parameters
    ----------
    modulus : (n,) ndarray
        Relative half-width of the modulus [-].
    phase : (n,) ndarray
        Half-width of the phase [rad].
    """

    modulus: RealArray
    phase: RealArray


@dataclass(frozen=True)
class ResponseRecord:
    """Frequency response of a head, by increasing frequency; NaN marks a missing value.

    Parameters
    ----------
    source : str
        Name of the table.
    digest : str
        SHA-256 of sidecar and table.
    sidecar : ResponseSidecar
        Sidecar of the table.
    row : (n,) ndarray of int
        Number of each row below the head line, from 1.
    frequency : (n,) ndarray
        Frequencies [Hz].
    stiffness : (n,) ndarray
        Dynamic stiffness, converted from the measured kind [N/m].
    uncertainty : ResponseUncertainty or None
        Its uncertainty, the same for every kind; None: not stated.
    """

    source: str
    digest: str
    sidecar: ResponseSidecar
    row: IntegerArray
    frequency: RealArray
    stiffness: ComplexArray
    uncertainty: ResponseUncertainty | None


def read_response(path: Path) -> ResponseRecord:
    """Read a response record.

    Parameters
    ----------
    path : Path
        Table, or its sidecar; both have the same stem.

    Returns
    -------
    ResponseRecord
        The record.

    Raises
    ------
    InputError
        A file is missing or damaged; a column is unknown, missing or repeated; the number of rows is not the stated
        one; a frequency is missing, repeated or not positive, a modulus is not positive, or a value is infinite; force
        and motion evidently have other signs.
    """
    sidecar_path = path.with_suffix(".toml")
    sidecar = read_model(sidecar_path, ResponseSidecar, "sidecar")
    table = locate_table(sidecar_path, sidecar.file, sidecar.sha256)
    columns = read_response_columns(table, sidecar)
    where = f"record '{table.name}'"
    if problems := [
        *_find_row_count_problem(where, columns, sidecar),
        *_find_frequency_problems(where, columns.frequency),
        *_find_value_problems(where, columns),
    ]:
        raise join_errors(problems)
    order = np.argsort(columns.frequency, kind="stable")
    frequency = columns.frequency[order]
    sign = 1.0 if sidecar.force_and_motion == "same_direction" else -1.0
    stiffness = RESPONSE_FORMS[sidecar.kind].to_stiffness(sign * columns.response[order], frequency)
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


def _choose_uncertainty(
    columns: ResponseColumns, sidecar: ResponseSidecar, order: IntegerArray
) -> ResponseUncertainty | None:
    """Uncertainty of the rows of the table, else that of the sidecar."""
    modulus, phase = (
        values[order] if values is not None else None if stated is None else np.full(order.size, stated)
        for values, stated in (
            (columns.modulus_uncertainty_pct, sidecar.modulus_uncertainty_pct),
            (columns.phase_uncertainty_deg, sidecar.phase_uncertainty_deg),
        )
    )
    if modulus is None or phase is None:
        return None
    return ResponseUncertainty(modulus / 100, np.radians(phase))


def _find_row_count_problem(where: str, columns: ResponseColumns, sidecar: ResponseSidecar) -> Iterator[InputError]:
    if (rows := columns.frequency.size) != sidecar.rows:
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


def _find_value_problems(where: str, columns: ResponseColumns) -> Iterator[InputError]:
    """Responses that are zero, no response at all, and missing uncertainties."""
    if np.isnan(columns.response).all():
        yield InputError(where, "holds no measured value", "Export the record again.")
    if (wrong := np.flatnonzero(columns.response == 0)).size:
        yield InputError(f"{where}, {name_rows(wrong + 1)}", "the response is 0", "Write nan for no value.")
    for uncertainty, name in (
        (columns.modulus_uncertainty_pct, "modulus"),
        (columns.phase_uncertainty_deg, "phase"),
    ):
        if uncertainty is not None and (wrong := np.flatnonzero(~(np.isfinite(uncertainty) & (uncertainty > 0)))).size:
            yield InputError(
                f"{where}, {name_rows(wrong + 1)}",
                f"the uncertainty of the {name} is missing or not positive",
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

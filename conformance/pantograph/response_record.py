"""Frequency response measured at a pantograph head: its kinds, its sidecar, and its record as dynamic stiffness.

The dynamic stiffness D is force over displacement in the same direction, for motions in exp(i omega t). Every kind is
D^p (i omega)^q:

    dynamic stiffness  D                     receptance   1 / D
    impedance          D / (i omega)         mobility     i omega / D
    apparent mass      D / (i omega)^2       accelerance  (i omega)^2 / D
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from pantocheck.conformance.core.array_types import ComplexArray, IntegerArray, RealArray
from pantocheck.conformance.core.input_error import InputError, join_errors
from pantocheck.conformance.core.measured_table import CSV, HDF5, UFF
from pantocheck.conformance.core.sourced_table import (
    NO_SOURCE,
    NonNegative,
    Positive,
    Problems,
    cross_check,
    validation_problem,
)
from pantocheck.conformance.core.table_sidecar import (
    NamedTableSidecar,
    TableRecord,
    read_named_columns,
    read_sidecar,
    record_digest,
)
from pantocheck.conformance.core.validation_messages import name_rows

HeadPoint = Literal["head_centre", "left_strip", "right_strip", "other"]
"""Point of the head: its centre, one of its contact strips, or another one."""

ResponseKind = Literal["apparent_mass", "impedance", "dynamic_stiffness", "receptance", "mobility", "accelerance"]

RESPONSE_SCHEMA = "pantocheck.response/1"

RESPONSE_FORMATS = (CSV, HDF5, UFF)

UNCERTAINTY_COLUMNS = ("modulus_uncertainty_pct", "phase_uncertainty_deg")


@dataclass(frozen=True)
class ResponseForm:
    """Form of a kind of response, D^stiffness_power (i omega)^omega_power."""

    unit: str
    """SI unit, as at the end of a key."""
    symbol: str
    """SI unit in reports."""
    stiffness_power: Literal[1, -1]
    """1: force over motion; -1: motion over force."""
    omega_power: int
    """Power of i omega."""

    def to_stiffness(self, response: ComplexArray, frequency: RealArray) -> ComplexArray:
        """Dynamic stiffness [N/m] of a response in SI units at frequencies [Hz]."""
        scaled = response * _omega_factor(frequency, -self.omega_power)
        return np.asarray(scaled**self.stiffness_power, dtype=np.complex128)

    def from_stiffness(self, stiffness: ComplexArray, frequency: RealArray) -> ComplexArray:
        """Response in SI units of a dynamic stiffness [N/m] at frequencies [Hz]."""
        return np.asarray(stiffness**self.stiffness_power * _omega_factor(frequency, self.omega_power))

    def shift_phase(self, phase: RealArray) -> RealArray:
        """Phase of the response [rad] from that of the dynamic stiffness, without jumps of 360 degrees."""
        return self.stiffness_power * phase + self.omega_power * np.pi / 2


RESPONSE_FORMS: dict[ResponseKind, ResponseForm] = {
    "apparent_mass": ResponseForm("kg", "kg", 1, -2),
    "impedance": ResponseForm("N_s_m", "N s/m", 1, -1),
    "dynamic_stiffness": ResponseForm("N_m", "N/m", 1, 0),
    "receptance": ResponseForm("m_N", "m/N", -1, 0),
    "mobility": ResponseForm("m_s_N", "m/s/N", -1, 1),
    "accelerance": ResponseForm("m_s2_N", "m/s²/N", -1, 2),
}
"""Form of each kind."""


def _omega_factor(frequency: RealArray, power: int) -> ComplexArray:
    """Power of i omega, with the exact power of i."""
    return np.asarray(1j**power * (2 * np.pi * frequency) ** power, dtype=np.complex128)


def list_response_columns(kind: ResponseKind) -> list[str]:
    """Names of the columns of a kind of response, in its SI unit."""
    unit = RESPONSE_FORMS[kind].unit
    values = (f"modulus_{unit}", "phase_deg", f"real_{unit}", f"imaginary_{unit}")
    return ["frequency_Hz", *values, *UNCERTAINTY_COLUMNS]


class ResponseSidecar(NamedTableSidecar):
    """Sidecar of a table of frequency, modulus and phase."""

    schema_: Annotated[Literal["pantocheck.response/1"], Field(alias="schema")]
    """Version of the format: "pantocheck.response/1"."""
    kind: ResponseKind
    """Measured quantity; force over motion: apparent_mass, impedance, dynamic_stiffness; motion over force:
    accelerance, mobility, receptance.
    """
    rows: Annotated[int, Field(ge=1, le=100_000)]
    """Number of rows of the complete table, so that a lost row is noticed."""
    static_force_N: Annotated[NonNegative, Field(le=2000)]
    """Static force on the head during the measurement [N]."""
    height_m: Annotated[float | None, Field(ge=-10, le=20)] = None
    """Height of the head during the measurement, any datum [m]."""
    excited_at: HeadPoint = "head_centre"
    """Point of the force; strips are shown, not graded."""
    measured_at: HeadPoint = "head_centre"
    """Point of the motion; strips are shown, not graded."""
    force_and_motion: Literal["same_direction", "opposite_directions"] = "same_direction"
    """Directions in which force and motion count as positive."""
    scale: Annotated[Positive, Field(le=1e12)] = 1.0
    """Factor from the table to the unit in the name of its columns."""
    modulus_uncertainty_pct: Annotated[Positive | None, Field(le=100)] = None
    """Half-width of the 95 % interval of the modulus [%]."""
    phase_uncertainty_deg: Annotated[Positive | None, Field(le=180)] = None
    """Half-width of the 95 % interval of the phase [degrees]."""
    source: Annotated[str, Field(min_length=1, max_length=500)] = NO_SOURCE
    """Test report, test rig and date."""

    @cross_check
    def _check_uncertainty(self) -> Problems:
        stated = {"modulus_uncertainty_pct": self.modulus_uncertainty_pct}
        stated |= {"phase_uncertainty_deg": self.phase_uncertainty_deg}
        missing = [key for key, value in stated.items() if value is None]
        if len(missing) == 1:
            yield validation_problem(missing[0], "missing, although the other uncertainty is given", "Give both.")

    @property
    def is_at_head(self) -> bool:
        """Whether force and motion belong to the centre of the head, the one point of the models."""
        return self.excited_at == self.measured_at == "head_centre"


# Record of table and sidecar.
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
class ResponseRecord(TableRecord[ResponseSidecar]):
    """Frequency response of a head, by increasing frequency; NaN marks a missing value."""

    frequency: RealArray
    """Frequencies, (n,) [Hz]."""
    stiffness: ComplexArray
    """Dynamic stiffness, converted from the measured kind, (n,) [N/m]."""
    uncertainty: ResponseUncertainty | None
    """Uncertainty of the response, the same for every kind; None: not stated."""


def read_response(path: Path) -> ResponseRecord:
    """Read a response record.

    Args:
        path: Table, or its sidecar; both have the same stem.

    Raises:
        InputError: A file is missing or damaged; a column is unknown, missing or repeated; the number of rows is not
            the stated one; a frequency is missing, repeated or not positive, a modulus is not positive, or a value is
            infinite; force and motion evidently have other signs.
    """
    sidecar, table = read_sidecar(path, ResponseSidecar)
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
        record_digest(path, table),
        sidecar,
        order + 1,
        frequency,
        stiffness,
        _choose_uncertainty(columns, sidecar, order),
    )


def _read_columns(table: Path, sidecar: ResponseSidecar) -> dict[str, RealArray]:
    """Finite or missing values of the columns, by their name in SI units."""
    known = list_response_columns(sidecar.kind)
    columns = read_named_columns(table, sidecar, known, known, LARGEST_RESPONSE_TABLE, RESPONSE_FORMATS)
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

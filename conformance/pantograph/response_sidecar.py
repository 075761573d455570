"""Sidecar of a frequency response measured at a pantograph head; kinds of responses and their dynamic stiffness.

The dynamic stiffness D is force over displacement in the same direction, for motions in exp(i omega t). Every kind is
D^p (i omega)^q:

    dynamic stiffness  D                     receptance   1 / D
    impedance          D / (i omega)         mobility     i omega / D
    apparent mass      D / (i omega)^2       accelerance  (i omega)^2 / D
"""

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.sourced_table import (
    NO_SOURCE,
    NonNegative,
    Positive,
    Problems,
    cross_check,
    validation_problem,
)
from pantocheck.conformance.records.sidecar_tables import NamedTableSidecar

HeadPoint = Literal["head_centre", "left_strip", "right_strip", "other"]
"""Point of the head: its centre, one of its contact strips, or another one."""

ResponseKind = Literal["apparent_mass", "impedance", "dynamic_stiffness", "receptance", "mobility", "accelerance"]

RESPONSE_SCHEMA = "pantocheck.response/1"

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

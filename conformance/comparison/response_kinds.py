"""Kinds of frequency responses at the head of a pantograph, and their conversion to the dynamic stiffness.

The dynamic stiffness D is force over displacement in the same direction, for motions in exp(i omega t). Every kind is
D^p (i omega)^q:

    dynamic stiffness  D                     receptance   1 / D
    impedance          D / (i omega)         mobility     i omega / D
    apparent mass      D / (i omega)^2       accelerance  (i omega)^2 / D
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from pantocheck.conformance.array_types import ComplexArray, RealArray

ResponseKind = Literal["apparent_mass", "impedance", "dynamic_stiffness", "receptance", "mobility", "accelerance"]


@dataclass(frozen=True)
class ResponseForm:
    """Form of a kind of response, D^stiffness_power (i omega)^omega_power.

    Parameters
    ----------
    unit : str
        SI unit, as at the end of a key.
    symbol : str
        SI unit in reports.
    stiffness_power : int
        1: force over motion; -1: motion over force.
    omega_power : int
        Power of i omega.
    """

    unit: str
    symbol: str
    stiffness_power: Literal[1, -1]
    omega_power: int

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

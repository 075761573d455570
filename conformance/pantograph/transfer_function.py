"""Transfer function of a pantograph: its receptance at the head as poles and residues, stable and passive.

    receptance(s) = sum of r / (s - p) over all poles, the conjugate ones included          [m/N]

A head is passive if it delivers no energy: Im receptance(i omega) <= 0 at every omega > 0. The sign can change where
receptance(s) - receptance(-s) has a zero on the imaginary axis; these are eigenvalues of a pencil.
"""

from typing import Annotated

import numpy as np
import scipy  # loads its parts when they are used
from numpy.typing import NDArray
from pydantic import Field

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.sourced_table import Positive, Problems, SourcedTable, cross_check, validation_problem

ComplexList = Annotated[
    tuple[Annotated[tuple[float, float], Field(strict=False)], ...], Field(strict=False, min_length=1, max_length=40)
]
"""Complex numbers as pairs of real and imaginary part."""

ACTIVE = 1e-9
"""Share of the receptance above which a positive imaginary part is not a rounding error."""

GRID = 400
"""Number of frequencies at which receptances are compared."""

CORRECTIONS = 30
"""Largest number of corrections on the way to the nearest passive model."""


class TransferFunctionTable(SourcedTable):
    """Receptance of the head as poles and residues; springs are without force at the static working height."""

    poles_1_s: ComplexList
    """Poles [real, imaginary]; of a conjugate pair the one with the positive imaginary part [1/s]."""
    residues_m_N_s: ComplexList
    """Residue of each pole [real, imaginary] [m/(N s)]."""
    uplift_factor: Annotated[Positive, Field(le=1), Feature("transfer_function")] = 1.0
    """Share of the uplift force that arrives at a head that is held at the working height."""

    @cross_check
    def _possible(self) -> Problems:
        pole, residue = self.pole, self.residue
        if pole.size != residue.size:
            yield validation_problem(
                "residues_m_N_s", f"{residue.size} residues for {pole.size} poles", "Give one each."
            )
            return
        if (pole.imag < 0).any() or np.unique(pole).size < pole.size or (residue.imag[pole.imag == 0] != 0).any():
            yield validation_problem(
                "poles_1_s",
                "not a list of different poles",
                "Give real poles with real residues, and one of each pair.",
            )
            return
        if (unstable := pole[(pole.real > 0) | ((pole.real == 0) & (pole.imag > 0))]).size:
            yield validation_problem(
                "poles_1_s", f"the pole {unstable[0]:.4g} is not stable", "Give poles with a negative real part, or 0."
            )
            return
        if (active := find_activity(pole, residue)).size:
            nearest = find_nearest_passive(pole, residue)
            values = ", ".join(f"[{value.real:.9g}, {value.imag:.9g}]" for value in nearest)
            distance = 100 * relative_distance(pole, residue, nearest)
            yield validation_problem(
                "residues_m_N_s",
                f"the head delivers energy at {active[0] / (2 * np.pi):.4g} Hz",
                f"The nearest passive model with these poles differs by at most {distance:.2g} % of the receptance: "
                f"residues_m_N_s = [{values}].",
            )

    @property
    def pole(self) -> ComplexArray:
        """Poles with an imaginary part of zero or above, (n,) [1/s]."""
        return np.array([complex(*value) for value in self.poles_1_s])

    @property
    def residue(self) -> ComplexArray:
        """Residues, (n,) [m/(N s)]."""
        return np.array([complex(*value) for value in self.residues_m_N_s])

    @property
    def unknowns(self) -> int:
        """Number of unknowns of the state space: one per real pole, two per pair."""
        return int((1 + (self.pole.imag > 0)).sum())


def receptance(pole: ComplexArray, residue: ComplexArray, omega: RealArray) -> ComplexArray:
    """Receptance at circular frequencies [rad/s], (k,) [m/N]; poles and residues as in `TransferFunctionTable`."""
    pair, s = np.where(pole.imag > 0, 1.0, 0.0), 1j * omega[:, None]
    terms = residue / (s - pole) + pair * residue.conj() / (s - pole.conj())
    return np.asarray(terms.sum(axis=1), dtype=np.complex128)


def find_activity(pole: ComplexArray, residue: ComplexArray) -> RealArray:
    """Circular frequencies at which a head delivers energy, ascending [rad/s]; empty if it is passive."""
    everywhere = np.concatenate([_grid(pole), _sign_changes(pole, residue)])
    edges = np.sort(everywhere)
    tested = np.concatenate([edges, (edges[1:] + edges[:-1]) / 2])
    value = receptance(pole, residue, tested)
    return np.sort(tested[value.imag > ACTIVE * np.abs(value)])


def find_nearest_passive(pole: ComplexArray, residue: ComplexArray) -> ComplexArray:
    """Residues of the nearest passive model with the same poles: least squares of the relative change.

    The imaginary part of the receptance is linear in the residues. Where a solution is active, a row is added.
    """
    real = pole.imag == 0
    parts = [*np.eye(pole.size), *(1j * np.eye(pole.size)[~real])]

    def rows(omega: RealArray) -> ComplexArray:
        """Change of the receptance over its size, per change of each part of the residues."""
        size = np.abs(receptance(pole, residue, omega))
        changes = [receptance(pole, part.astype(np.complex128), omega) for part in parts]
        return np.asarray(np.array(changes).T / size[:, None], dtype=np.complex128)

    weight = rows(_grid(pole))
    _, triangle = np.linalg.qr(np.vstack([weight.real, weight.imag]))
    bound, found = _grid(pole), residue
    for _ in range(CORRECTIONS):
        if not (active := find_activity(pole, found)).size:
            return found
        bound = np.union1d(bound, active)
        value = receptance(pole, residue, bound)
        # Least distance by Lawson and Hanson: |y| is smallest with limit . y >= least.
        limit = -rows(bound).imag @ np.linalg.inv(triangle)
        least = value.imag / np.abs(value) + 10 * ACTIVE
        system = np.vstack([limit.T, least])
        weights, _ = scipy.optimize.nnls(system, np.append(np.zeros(len(parts)), 1.0))
        rest = system @ weights - np.append(np.zeros(len(parts)), 1.0)
        change = np.linalg.solve(triangle, -rest[:-1] / rest[-1])
        found = residue + sum(number * part for number, part in zip(change, parts, strict=True))
    raise ArithmeticError("no passive model was found")


def relative_distance(pole: ComplexArray, residue: ComplexArray, other: ComplexArray) -> float:
    """Largest change of the receptance over its size between two lists of residues [-]."""
    value = receptance(pole, residue, _grid(pole))
    return float((np.abs(receptance(pole, other - residue, _grid(pole))) / np.abs(value)).max())


def _grid(pole: ComplexArray) -> RealArray:
    """Circular frequencies from a hundredth of the slowest to a hundred times the fastest pole [rad/s]."""
    size = np.abs(pole[pole != 0]) if (pole != 0).any() else np.ones(1)
    return np.union1d(np.geomspace(size.min() / 100, 100 * size.max(), GRID), size)


def _sign_changes(pole: ComplexArray, residue: ComplexArray) -> NDArray[np.float64]:
    """Circular frequencies at which the imaginary part of the receptance can change its sign [rad/s]."""
    poles = np.concatenate([pole, pole[pole.imag > 0].conj()])
    residues = np.concatenate([residue, residue[pole.imag > 0].conj()])
    n, scale = poles.size, np.abs(poles).max() or 1.0
    pencil = np.zeros((2 * n + 1, 2 * n + 1), dtype=complex)
    pencil[np.arange(2 * n), np.arange(2 * n)] = np.concatenate([poles, -poles]) / scale
    pencil[:-1, -1], pencil[-1, :-1] = 1.0, np.tile(residues, 2) / np.abs(residues).max()
    zeros = scipy.linalg.eigvals(pencil, np.diag(np.append(np.ones(2 * n), 0.0)))
    zeros = zeros[np.isfinite(zeros)]
    return np.asarray(scale * zeros.imag[(np.abs(zeros.real) < 1e-6 * np.abs(zeros)) & (zeros.imag > 0)])

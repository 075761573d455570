"""Transfer function of a pantograph: its receptance at the head as poles and residues, stable and passive.

    receptance(s) = sum of r / (s - p) over all poles, the conjugate ones included          [m/N]

A head is passive if it delivers no energy: Im receptance(i omega) <= 0 at every omega > 0. The sign can change where
receptance(s) - receptance(-s) has a zero on the imaginary axis; these are eigenvalues of a pencil.
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
import scipy  # loads its parts when they are used
from numpy.typing import NDArray
from pydantic import Field

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.features import Feature
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.sourced_table import Positive, Problems, SourcedTable, cross_check, validation_problem
from pantocheck.conformance.pantograph.chain_problem import MeasuredStiffness

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


# Transfer function of a head from its measured response: poles of a chain fit start a vector fit (Gustavsen 1999).
#
#     receptance(s) = sum of r / (s - p)        sigma(s) = 1 + sum of c / (s - p):    sigma H = sum of r' / (s - p)
#
# Each iteration solves the linear problem for c and moves the poles to the zeros of sigma; unstable ones are mirrored.
# The residues of the last poles are those of the nearest passive model.
ITERATIONS = 30
"""Moves of the poles."""

FIRST_DAMPING_RATIO = 0.05
"""Damping ratio of the start poles."""


@dataclass(frozen=True)
class FittedTransfer:
    """Fitted stable and passive receptance."""

    pole: ComplexArray
    residue: ComplexArray
    """Poles with an imaginary part of zero or above, and their residues, (n,) [1/s, m/(N s)]."""
    distance: float
    """Largest change of the receptance by the step to the nearest passive model, over its size [-]."""
    deviation: float
    """RMS deviation from the measured receptance, over its size [-]."""


def fit_transfer_function(data: MeasuredStiffness, pairs: int) -> FittedTransfer:
    """Fit a transfer function with pairs of poles to the joined responses of a head.

    Args:
        data: Measured responses.
        pairs: Number of conjugate pairs.

    Raises:
        InputError: There are fewer than three rows per pair.
    """
    if data.frequency.size < 3 * pairs:
        raise InputError("the responses", f"have {data.frequency.size} values", f"Give at least {3 * pairs}.")
    omega = 2 * np.pi * np.geomspace(data.frequency.min(), data.frequency.max(), pairs)
    pole, s, value = -FIRST_DAMPING_RATIO * omega + 1j * omega, data.s, 1 / data.stiffness
    weight = np.sqrt(np.prod(data.weight, axis=0)) / np.abs(value)
    for _ in range(ITERATIONS):
        basis = _basis(pole, s)
        system = weight[:, None] * np.hstack([basis, -value[:, None] * basis])
        solution = _solve(system, weight * value)[basis.shape[1] :]
        pole = _move(pole, solution)
    residue = _residues(pole, _solve(weight[:, None] * _basis(pole, s), weight * value))
    distance = 0.0
    if find_activity(pole, residue).size:
        passive = find_nearest_passive(pole, residue)
        distance, residue = relative_distance(pole, residue, passive), passive
    error = receptance(pole, residue, s.imag) / value - 1
    return FittedTransfer(pole, residue, distance, float(np.sqrt(np.mean(np.abs(error) ** 2))))


def _basis(pole: ComplexArray, s: ComplexArray) -> ComplexArray:
    """Real base functions of every pole: one of a real pole, two of a pair, (m, k)."""
    columns = []
    for p in pole:
        one, other = 1 / (s - p), 1 / (s - p.conjugate())
        columns += [one + other, 1j * (one - other)] if p.imag else [one]
    return np.asarray(np.array(columns).T)


def _solve(system: ComplexArray, value: ComplexArray) -> RealArray:
    """Real least-squares solution of complex equations, with columns of equal size."""
    rows, right = np.vstack([system.real, system.imag]), np.concatenate([value.real, value.imag])
    scale = np.linalg.norm(rows, axis=0)
    return np.asarray(np.linalg.lstsq(rows / scale, right, rcond=None)[0] / scale)


def _residues(pole: ComplexArray, parts: RealArray) -> ComplexArray:
    """Residue of every pole from the coefficients of the base functions."""
    found, rest = [], list(parts)
    for p in pole:
        found.append(complex(rest.pop(0), rest.pop(0)) if p.imag else complex(rest.pop(0)))
    return np.array(found)


def _move(pole: ComplexArray, parts: RealArray) -> ComplexArray:
    """Zeros of sigma: eigenvalues of the matrix of the poles less the product of its input and its coefficients."""
    blocks, drive = [], list[float]()
    for p in pole:
        blocks.append(np.array([[p.real, p.imag], [-p.imag, p.real]]) if p.imag else np.array([[p.real]]))
        drive += [2.0, 0.0] if p.imag else [1.0]
    size = len(drive)
    matrix, place = np.zeros((size, size)), 0
    for block in blocks:
        matrix[place : place + len(block), place : place + len(block)] = block
        place += len(block)
    zeros = np.linalg.eigvals(matrix - np.outer(drive, parts))
    stable = -np.abs(zeros.real) + 1j * zeros.imag
    return np.asarray(np.sort_complex(stable[stable.imag >= 0]))  # a pair stays as the one above the real axis

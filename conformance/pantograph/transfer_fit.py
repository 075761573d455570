"""Transfer function of a head from its measured response: poles of a chain fit start a vector fit (Gustavsen 1999).

    receptance(s) = sum of r / (s - p)        sigma(s) = 1 + sum of c / (s - p):    sigma H = sum of r' / (s - p)

Each iteration solves the linear problem for c and moves the poles to the zeros of sigma; unstable ones are mirrored.
The residues of the last poles are those of the nearest passive model.
"""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.pantograph.chain_problem import MeasuredStiffness
from pantocheck.conformance.pantograph.transfer_function import (
    find_activity,
    find_nearest_passive,
    receptance,
    relative_distance,
)

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

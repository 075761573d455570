"""Local fit: poles and spectral lines near one frequency, without the contribution of distant poles.

A local fit with one pole more or less takes milliseconds.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.array_types import ComplexArray, RealArray
from pantocheck.conformance.identification.column_factors import factor_columns, solve_factor
from pantocheck.conformance.identification.decay_kernel import (
    decay_kernel,
    far_pole_columns,
    join_conjugates,
    stack_real_imaginary,
)
from pantocheck.conformance.identification.projection import DataBlock, ProjectionFit, pole_columns

MIN_LOCAL_LINES = 8
"""Smallest number of spectral lines of a block in a local fit."""

LEAST_DETERMINANT = 1e-10
"""Smallest determinant of the Gram matrix of two columns of unit length that count as independent [-]."""

DAMPING_TRIALS = (0.3, 1.0, 3.0)
"""Decay rates of trial poles over the median decay rate of their neighbours [-]."""


@dataclass(frozen=True)
class LocalFit:
    """Poles near one frequency, their mask among all poles, and blocks with the spectral lines near this frequency.

    The contribution of distant poles is removed from the lines.
    """

    poles: ComplexArray
    near: NDArray[np.bool_]
    blocks: list[DataBlock]


def restrict_fit(
    poles: ComplexArray, blocks: list[DataBlock], fits: list[ProjectionFit], centre: float, min_half: float = 0.0
) -> LocalFit:
    """Restrict a fit to the neighbourhood of one frequency.

    Args:
        poles: All poles, (m,) [1/s].
        blocks: Data, each channel in units of its noise.
        fits: Fits of the blocks with all poles.
        centre: Centre of the neighbourhood [rad/s].
        min_half: Lower limit of the half-width of the neighbourhood [rad/s].

    Returns:
        Poles and spectral lines in the neighbourhood.
    """
    resolution = 2 * np.pi / min(data.duration for data in blocks)
    half = max(12 * resolution, 2 * np.pi * 0.15, min_half)
    near = np.abs(poles.imag - centre) < half
    local = []
    for data, fit in zip(blocks, fits, strict=True):
        window = np.abs(data.omega - centre) < half + 6 * resolution
        if window.sum() < MIN_LOCAL_LINES:
            continue
        omega = data.omega[window]
        terms = far_pole_columns(omega, 2)
        # Real and imaginary part of each line are equations; one pole may be added. A crowded short record has too few.
        if 2 * omega.size < 2 * (int(near.sum()) + 1) + terms.shape[1]:
            continue
        residues = np.concatenate([fit.residues[near], fit.residues[near].conj()])
        kernels = decay_kernel(join_conjugates(poles[near]), omega, data.dt, data.n)
        spectrum = fit.residual[window] + kernels @ residues
        local.append(DataBlock(data.lines[window], spectrum, data.dt, data.n, terms))
    return LocalFit(poles[near], near, local)


def find_best_candidate(local: LocalFit, centre: float) -> tuple[complex, float] | None:
    """Find the trial pole near a frequency [rad/s] with the largest reduction of the squared residual; return both."""
    resolution = 2 * np.pi / max(data.duration for data in local.blocks)
    decay = float(np.median(-local.poles.real)) if local.poles.size else 0.003 * centre
    omegas = centre + resolution * np.arange(-3, 3.01, 0.25)
    trials = np.array([-decay * factor + 1j * omega for factor in DAMPING_TRIALS for omega in omegas if omega > 0])
    gain = np.zeros(trials.size)
    for data in local.blocks:
        present = pole_columns(local.poles, data)
        q, _ = factor_columns(np.hstack([present, data.residual_terms]))
        x = stack_real_imaginary(data.spectrum)
        residual = x - q @ (q.T @ x)
        new = pole_columns(trials, data)
        new -= q @ (q.T @ new)
        gain += _pair_gains(new[:, : trials.size], new[:, trials.size :], residual)
    best = int(np.argmax(gain))
    return (complex(trials[best]), float(gain[best])) if gain[best] > 0 else None


def _pair_gains(first: RealArray, second: RealArray, residual: RealArray) -> RealArray:
    """Reduction of the squared residual, (n, c), by each pair of columns, (n, t) and (n, t): b' G^-1 b, (t,)."""
    g11, g12, g22 = (np.einsum("nt,nt->t", a, b) for a, b in ((first, first), (first, second), (second, second)))
    b1, b2 = first.T @ residual, second.T @ residual
    forms = g22 * np.sum(b1**2, axis=1) - 2 * g12 * np.sum(b1 * b2, axis=1) + g11 * np.sum(b2**2, axis=1)
    determinant = g11 * g22 - g12**2
    independent = determinant > LEAST_DETERMINANT * g11 * g22
    return np.asarray(np.where(independent, forms / np.where(independent, determinant, 1.0), 0.0))


def pole_contributions(poles: ComplexArray, blocks: list[DataBlock]) -> RealArray:
    """Reduction of the squared residual by each pole, with all other poles present, (m,)."""
    m = poles.size
    reduction = np.zeros(m)
    for data in blocks:
        q, r = factor_columns(np.hstack([pole_columns(poles, data), data.residual_terms]))
        inverse = solve_factor(r, np.eye(r.shape[0]))
        coefficients = inverse @ (q.T @ stack_real_imaginary(data.spectrum))
        for j in range(m):
            pair = [j, j + m]
            covariance = inverse[pair] @ inverse[pair].T
            reduction[j] += float(np.sum(coefficients[pair] * np.linalg.solve(covariance, coefficients[pair])))
    return reduction


def crowded_poles(poles: ComplexArray, blocks: list[DataBlock]) -> NDArray[np.bool_]:
    """Mask of the poles so close to another one that one of the two may be superfluous, (m,)."""
    resolution = 2 * np.pi / max(data.duration for data in blocks)
    distance = np.abs(poles[:, None] - poles[None, :]) + np.where(np.eye(poles.size) > 0, np.inf, 0)
    return np.asarray(distance.min(axis=1, initial=np.inf) < 1.5 * resolution)

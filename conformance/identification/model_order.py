"""How many poles: poles are added where the residual asks for one, and removed where the data can do without.

Every trial is local: the lines around a frequency, with the contribution of distant poles taken off, so that it costs
milliseconds. A pole stays when it lowers the squared error by more than noise would in one line of a thousand records
(chi-square with two parameters for the pole and two for each channel).
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import scipy.linalg
import scipy.stats
from numpy.typing import NDArray

from pantocheck.conformance.array_types import ComplexArray, RealArray
from pantocheck.conformance.identification.decay_kernel import (
    decay_kernel,
    far_pole_columns,
    real_columns,
    stack_real_imaginary,
)
from pantocheck.conformance.identification.pole_refinement import refine_poles
from pantocheck.conformance.identification.projection import DataBlock, ProjectionFit, solve_residues

FALSE_ALARM = 1e-3  # chance that noise alone adds one pole to a record
OUTSIDE = 0.5  # how far beyond the band a pole may settle [Hz]
LEAST_LINES = 8  # fewer lines than this tell nothing of a pole
SECTION = 0.7  # width of what is refined together [Hz]
DAMPING_TRIALS = (0.3, 1.0, 3.0)  # of the neighbours' median decay rate


@dataclass(frozen=True)
class PoleSelection:
    """Poles that the data support.

    Parameters
    ----------
    poles : (m,) complex ndarray
        [1/s], by frequency.
    noise : list[ndarray]
        Per block, (c,) standard deviation of a line's real or imaginary part.
    """

    poles: ComplexArray
    noise: list[RealArray]


def select_poles(poles: ComplexArray, blocks: list[DataBlock], rounds: int = 8) -> PoleSelection:
    """Refine, add and remove poles until neither helps.

    Parameters
    ----------
    poles : (m,) complex ndarray
        Start values [1/s].
    blocks : list[DataBlock]
        Data in physical units.
    rounds : int
        At most so many.
    """
    noise = _noise(poles, blocks)
    settled: ComplexArray | None = None
    for _ in range(rounds):
        poles = _in_band(_sweep(_in_band(poles, blocks), whiten(blocks, noise)), blocks)
        if settled is not None and _same(poles, settled):
            break
        settled = poles
        noise = _noise(poles, blocks)
        white = whiten(blocks, noise)
        poles = _remove(_add(poles, white), white)
    poles = refine_poles(_in_band(poles, blocks), whiten(blocks, noise)).poles
    return PoleSelection(poles, _noise(poles, blocks))


def find_hidden_poles(found: PoleSelection, blocks: list[DataBlock]) -> PoleSelection:
    """Look for a second mode hidden under each pole, where the residual shows too little to be noticed, then settle.

    Parameters
    ----------
    found : PoleSelection
        What `settle` found.
    blocks : list[DataBlock]
        Data in physical units.
    """
    white = whiten(blocks, found.noise)
    extended = _add(found.poles, white, [float(omega) for omega in found.poles.imag])
    if _same(extended, found.poles):
        return found
    return select_poles(extended, blocks, rounds=3)


def _noise(poles: ComplexArray, blocks: list[DataBlock]) -> list[RealArray]:
    return [estimate_noise(solve_residues(poles, data), poles.size, data) for data in blocks]


def _in_band(poles: ComplexArray, blocks: list[DataBlock]) -> ComplexArray:
    """Poles in the band or just outside: a strong mode beyond the edge leaks in, and stays as a residual term."""
    low = min(data.omega[0] for data in blocks)
    high = max(data.omega[-1] for data in blocks)
    return np.asarray(poles[(poles.imag > low / 2) & (poles.imag < high + 2 * np.pi * OUTSIDE)])


def whiten(blocks: list[DataBlock], noise: list[RealArray]) -> list[DataBlock]:
    """Blocks with each channel in units of its noise."""
    return [replace(data, spectrum=data.spectrum / sigma) for data, sigma in zip(blocks, noise, strict=True)]


def estimate_noise(fit: ProjectionFit, poles: int, data: DataBlock) -> RealArray:
    """Standard deviation of the real or imaginary part of a line, per channel, (c,).

    From the median over the lines, which a few unmodelled peaks do not move; |r|^2 / (2 sigma^2) of white noise has
    the median ln 2. Corrected for the parameters spent.
    """
    rows, channels = 2 * data.lines.size, data.spectrum.shape[1]
    spent = 2 * poles + data.residual_terms.shape[1] + 2 * poles / channels
    share_left = max(1 - spent / rows, 0.1)
    median = np.median(np.abs(fit.residual) ** 2, axis=0)
    return np.asarray(np.sqrt(np.maximum(median, np.finfo(float).tiny) / (2 * np.log(2) * share_left)))


def detection_threshold(blocks: list[DataBlock]) -> float:
    """Least drop in squared error, in units of the noise, that a pole must bring."""
    channels = sum(data.spectrum.shape[1] for data in blocks)
    lines = max(data.lines.size for data in blocks)
    return float(scipy.stats.chi2.isf(FALSE_ALARM / (4 * lines), 2 + 2 * channels))


def _add(poles: ComplexArray, blocks: list[DataBlock], centres: list[float] | None = None) -> ComplexArray:
    """Poles with those added that pay; tried at the centres [rad/s], or where the residual asks for it."""
    least = detection_threshold(blocks)
    fits = [solve_residues(poles, data) for data in blocks]
    for centre in _suspicious(blocks, fits) if centres is None else centres:
        local = _local(poles, blocks, fits, centre)
        trial = _best_candidate(local, centre) if local.blocks else None
        if trial is None or trial[1] < 0.3 * least:
            continue
        before = refine_poles(local.poles, local.blocks, iterations=10, tolerance=0.1)
        after = refine_poles(np.append(local.poles, trial[0]), local.blocks, iterations=60, tolerance=0.1)
        if before.cost - after.cost > least:
            poles = np.concatenate([poles[~local.near], after.poles])
            fits = [solve_residues(poles, data) for data in blocks]
    return np.asarray(poles[np.argsort(poles.imag)])


def _remove(poles: ComplexArray, blocks: list[DataBlock]) -> ComplexArray:
    least = detection_threshold(blocks)
    weight = _weights(poles, blocks)
    doubtful = np.flatnonzero((weight < 3 * least) | _crowded(poles, blocks))
    fits = [solve_residues(poles, data) for data in blocks]
    for pole in poles[doubtful[np.argsort(weight[doubtful])]]:
        at = int(np.argmin(np.abs(poles - pole)))
        local = _local(poles, blocks, fits, poles[at].imag)
        if not local.blocks:
            continue
        others = local.poles[np.abs(local.poles - poles[at]) > 0]
        with_it = refine_poles(local.poles, local.blocks, iterations=10, tolerance=0.1)
        without = refine_poles(others, local.blocks, iterations=15, tolerance=0.1)
        # Less than it takes to enter, or a pole on the edge would come and go for ever.
        if without.cost - with_it.cost < 0.7 * least:
            poles = _in_band(np.concatenate([poles[~local.near], without.poles]), blocks)
            fits = [solve_residues(poles, data) for data in blocks]
    return np.asarray(poles[np.argsort(poles.imag)])


def _sweep(poles: ComplexArray, blocks: list[DataBlock]) -> ComplexArray:
    """Refine section by section, each with its neighbours: near the optimum in a tenth of the time."""
    for _ in range(2):
        fits = [solve_residues(poles, data) for data in blocks]
        moved = []
        edges = 2 * np.pi * np.arange(0, poles.imag.max(initial=0.0) / (2 * np.pi) + SECTION, SECTION)
        for low, high in pairwise(edges):
            if not np.any((poles.imag >= low) & (poles.imag < high)):
                continue
            local = _local(poles, blocks, fits, (low + high) / 2, 2 * np.pi * SECTION)
            inner = (local.poles.imag >= low) & (local.poles.imag < high)
            refined = (
                refine_poles(local.poles, local.blocks, iterations=8, tolerance=0.3).poles
                if local.blocks
                else local.poles
            )
            moved.append(refined[inner])
        poles = np.concatenate([*moved, np.zeros(0, dtype=np.complex128)])
    return np.asarray(poles[np.argsort(poles.imag)])


def _same(a: ComplexArray, b: ComplexArray) -> bool:
    return a.size == b.size and bool(np.all(np.abs(a - b) < 0.01 * np.abs(b.real)))


@dataclass(frozen=True)
class _Local:
    """The neighbourhood of a frequency: its poles (where `near`) and its lines without the distant poles' share."""

    poles: ComplexArray
    near: NDArray[np.bool_]
    blocks: list[DataBlock]


def _local(
    poles: ComplexArray, blocks: list[DataBlock], fits: list[ProjectionFit], centre: float, least_half: float = 0.0
) -> _Local:
    resolution = 2 * np.pi / min(data.duration for data in blocks)
    half = max(12 * resolution, 2 * np.pi * 0.15, least_half)
    near = np.abs(poles.imag - centre) < half
    narrowed = []
    for data, fit in zip(blocks, fits, strict=True):
        window = np.abs(data.omega - centre) < half + 6 * resolution
        if window.sum() < LEAST_LINES:
            continue
        omega = data.omega[window]
        residues = fit.residues[near]
        share = decay_kernel(poles[near], omega, data.dt, data.n) @ residues
        share += decay_kernel(poles[near].conj(), omega, data.dt, data.n) @ residues.conj()
        spectrum = fit.residual[window] + share
        narrowed.append(DataBlock(data.lines[window], spectrum, data.dt, data.n, far_pole_columns(omega, 2)))
    return _Local(poles[near], near, narrowed)


def _suspicious(blocks: list[DataBlock], fits: list[ProjectionFit]) -> list[float]:
    """Angular frequencies [rad/s] where three lines together hold more than noise, strongest first."""
    found: list[tuple[float, float]] = []
    for data, fit in zip(blocks, fits, strict=True):
        energy = np.convolve(np.sum(np.abs(fit.residual) ** 2, axis=1), np.ones(3), mode="same")
        limit = scipy.stats.chi2.isf(1e-4, 6 * data.spectrum.shape[1])
        found += [(float(energy[k]), float(data.omega[k])) for k in np.flatnonzero(energy > limit)]
    spacing = 6 * 2 * np.pi / max(data.duration for data in blocks)
    centres: list[float] = []
    for _, omega in sorted(found, reverse=True):
        if all(abs(omega - other) > spacing for other in centres):
            centres.append(omega)
    return centres[:40]


def _best_candidate(local: _Local, centre: float) -> tuple[complex, float] | None:
    """The pole that would take most off the residual, all others held, and how much (score test on a grid)."""
    resolution = 2 * np.pi / max(data.duration for data in local.blocks)
    decay = float(np.median(-local.poles.real)) if local.poles.size else 0.003 * centre
    omegas = centre + resolution * np.arange(-3, 3.01, 0.25)
    trials = np.array([-decay * factor + 1j * omega for factor in DAMPING_TRIALS for omega in omegas if omega > 0])
    gain = np.zeros(trials.size)
    for data in local.blocks:
        present = real_columns(
            decay_kernel(local.poles, data.omega, data.dt, data.n),
            decay_kernel(local.poles.conj(), data.omega, data.dt, data.n),
        )
        q = scipy.linalg.qr(np.hstack([present, data.residual_terms]), mode="economic")[0]
        x = stack_real_imaginary(data.spectrum)
        residual = x - q @ (q.T @ x)
        new = real_columns(
            decay_kernel(trials, data.omega, data.dt, data.n), decay_kernel(trials.conj(), data.omega, data.dt, data.n)
        )
        new -= q @ (q.T @ new)
        for t in range(trials.size):
            pair = np.linalg.qr(new[:, [t, t + trials.size]])[0]
            gain[t] += float(np.sum((pair.T @ residual) ** 2))
    best = int(np.argmax(gain))
    return (complex(trials[best]), float(gain[best])) if gain[best] > 0 else None


def _weights(poles: ComplexArray, blocks: list[DataBlock]) -> RealArray:
    """What each pole takes off the squared error with all other poles held, (m,)."""
    m = poles.size
    taken = np.zeros(m)
    for data in blocks:
        columns = real_columns(
            decay_kernel(poles, data.omega, data.dt, data.n), decay_kernel(poles.conj(), data.omega, data.dt, data.n)
        )
        q, r = scipy.linalg.qr(np.hstack([columns, data.residual_terms]), mode="economic")
        inverse = scipy.linalg.pinv(r)
        coefficients = inverse @ (q.T @ stack_real_imaginary(data.spectrum))
        for j in range(m):
            pair = [j, j + m]
            covariance = inverse[pair] @ inverse[pair].T
            taken[j] += float(np.sum(coefficients[pair] * np.linalg.solve(covariance, coefficients[pair])))
    return taken


def _crowded(poles: ComplexArray, blocks: list[DataBlock]) -> NDArray[np.bool_]:
    """Poles so near another that one of the two may be idle."""
    resolution = 2 * np.pi / max(data.duration for data in blocks)
    distance = np.abs(poles[:, None] - poles[None, :]) + np.where(np.eye(poles.size) > 0, np.inf, 0)
    return np.asarray(distance.min(axis=1, initial=np.inf) < 1.5 * resolution)

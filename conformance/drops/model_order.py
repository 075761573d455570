"""Model order: poles are added where the residual exceeds the noise, and removed where they do not reduce the residual.

A pole is kept if it reduces the squared residual by more than noise does in one of a thousand records (chi-square with
two parameters for the pole and two for each channel). Each pole is tried in a local fit.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.drops.decay_kernel import (
    decay_kernel,
    far_pole_columns,
    join_conjugates,
)
from pantocheck.conformance.drops.elimination import factor_columns, solve_factor
from pantocheck.conformance.drops.pole_refinement import refine_poles
from pantocheck.conformance.drops.projection import (
    DataBlock,
    Noise,
    ProjectionFit,
    estimate_noise,
    pole_columns,
    solve_residues,
    whiten,
)

FALSE_ALARM = 1e-3
"""Probability that noise alone adds a pole to a record."""

OUTSIDE = 0.5
"""Largest distance of a pole above the band [Hz]."""

SECTION = 0.7
"""Width of the band whose poles are refined together [Hz]."""

MAX_TRIALS = 40
"""Largest number of frequencies in one round at which a pole is tried."""


@dataclass(frozen=True)
class PoleSelection:
    """Selected poles in the order of frequency [1/s], and the noise of each block."""

    poles: ComplexArray
    noise: list[Noise]


NoiseEstimate = Callable[[ComplexArray, list[DataBlock], list[Noise] | None], list[Noise]]
"""Noise of each block from the poles of the decays, the blocks, and the noise estimated before."""


def select_poles(poles: ComplexArray, blocks: list[DataBlock], rounds: int = 8) -> PoleSelection:
    """Refine start poles [1/s], and add and remove poles, until they no longer change, in at most `rounds` rounds.

    The noise of each channel is white.
    """
    found = repeat_selection(poles, blocks, rounds, lambda trial, data, _: estimate_block_noise(trial, data), 0.01)
    poles = refine_poles(_keep_in_band(found.poles, blocks), whiten(blocks, found.noise)).poles
    return PoleSelection(poles, estimate_block_noise(poles, blocks))


def repeat_selection(
    poles: ComplexArray,
    blocks: list[DataBlock],
    rounds: int,
    estimate: NoiseEstimate,
    equal: float,
    search: bool = True,
) -> PoleSelection:
    """Select poles as `select_poles`, with any noise, until they change by less than a share of their decay rates.

    Without a search, no pole is added or removed.
    """
    noise = estimate(poles, blocks, None)
    previous: ComplexArray | None = None
    for _ in range(rounds):
        poles = _keep_in_band(_refine_sections(_keep_in_band(poles, blocks), whiten(blocks, noise)), blocks)
        if previous is not None and _are_equal(poles, previous, equal):
            break
        previous = poles
        noise = estimate(poles, blocks, noise)
        if search:
            white = whiten(blocks, noise)
            poles = _remove_poles(_add_poles(poles, white, None), white)
    return PoleSelection(poles, noise)


def find_hidden_poles(selection: PoleSelection, blocks: list[DataBlock]) -> PoleSelection:
    """Try a second pole near each selected pole, where the residual does not exceed the noise, and select again."""
    white = whiten(blocks, selection.noise)
    extended = _add_poles(selection.poles, white, [float(omega) for omega in selection.poles.imag])
    if _are_equal(extended, selection.poles):
        return selection
    return select_poles(extended, blocks, rounds=3)


def estimate_block_noise(poles: ComplexArray, blocks: list[DataBlock]) -> list[Noise]:
    """Noise of the channels of each block, from the residual of a fit with the poles [1/s]."""
    return [estimate_noise(solve_residues(poles, data), poles.size, data) for data in blocks]


def _keep_in_band(poles: ComplexArray, blocks: list[DataBlock]) -> ComplexArray:
    """Poles inside or near the band; a pole just outside represents the leakage of a strong mode into the band."""
    low = min(data.omega[0] for data in blocks)
    high = max(data.omega[-1] for data in blocks)
    return np.asarray(poles[(poles.imag > low / 2) & (poles.imag < high + 2 * np.pi * OUTSIDE)])


def detection_threshold(blocks: list[DataBlock]) -> float:
    """Smallest reduction of the squared residual by a pole that is kept."""
    channels = sum(data.spectrum.shape[1] for data in blocks)
    lines = max(data.lines.size for data in blocks)
    return float(scipy.special.chdtri(2 + 2 * channels, FALSE_ALARM / (4 * lines)))


def _add_poles(poles: ComplexArray, blocks: list[DataBlock], centres: list[float] | None) -> ComplexArray:
    """Add poles that reduce the residual; they are tried at the centres [rad/s], or where it exceeds the noise."""
    least = detection_threshold(blocks)
    fits = [solve_residues(poles, data) for data in blocks]
    for centre in _suspicious_frequencies(blocks, fits) if centres is None else centres:
        local = restrict_fit(poles, blocks, fits, centre)
        trial = find_best_candidate(local, centre) if local.blocks else None
        if trial is None or trial[1] < 0.3 * least:
            continue
        after = refine_poles(np.append(local.poles, trial[0]), local.blocks, iterations=60, tolerance=0.1)
        if _cost_exceeds(local, after.cost + least):
            poles = np.concatenate([poles[~local.near], after.poles])
            fits = [solve_residues(poles, data) for data in blocks]
    return np.asarray(poles[np.argsort(poles.imag)])


def _cost_exceeds(local: "LocalFit", limit: float) -> bool:
    """Whether the cost of a local fit exceeds a limit; its poles are refined only if they exceed it before."""
    return all(refine_poles(local.poles, local.blocks, steps, tolerance=0.1).cost > limit for steps in (0, 10))


def _remove_poles(poles: ComplexArray, blocks: list[DataBlock]) -> ComplexArray:
    """Remove the poles that do not reduce the squared residual noticeably."""
    least = detection_threshold(blocks)
    fits = [solve_residues(poles, data) for data in blocks]
    white = all(data.whitening is None for data in blocks)
    contribution = pole_contributions(poles, blocks) if white else _local_contributions(poles, blocks, fits)
    doubtful = np.flatnonzero((contribution < 3 * least) | crowded_poles(poles, blocks))
    for pole in poles[doubtful[np.argsort(contribution[doubtful])]]:
        nearest = int(np.argmin(np.abs(poles - pole)))
        local = restrict_fit(poles, blocks, fits, poles[nearest].imag)
        if not local.blocks:
            continue
        others = local.poles[np.abs(local.poles - poles[nearest]) > 0]
        without = refine_poles(others, local.blocks, iterations=15, tolerance=0.1)
        # The threshold is lower than that for adding; otherwise a pole near it would be added and removed repeatedly.
        if _cost_exceeds(local, without.cost - 0.7 * least):
            poles = _keep_in_band(np.concatenate([poles[~local.near], without.poles]), blocks)
            fits = [solve_residues(poles, data) for data in blocks]
    return np.asarray(poles[np.argsort(poles.imag)])


def _refine_sections(poles: ComplexArray, blocks: list[DataBlock]) -> ComplexArray:
    """Refine the poles section by section, each with its neighbours; this takes a tenth of the time of a full fit."""
    for _ in range(2):
        fits = [solve_residues(poles, data) for data in blocks]
        refined = [np.zeros(0, dtype=np.complex128)]
        for local, inner in _split_into_sections(poles, blocks, fits):
            section = local.poles
            if local.blocks:
                section = refine_poles(local.poles, local.blocks, iterations=8, tolerance=0.3).poles
            refined.append(section[inner])
        poles = np.concatenate(refined)
    return np.asarray(poles[np.argsort(poles.imag)])


def _split_into_sections(
    poles: ComplexArray, blocks: list[DataBlock], fits: list[ProjectionFit]
) -> Iterator[tuple["LocalFit", NDArray[np.bool_]]]:
    """Local fit of each section with poles, and the mask of its own poles among those of the local fit."""
    width = 2 * np.pi * SECTION
    for low, high in pairwise(np.arange(0, poles.imag.max(initial=0.0) + width, width)):
        if np.any((poles.imag >= low) & (poles.imag < high)):
            local = restrict_fit(poles, blocks, fits, (low + high) / 2, width)
            yield local, (local.poles.imag >= low) & (local.poles.imag < high)


def _local_contributions(poles: ComplexArray, blocks: list[DataBlock], fits: list[ProjectionFit]) -> RealArray:
    """Reduction of the squared residual by each pole in the fit of its section, (m,)."""
    contribution = np.full(poles.size, np.inf)
    for local, inner in _split_into_sections(poles, blocks, fits):
        if local.blocks:
            contribution[np.flatnonzero(local.near)[inner]] = pole_contributions(local.poles, local.blocks)[inner]
    return contribution


def _are_equal(a: ComplexArray, b: ComplexArray, share: float = 0.01) -> bool:
    """Whether two sets of poles agree to a share of their decay rates."""
    return a.size == b.size and bool(np.all(np.abs(a - b) < share * np.abs(b.real)))


def _suspicious_frequencies(blocks: list[DataBlock], fits: list[ProjectionFit]) -> list[float]:
    """Angular frequencies [rad/s] where three neighbouring lines exceed the noise, in descending order of energy."""
    peaks: list[tuple[float, float]] = []
    for data, fit in zip(blocks, fits, strict=True):
        energy = np.convolve(np.sum(np.abs(data.weigh(fit.residual)) ** 2, axis=1), np.ones(3), mode="same")
        limit = scipy.special.chdtri(6 * data.spectrum.shape[1], 1e-4)
        peaks += [(float(energy[k]), float(data.omega[k])) for k in np.flatnonzero(energy > limit)]
    spacing = 6 * 2 * np.pi / max(data.duration for data in blocks)
    centres: list[float] = []
    for _, omega in sorted(peaks, reverse=True):
        if all(abs(omega - other) > spacing for other in centres):
            centres.append(omega)
    return centres[:MAX_TRIALS]


# Local fit: poles and spectral lines near one frequency, without the contribution of distant poles.
#
# A local fit with one pole more or less takes milliseconds.
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
        whitening = None if data.whitening is None else data.whitening[window]
        local.append(DataBlock(data.lines[window], spectrum, data.dt, data.n, terms, whitening))
    return LocalFit(poles[near], near, local)


def find_best_candidate(local: LocalFit, centre: float) -> tuple[complex, float] | None:
    """Find the trial pole near a frequency [rad/s] with the largest reduction of the squared residual; return both."""
    resolution = 2 * np.pi / max(data.duration for data in local.blocks)
    decay = float(np.median(-local.poles.real)) if local.poles.size else 0.003 * centre
    omegas = centre + resolution * np.arange(-3, 3.01, 0.25)
    trials = np.array([-decay * factor + 1j * omega for factor in DAMPING_TRIALS for omega in omegas if omega > 0])
    gain = np.zeros(trials.size)
    for data in local.blocks:
        present = np.hstack([pole_columns(local.poles, data), data.residual_terms])
        q, _ = factor_columns(data.arrange(present).expand())
        x = data.signals
        residual = x - q @ (q.T @ x)
        new = data.arrange(pole_columns(trials, data)).expand()
        new -= q @ (q.T @ new)
        if data.whitening is None:
            gain += _pair_gains(new[:, : trials.size], new[:, trials.size :], residual)
        else:
            gain += _block_gains(new.reshape(new.shape[0], 2, trials.size, -1), residual[:, 0])
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


def _block_gains(columns: RealArray, residual: RealArray) -> RealArray:
    """Reduction of the squared residual, (n,), by the columns of each trial pole at all channels, (n, 2, t, c)."""
    n, _, trials, channels = columns.shape
    own = columns.transpose(2, 0, 1, 3).reshape(trials, n, 2 * channels)
    gram = own.transpose(0, 2, 1) @ own
    gram += LEAST_DETERMINANT * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(2 * channels)
    right = own.transpose(0, 2, 1) @ residual
    return np.asarray(np.sum(right * np.linalg.solve(gram, right[:, :, None])[:, :, 0], axis=1))


def pole_contributions(poles: ComplexArray, blocks: list[DataBlock]) -> RealArray:
    """Reduction of the squared residual by each pole, with all other poles present, (m,)."""
    m = poles.size
    reduction = np.zeros(m)
    for data in blocks:
        q, r = factor_columns(data.arrange(np.hstack([pole_columns(poles, data), data.residual_terms])).expand())
        inverse = solve_factor(r, np.eye(r.shape[0]))
        coefficients = inverse @ (q.T @ data.signals)
        width = 1 if data.whitening is None else data.spectrum.shape[1]
        for j in range(m):
            own = [*range(j * width, (j + 1) * width), *range((j + m) * width, (j + m + 1) * width)]
            covariance = inverse[own] @ inverse[own].T
            reduction[j] += float(np.sum(coefficients[own] * np.linalg.solve(covariance, coefficients[own])))
    return reduction


def crowded_poles(poles: ComplexArray, blocks: list[DataBlock]) -> NDArray[np.bool_]:
    """Mask of the poles so close to another one that one of the two may be superfluous, (m,)."""
    resolution = 2 * np.pi / max(data.duration for data in blocks)
    distance = np.abs(poles[:, None] - poles[None, :]) + np.where(np.eye(poles.size) > 0, np.inf, 0)
    return np.asarray(distance.min(axis=1, initial=np.inf) < 1.5 * resolution)

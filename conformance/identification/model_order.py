"""Model order: poles are added where the residual exceeds the noise, and removed where they do not reduce the residual.

A pole is kept if it reduces the squared residual by more than noise does in one of a thousand records (chi-square with
two parameters for the pole and two for each channel). Each pole is tried in a local fit.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy.stats

from pantocheck.conformance.array_types import ComplexArray, RealArray
from pantocheck.conformance.identification.local_fit import (
    crowded_poles,
    find_best_candidate,
    pole_contributions,
    restrict_fit,
)
from pantocheck.conformance.identification.pole_refinement import refine_poles
from pantocheck.conformance.identification.projection import (
    DataBlock,
    ProjectionFit,
    estimate_noise,
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
    """Selected poles in the order of frequency [1/s], and the noise of the c channels of each block, (c,)."""

    poles: ComplexArray
    noise: list[RealArray]


def select_poles(poles: ComplexArray, blocks: list[DataBlock], rounds: int = 8) -> PoleSelection:
    """Refine start poles [1/s], and add and remove poles, until they no longer change, in at most `rounds` rounds."""
    noise = estimate_block_noise(poles, blocks)
    previous: ComplexArray | None = None
    for _ in range(rounds):
        poles = _keep_in_band(_refine_sections(_keep_in_band(poles, blocks), whiten(blocks, noise)), blocks)
        if previous is not None and _are_equal(poles, previous):
            break
        previous = poles
        noise = estimate_block_noise(poles, blocks)
        white = whiten(blocks, noise)
        poles = _remove_poles(_add_poles(poles, white, None), white)
    poles = refine_poles(_keep_in_band(poles, blocks), whiten(blocks, noise)).poles
    return PoleSelection(poles, estimate_block_noise(poles, blocks))


def find_hidden_poles(selection: PoleSelection, blocks: list[DataBlock]) -> PoleSelection:
    """Try a second pole near each selected pole, where the residual does not exceed the noise, and select again."""
    white = whiten(blocks, selection.noise)
    extended = _add_poles(selection.poles, white, [float(omega) for omega in selection.poles.imag])
    if _are_equal(extended, selection.poles):
        return selection
    return select_poles(extended, blocks, rounds=3)


def estimate_block_noise(poles: ComplexArray, blocks: list[DataBlock]) -> list[RealArray]:
    """Noise of the channels of each block, from the residual of a fit with the poles [1/s]."""
    return [estimate_noise(solve_residues(poles, data), poles.size, data) for data in blocks]


def _keep_in_band(poles: ComplexArray, blocks: list[DataBlock]) -> ComplexArray:
    """Poles inside or near the band; a pole just outside represents the leakage of a strong mode into the band."""
    low = min(data.omega[0] for data in blocks)
    high = max(data.omega[-1] for data in blocks)
    return np.asarray(poles[(poles.imag > low / 2) & (poles.imag < high + 2 * np.pi * OUTSIDE)])


def _detection_threshold(blocks: list[DataBlock]) -> float:
    """Smallest reduction of the squared residual by a pole that is kept."""
    channels = sum(data.spectrum.shape[1] for data in blocks)
    lines = max(data.lines.size for data in blocks)
    return float(scipy.stats.chi2.isf(FALSE_ALARM / (4 * lines), 2 + 2 * channels))


def _add_poles(poles: ComplexArray, blocks: list[DataBlock], centres: list[float] | None) -> ComplexArray:
    """Add poles that reduce the residual; they are tried at the centres [rad/s], or where it exceeds the noise."""
    least = _detection_threshold(blocks)
    fits = [solve_residues(poles, data) for data in blocks]
    for centre in _suspicious_frequencies(blocks, fits) if centres is None else centres:
        local = restrict_fit(poles, blocks, fits, centre)
        trial = find_best_candidate(local, centre) if local.blocks else None
        if trial is None or trial[1] < 0.3 * least:
            continue
        before = refine_poles(local.poles, local.blocks, iterations=10, tolerance=0.1)
        after = refine_poles(np.append(local.poles, trial[0]), local.blocks, iterations=60, tolerance=0.1)
        if before.cost - after.cost > least:
            poles = np.concatenate([poles[~local.near], after.poles])
            fits = [solve_residues(poles, data) for data in blocks]
    return np.asarray(poles[np.argsort(poles.imag)])


def _remove_poles(poles: ComplexArray, blocks: list[DataBlock]) -> ComplexArray:
    """Remove the poles that do not reduce the squared residual noticeably."""
    least = _detection_threshold(blocks)
    contribution = pole_contributions(poles, blocks)
    doubtful = np.flatnonzero((contribution < 3 * least) | crowded_poles(poles, blocks))
    fits = [solve_residues(poles, data) for data in blocks]
    for pole in poles[doubtful[np.argsort(contribution[doubtful])]]:
        nearest = int(np.argmin(np.abs(poles - pole)))
        local = restrict_fit(poles, blocks, fits, poles[nearest].imag)
        if not local.blocks:
            continue
        others = local.poles[np.abs(local.poles - poles[nearest]) > 0]
        complete = refine_poles(local.poles, local.blocks, iterations=10, tolerance=0.1)
        without = refine_poles(others, local.blocks, iterations=15, tolerance=0.1)
        # The threshold is lower than that for adding; otherwise a pole near it would be added and removed repeatedly.
        if without.cost - complete.cost < 0.7 * least:
            poles = _keep_in_band(np.concatenate([poles[~local.near], without.poles]), blocks)
            fits = [solve_residues(poles, data) for data in blocks]
    return np.asarray(poles[np.argsort(poles.imag)])


def _refine_sections(poles: ComplexArray, blocks: list[DataBlock]) -> ComplexArray:
    """Refine the poles section by section, each with its neighbours; this takes a tenth of the time of a full fit."""
    width = 2 * np.pi * SECTION
    for _ in range(2):
        fits = [solve_residues(poles, data) for data in blocks]
        refined = [np.zeros(0, dtype=np.complex128)]
        edges = np.arange(0, poles.imag.max(initial=0.0) + width, width)
        for low, high in pairwise(edges):
            if not np.any((poles.imag >= low) & (poles.imag < high)):
                continue
            local = restrict_fit(poles, blocks, fits, (low + high) / 2, width)
            inner = (local.poles.imag >= low) & (local.poles.imag < high)
            section = local.poles
            if local.blocks:
                section = refine_poles(local.poles, local.blocks, iterations=8, tolerance=0.3).poles
            refined.append(section[inner])
        poles = np.concatenate(refined)
    return np.asarray(poles[np.argsort(poles.imag)])


def _are_equal(a: ComplexArray, b: ComplexArray) -> bool:
    """Whether two sets of poles agree to 1 % of their decay rates."""
    return a.size == b.size and bool(np.all(np.abs(a - b) < 0.01 * np.abs(b.real)))


def _suspicious_frequencies(blocks: list[DataBlock], fits: list[ProjectionFit]) -> list[float]:
    """Angular frequencies [rad/s] where three neighbouring lines exceed the noise, in descending order of energy."""
    peaks: list[tuple[float, float]] = []
    for data, fit in zip(blocks, fits, strict=True):
        energy = np.convolve(np.sum(np.abs(fit.residual) ** 2, axis=1), np.ones(3), mode="same")
        limit = scipy.stats.chi2.isf(1e-4, 6 * data.spectrum.shape[1])
        peaks += [(float(energy[k]), float(data.omega[k])) for k in np.flatnonzero(energy > limit)]
    spacing = 6 * 2 * np.pi / max(data.duration for data in blocks)
    centres: list[float] = []
    for _, omega in sorted(peaks, reverse=True):
        if all(abs(omega - other) > spacing for other in centres):
            centres.append(omega)
    return centres[:MAX_TRIALS]

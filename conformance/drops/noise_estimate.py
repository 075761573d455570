"""Estimate of the process noise of a line from the records, and the evidence that there is any."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.drops.decay_kernel import FrequencyBand
from pantocheck.conformance.drops.elimination import factor_columns
from pantocheck.conformance.drops.model_order import PoleSelection, repeat_selection, restrict_fit
from pantocheck.conformance.drops.process_noise import ProcessNoise, deviance, update_components
from pantocheck.conformance.drops.projection import (
    DataBlock,
    Noise,
    ProjectionFit,
    pole_columns,
    solve_residues,
)

FLOOR_WIDTH = 0.5
"""Distance of the nodes of the noise floor [Hz]."""
NOISE_SECTION, NOISE_MARGIN = 2 * np.pi * 0.7, 2 * np.pi * 0.15
"""Width of the band whose noise is estimated together, and that of its margins [rad/s]."""
FIRST_UPDATES, NEXT_UPDATES, LAST_UPDATES = 6, 4, 8
"""Numbers of updates of the variance components: first estimate, each round of the search, last estimate."""
COMMON_SCALES = (1.0, 0.3, 0.1, 0.03)
"""Factors of all powers, to choose the most likely: the updates of single powers approach 0 slowly [-]."""
SEARCH_ROUNDS, EQUAL = 6, 0.1
"""Largest number of rounds of the search, and the share of a decay rate below which a pole no longer moves."""
LEAST_REST_RATIO, SIGNIFICANT = 1.4, 5.0
"""Mean power at rest in the band of the modes over that above it, and over its scatter, that count as motion [-]."""
QUIET_BAND = (12.0, 40.0)
"""Frequencies in which wind hardly moves a line [Hz]."""
LEAST_EXCESS = 1.15
"""Residual in the directions of the modes over its expectation, above which the modes are driven [-].

It is 0.70 to 0.95 in records with white noise alone, and 0.97 to 1.5 with ambient motion of a tenth of that noise.
"""
NEARBY_LINES = 8
"""Number of spectral lines on each side of a mode in this ratio."""


def shows_motion(rest: RealArray, rate: float, band: FrequencyBand) -> bool:
    """Whether the line moves at rest: its channels, (n, c), have more power in the band than above it."""
    if rest.shape[0] < 3 * rate:
        return False
    count = rest.shape[0]
    trend = np.vander(np.linspace(-1.0, 1.0, count), 2)
    level = rest - trend @ np.linalg.lstsq(trend, rest, rcond=None)[0]
    power = np.abs(np.fft.rfft(level * np.hanning(count + 1)[:-1, None], axis=0)) ** 2
    frequency = np.fft.rfftfreq(count, 1 / rate)
    inside = (frequency > max(band.low, 4 * rate / rest.shape[0])) & (frequency < band.fitted)
    above = (frequency > max(band.stop, QUIET_BAND[0])) & (frequency < min(QUIET_BAND[1], 0.45 * rate))
    if inside.sum() < 8 or above.sum() < 8:
        return False
    ratio = float(np.mean(power[inside].mean(axis=0) / np.maximum(power[above].mean(axis=0), np.finfo(float).tiny)))
    # A Hann window correlates neighbouring lines: a line counts as half.
    scatter = np.sqrt(2 * (1 / inside.sum() + 1 / above.sum()) / rest.shape[1])
    return bool(ratio > LEAST_REST_RATIO and ratio > 1 + SIGNIFICANT * scatter)


def residual_excess(poles: ComplexArray, blocks: list[DataBlock]) -> float:
    """Power of the residual in the directions of the modes near their poles, over its expectation for white noise [-].

    It is 1 for white noise, up to its scatter of some percent.
    """
    found = expected = 0.0
    for data in blocks:
        fit = solve_residues(poles, data)
        q, _ = factor_columns(np.hstack([pole_columns(poles, data), data.residual_terms]))
        left = 2 - np.sum((q**2).reshape(2, data.lines.size, -1), axis=(0, 2))
        near = np.abs(data.omega[:, None] - poles.imag) < NEARBY_LINES * 2 * np.pi / data.duration
        far = ~near.any(axis=1)
        used = far if far.sum() > 0.2 * far.size else np.ones_like(far)
        square = np.sum(np.abs(fit.residual[used]) ** 2, axis=0) / np.sum(left[used])
        unit = fit.residues / np.sqrt(square)
        unit /= np.maximum(np.linalg.norm(unit, axis=1, keepdims=True), np.finfo(float).tiny)
        weight = near * np.abs(poles.real / (1j * data.omega[:, None] - poles)) ** 2
        along = np.abs((fit.residual / np.sqrt(square)) @ unit.conj().T) ** 2
        scale = np.maximum(np.sum(weight * left[:, None], axis=0), np.finfo(float).tiny)
        found += float(np.sum(np.sum(weight * along, axis=0) / scale))
        expected += poles.size
    return found / max(expected, 1.0)


def select_driven_poles(poles: ComplexArray, blocks: list[DataBlock], search: bool = True) -> PoleSelection:
    """Select poles from start poles [1/s], with process noise; the noise of the result belongs to its poles.

    Without a search, the start poles are refined in all rounds; none is added, and none in the band is removed.
    """
    selected = repeat_selection(poles, blocks, SEARCH_ROUNDS, estimate_process_noise, EQUAL * search, search)
    return PoleSelection(selected.poles, _estimate(selected.poles, blocks, selected.noise, LAST_UPDATES))


def estimate_process_noise(
    poles: ComplexArray, blocks: list[DataBlock], previous: Sequence[Noise] | None
) -> list[Noise]:
    """Process noise of each block beside the decays of poles [1/s]; driven modes without a decay remain in it."""
    return _estimate(poles, blocks, previous, FIRST_UPDATES if previous is None else NEXT_UPDATES)


def _estimate(
    poles: ComplexArray, blocks: list[DataBlock], previous: Sequence[Noise] | None, updates: int
) -> list[Noise]:
    estimates: list[Noise] = []
    for number, data in enumerate(blocks):
        fit = solve_residues(poles, data)
        before = None if previous is None else previous[number]
        noise = before if isinstance(before, ProcessNoise) else _start_noise(data, fit)
        noise = _follow_poles(noise, poles, data, fit)
        prior, sections = noise.prior, []
        for low in np.arange(data.omega[0], data.omega[-1], NOISE_SECTION):
            local = restrict_fit(poles, [data], [fit], low + NOISE_SECTION / 2, NOISE_SECTION / 2 + NOISE_MARGIN)
            if not local.blocks:
                continue
            updated = update_components(noise, local.blocks[0], local.poles, prior, updates)
            own = (noise.poles.imag >= low) & (noise.poles.imag < low + NOISE_SECTION)
            nodes = (noise.nodes > low - 1e-9) & (noise.nodes < low + NOISE_SECTION)
            noise = replace(
                noise,
                power=np.where(own, updated.power, noise.power),
                freedom=np.where(own, updated.freedom, noise.freedom),
                floor=np.where(nodes[:, None], updated.floor, noise.floor),
            )
            sections.append((local.blocks[0], local.poles))
        scaled = [replace(noise, power=scale * noise.power) for scale in COMMON_SCALES]
        estimates.append(min(scaled, key=lambda trial: sum(deviance(trial, *section) for section in sections)))
    return estimates


def _start_noise(data: DataBlock, fit: ProjectionFit) -> ProcessNoise:
    """Floor from the median of the residual around each node, without driven modes."""
    count = max(2, round((data.omega[-1] - data.omega[0]) / (2 * np.pi * FLOOR_WIDTH)) + 1)
    nodes = np.linspace(data.omega[0], data.omega[-1], count)
    squares = np.abs(fit.residual) ** 2
    medians = [np.median(squares[np.abs(data.omega - node) < 2 * np.pi * FLOOR_WIDTH], axis=0) for node in nodes]
    floor = np.sqrt(np.maximum(medians, np.finfo(float).tiny) / (2 * np.log(2)))
    none, empty = np.zeros(0), np.zeros(0, dtype=np.complex128)
    return ProcessNoise(empty, np.zeros((0, floor.shape[1]), dtype=np.complex128), none, none, nodes, floor)


def _follow_poles(noise: ProcessNoise, poles: ComplexArray, data: DataBlock, fit: ProjectionFit) -> ProcessNoise:
    """Noise with the poles of the decays as driven modes, and with earlier driven modes that no decay explains."""
    line = 2 * np.pi / data.duration
    unit = fit.residues / noise.floor_at(poles.imag)
    shapes = fit.residues / np.maximum(np.linalg.norm(unit, axis=1, keepdims=True), np.finfo(float).tiny)
    power, freedom = np.full(poles.size, 10.0), np.ones(poles.size)
    if not noise.poles.size or not poles.size:
        return replace(noise, poles=poles, shapes=shapes, power=power, freedom=freedom)
    distance = np.abs(noise.poles[:, None] - poles)
    nearest, known = distance.argmin(axis=0), distance.min(axis=0) < 0.5 * np.abs(poles.real) + 0.5 * line
    power = np.where(known, np.maximum(noise.power[nearest], 0.01), 3.0)
    freedom = np.where(known, noise.freedom[nearest], 1.0)
    decay = -noise.poles.real / np.median(-poles.real)
    alone = (distance.min(axis=1) > line) & (noise.power > 1) & (decay > 0.2) & (decay < 5)
    return replace(
        noise,
        poles=np.concatenate([poles, noise.poles[alone]]),
        shapes=np.concatenate([shapes, noise.shapes[alone]]),
        power=np.concatenate([power, noise.power[alone]]),
        freedom=np.concatenate([freedom, noise.freedom[alone]]),
    )

"""Modes of a line from its fit: frequency, damping ratio, shape, and their uncertainty."""

import numpy as np

from pantocheck.conformance.array_types import ComplexArray, RealArray
from pantocheck.conformance.identification.decay_filters import filter_gain
from pantocheck.conformance.identification.line_fit import FittedBlock, LineFit, RecordFit
from pantocheck.conformance.identification.mode import Mode, SensorShape
from pantocheck.conformance.identification.mode_groups import find_group_outliers, number_groups
from pantocheck.conformance.identification.mode_quality import (
    is_certain,
    is_lateral,
    list_mode_warnings,
    phase_collinearity,
)
from pantocheck.conformance.identification.projection import build_block, estimate_noise, residue_spread, solve_residues

FREQUENCY_REACH = 3
"""Spectral lines on each side that show the residual of a mode."""


def build_modes(fit: LineFit, spans: int | None) -> tuple[Mode, ...]:
    """Modes in the reported band, by frequency, numbered in groups of span modes.

    Parameters
    ----------
    fit : LineFit
        Fit of the line.
    spans : int or None
        Number of spans; None if unknown.
    """
    shares = [share for record in fit.records if (share := _lateral_shares(fit, record)) is not None]
    frequency = np.abs(fit.poles) / (2 * np.pi)
    reported = np.flatnonzero((frequency >= fit.band.low) & (frequency <= fit.band.high))
    modes = [_build_mode(fit, int(j), max((float(share[j]) for share in shares), default=None)) for j in reported]
    return _assign_groups(modes, spans)


def _build_mode(fit: LineFit, j: int, lateral_share: float | None) -> Mode:
    pole, m = fit.poles[j], fit.poles.size
    variance = np.diag(fit.covariance)
    inflation = _inflation(fit.blocks, pole)
    decay_std, omega_std = np.sqrt(variance[j]) * inflation, np.sqrt(variance[m + j]) * inflation
    frequency, damping = float(np.abs(pole)) / (2 * np.pi), float(-pole.real / np.abs(pole))
    damping_std = float(decay_std / np.abs(pole))
    frequencies = np.abs(fit.poles) / (2 * np.pi)
    nearest = float(np.min(np.abs(np.delete(frequencies, j) - frequencies[j]), initial=np.inf))
    best = max(fit.records, key=lambda record: float(np.sum(np.abs(record.residues[j] / record.noise) ** 2)))
    decay, linear = best.decay, best.decay.linear
    residues, spread = _shared_shape([r for r in fit.records if r.decay.test == decay.test], best, j)
    scale = residues[np.argmax(np.abs(residues))]
    gain = filter_gain(linear.taps, np.array([pole]), linear.rate)[0]
    amplitude = 2 * np.abs(scale / gain * np.exp(-pole * (linear.first - decay.release.time)))
    return Mode(
        frequency_Hz=frequency,
        frequency_std_Hz=_finite(omega_std / (2 * np.pi)),
        damping_ratio=damping,
        damping_ratio_std=_finite(damping_std),
        sensor_shape=_sensor_shape(best, residues, spread, scale),
        error=_band_error(fit.blocks, pole),
        record=decay.record.name,
        warnings=list_mode_warnings(frequency, damping, damping_std, linear.duration, nearest, lateral_share),
        certain=is_certain(damping, damping_std),
        lateral=is_lateral(lateral_share),
        amplitude_at_release=_finite(amplitude),
        phase_collinearity=phase_collinearity(residues),
        lateral_over_vertical=lateral_share,
        half_power_points=2 * damping * frequency * linear.duration,
    )


def _inflation(blocks: tuple[FittedBlock, ...], pole: complex) -> float:
    """Factor on standard deviations where the residual around a mode exceeds the noise."""
    energy, count = 0.0, 0
    for block in blocks:
        reach = max(FREQUENCY_REACH * 2 * np.pi / block.data.duration, -2 * pole.real)
        near = np.abs(block.data.omega - pole.imag) < reach
        energy += float(np.sum(np.abs(block.fit.residual[near] / block.noise) ** 2))
        count += 2 * int(near.sum()) * block.noise.size
    return float(np.sqrt(max(1.0, energy / count))) if count else 1.0


def _shared_shape(repeats: list[RecordFit], best: RecordFit, j: int) -> tuple[ComplexArray, RealArray]:
    """Residues common to the repeats of a drop, scaled to the best one, and the standard deviation of their parts.

    Residues belong to the first sample of a linear decay, which differs between repeats: hence the scale.
    """
    table = np.array([record.residues[j] for record in repeats]).T
    left, values, right = np.linalg.svd(table, full_matrices=False)
    scale = right[0, next(i for i, record in enumerate(repeats) if record is best)]
    noise = [record.noise * record.block.residue_std[j] for record in repeats]
    return left[:, 0] * values[0] * scale, np.asarray(np.mean(noise, axis=0) * np.abs(scale))


def _sensor_shape(
    record: RecordFit, residues: ComplexArray, spread: RealArray, scale: complex
) -> tuple[SensorShape, ...]:
    shape, std = (residues / scale, spread / np.abs(scale)) if np.abs(scale) > 0 else (residues, spread)
    return tuple(
        SensorShape(
            sensor=channel.sensor,
            wire=channel.wire,
            position_m=channel.position,
            re=float(value.real),
            im=float(value.imag),
            std=_finite(deviation),
        )
        for channel, value, deviation in zip(record.decay.channels, shape, std, strict=True)
    )


def _band_error(blocks: tuple[FittedBlock, ...], pole: complex) -> float:
    """Residual over measured signal in the half-power band of a mode."""
    residual = measured = 0.0
    for block in blocks:
        near = np.abs(block.data.omega - pole.imag) <= max(-pole.real, 2 * np.pi / block.data.duration)
        residual += float(np.sum(np.abs(block.fit.residual[near] / block.noise) ** 2))
        measured += float(np.sum(np.abs(block.data.spectrum[near] / block.noise) ** 2))
    return float(np.sqrt(residual / measured)) if measured > 0 else 1.0


def _lateral_shares(fit: LineFit, record: RecordFit) -> RealArray | None:
    """Largest lateral over largest vertical amplitude of every pole, (m,); 0 where the lateral one is noise."""
    decay = record.decay
    if decay.lateral.shape[1] == 0:
        return None
    data = build_block(decay.lateral, decay.linear.dt, fit.band.low, fit.band.fitted)
    lateral = solve_residues(fit.poles, data)
    noise = estimate_noise(lateral, fit.poles.size, data) * residue_spread(fit.poles, data)[:, None]
    sideways = np.where(np.abs(lateral.residues) > 4 * noise, np.abs(lateral.residues), 0).max(axis=1)
    upward = np.abs(record.residues).max(axis=1)
    return np.asarray(sideways / np.maximum(upward, np.finfo(float).tiny))


def _assign_groups(modes: list[Mode], spans: int | None) -> tuple[Mode, ...]:
    """Number the groups of the vertical modes and mark the outliers of each group."""
    vertical = [i for i, mode in enumerate(modes) if not mode.lateral]
    frequency = np.array([mode.frequency_Hz for mode in modes])
    certain = np.array([modes[i].frequency_Hz for i in vertical if modes[i].certain])
    numbers = number_groups(certain, frequency[vertical], spans)
    groups = {i: int(number) or None for i, number in zip(vertical, numbers, strict=True)}
    outliers = set[int]()
    for number in {number for number in groups.values() if number is not None}:
        members = [i for i in vertical if groups[i] == number and modes[i].certain]
        flags = find_group_outliers(np.array([modes[i].damping_ratio for i in members]))
        outliers |= {i for i, flag in zip(members, flags, strict=True) if flag}
    return tuple(
        mode.model_copy(update={"group": groups.get(i), "outlier": i in outliers}) for i, mode in enumerate(modes)
    )


def _finite(value: float) -> float:
    """The value, or 0 (which no measured value is) where the data do not determine it."""
    return float(value) if np.isfinite(value) else 0.0

"""Fit of one line: common poles of all its records, residues of each record, and its modes with their uncertainty."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.drops.decay_kernel import FrequencyBand, filter_gain
from pantocheck.conformance.drops.decay_preparation import PreparedDecay
from pantocheck.conformance.drops.mode_groups import assign_groups
from pantocheck.conformance.drops.pole_refinement import refine_poles
from pantocheck.conformance.drops.process_noise import PRIOR_FREEDOM, ProcessNoise
from pantocheck.conformance.drops.projection import (
    DataBlock,
    Noise,
    ProjectionFit,
    build_block,
    estimate_noise,
    residue_deviation,
    solve_residues,
    solve_weighted_residues,
    whiten,
)
from pantocheck.conformance.results.identified_modes import Mode, SensorShape

SAME_LENGTH = 0.02
"""Largest relative difference in length of repeats that are cut to the shortest one and put into one block [-]."""

LAST_STEPS = 10
"""Largest number of steps of the last refinement of the poles."""


@dataclass(frozen=True)
class FittedBlock:
    """Spectra of a block and their fit."""

    data: DataBlock
    fit: ProjectionFit
    noise: RealArray
    """Standard deviation of the real or imaginary part of a line from the sensors, (c,) [unit of the spectrum]."""
    residue_std: RealArray
    """Standard deviation of the real or imaginary part of a residue, (m, c) [unit of the spectrum]."""
    process: ProcessNoise | None = None
    """Ambient motion of the modes; None: the record shows none."""

    @property
    def white_residual(self) -> ComplexArray:
        """Residual in units of the noise, (k, c)."""
        return self.fit.residual / self.noise if self.process is None else self.data.weigh(self.fit.residual)


@dataclass(frozen=True)
class RecordFit:
    """Part of a fit for one record: its block, and its channels in the block."""

    decay: PreparedDecay
    block: FittedBlock
    columns: slice

    @property
    def residues(self) -> ComplexArray:
        """Residues at the first sample of the linear decay, (m, c) [unit of the record]."""
        return self.block.fit.residues[:, self.columns]

    @property
    def noise(self) -> RealArray:
        """Standard deviation of the real or imaginary part of a spectral line, (c,) [unit of the spectrum]."""
        return self.block.noise[self.columns]

    @property
    def residue_std(self) -> RealArray:
        """Standard deviation of the real or imaginary part of a residue, (m, c) [unit of the spectrum]."""
        return self.block.residue_std[:, self.columns]


@dataclass(frozen=True)
class LineFit:
    """Fit of all records of one line."""

    band: FrequencyBand
    """Band of the identification."""
    poles: ComplexArray
    """Poles, including those outside the band of the reported modes, (m,) [1/s]."""
    covariance: RealArray
    """Covariance of the decay rates [1/s] and angular frequencies [rad/s] of the poles, (2 m, 2 m)."""
    blocks: tuple[FittedBlock, ...]
    """Data of the fit."""
    records: tuple[RecordFit, ...]
    """Parts of the fit for the records, in the order of the input."""
    misfit: float
    """Squared residual over its expectation for noise [-]; 1 for a complete model."""


def group_into_blocks(decays: list[PreparedDecay]) -> tuple[list[tuple[RealArray, float]], list[tuple[int, slice]]]:
    """Put records of about equal length into one block, cut to the shortest.

    Returns:
        Samples and sampling interval [s] of each block, each (n, c).
        Block of each record, and its channels in the block.
    """
    blocks: list[tuple[RealArray, float]] = []
    places = []
    for decay in decays:
        samples, dt = decay.linear.samples, decay.linear.dt
        for b, (others, other_dt) in enumerate(blocks):
            shorter = min(samples.shape[0], others.shape[0])
            if dt == other_dt and shorter > (1 - SAME_LENGTH) * max(samples.shape[0], others.shape[0]):
                places.append((b, slice(others.shape[1], others.shape[1] + samples.shape[1])))
                blocks[b] = (np.hstack([others[:shorter], samples[:shorter]]), dt)
                break
        else:
            places.append((len(blocks), slice(0, samples.shape[1])))
            blocks.append((samples, dt))
    return blocks, places


def fit_line(
    decays: list[PreparedDecay],
    places: list[tuple[int, slice]],
    data: list[DataBlock],
    poles: ComplexArray,
    noise: Sequence[Noise],
    band: FrequencyBand,
    last_steps: int = LAST_STEPS,
) -> LineFit:
    """Refine the poles once more and solve for the residues of every record.

    Args:
        decays: The records.
        places: Block of each record, and its channels in the block.
        data: The blocks.
        poles: Selected poles, (m,) [1/s].
        noise: Noise of each block.
        band: Band of the identification.
        last_steps: Largest number of steps of the last refinement; 0: the poles stay as they are.
    """
    white = whiten(data, noise)
    refined = refine_poles(poles, white, iterations=last_steps)
    poles = refined.poles
    blocks = tuple(_fit_block(poles, block, sigma) for block, sigma in zip(data, noise, strict=True))
    records = tuple(RecordFit(decay, blocks[b], columns) for decay, (b, columns) in zip(decays, places, strict=True))
    unknowns = sum((2 * poles.size + block.residual_terms.shape[1]) * block.spectrum.shape[1] for block in white)
    rows = sum(2 * block.spectrum.size for block in white)
    misfit = float(refined.cost / max(rows - unknowns - 2 * poles.size, 1))
    return LineFit(band, poles, refined.covariance, blocks, records, misfit)


def _fit_block(poles: ComplexArray, data: DataBlock, noise: Noise) -> FittedBlock:
    if not isinstance(noise, ProcessNoise):
        assert isinstance(noise, np.ndarray)
        deviation = np.outer(residue_deviation(poles, data), noise)
        return FittedBlock(data, solve_residues(poles, data), noise, deviation)
    white = noise.whiten(data)
    floor = np.sqrt(np.mean(noise.floor_at(data.omega) ** 2, axis=0))
    fit, deviation = solve_weighted_residues(poles, white)
    return FittedBlock(white, fit, floor, deviation, noise)


def measure_ambient_motion(fit: LineFit, low: float, high: float) -> tuple[float, float] | None:
    """RMS of ambient motion and of sensor noise in a band [Hz], over all channels; None without process noise."""
    levels = [block.process.levels(block.data, low, high) for block in fit.blocks if block.process is not None]
    if not levels:
        return None
    ambient, floor = (np.concatenate(parts) for parts in zip(*levels, strict=True))
    return float(np.sqrt(np.mean(ambient**2))), float(np.sqrt(np.mean(floor**2)))


# Modes of a line from its fit: frequency, damping ratio, shape, and their uncertainty.
UNCERTAIN = 0.05
"""Relative standard deviation above which a damping ratio is uncertain."""

LATERAL = 20.0
"""Lateral over vertical amplitude, above which an oblique mounting of some degrees explains the vertical signal [-]."""

COINCIDENT = 2.0
"""Smallest distance of two modes that are separate in the spectrum, in half-power bandwidths [-]."""

FREQUENCY_REACH = 3
"""Number of spectral lines on each side of a mode, over which its residual is evaluated."""


def build_modes(fit: LineFit, spans: int | None) -> tuple[Mode, ...]:
    """Build the modes of the reported band, in the order of frequency; `spans` is their number, None if unknown."""
    shares = [share for record in fit.records if (share := _lateral_shares(fit, record)) is not None]
    frequency = np.abs(fit.poles) / (2 * np.pi)
    reported = np.flatnonzero((frequency >= fit.band.low) & (frequency <= fit.band.high))
    modes = [_build_mode(fit, int(j), max((float(share[j]) for share in shares), default=None)) for j in reported]
    return assign_groups(modes, spans)


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
    mode = Mode(
        frequency_Hz=frequency,
        frequency_std_Hz=_finite(omega_std / (2 * np.pi)),
        damping_ratio=damping,
        damping_ratio_std=_finite(damping_std),
        sensor_shape=_sensor_shape(best, residues, spread, scale, _sensor_errors(best, pole)),
        error=_band_error(fit.blocks, pole),
        record=decay.record.name,
        line=decay.record.line,
        certain=damping_std < UNCERTAIN * damping,
        lateral=lateral_share is not None and lateral_share > LATERAL,
        amplitude_at_release=_finite(amplitude),
        phase_collinearity=phase_collinearity(residues),
        lateral_over_vertical=lateral_share,
        half_power_points=2 * damping * frequency * linear.duration,
    )
    return mode.model_copy(update={"warnings": _list_warnings(mode, linear.duration, nearest)})


def phase_collinearity(shape: ComplexArray) -> float | None:
    """Modal phase collinearity (Juang and Pappa 1985): 1 for a normal mode; None with fewer than two sensors."""
    if shape.size < 2:
        return None
    # Moments about the origin, not about the mean: a shape with equal components is a normal mode.
    xx, yy, xy = (float(np.sum(a * b)) for a, b in ((shape.real,) * 2, (shape.imag,) * 2, (shape.real, shape.imag)))
    total = (xx + yy) ** 2
    return ((xx - yy) ** 2 + 4 * xy**2) / total if total > 0 else None


def _list_warnings(mode: Mode, duration: float, nearest: float) -> tuple[str, ...]:
    """Caveats on a mode in a decay of a duration [s]; `nearest` is the distance of the nearest other mode [Hz]."""
    warnings = []
    bandwidth = 2 * mode.damping_ratio * mode.frequency_Hz
    if not mode.certain:
        relative = 100 * (mode.damping_ratio_std / mode.damping_ratio)
        warnings.append(f"weakly excited: the standard deviation of the damping ratio is {relative:.0f} %")
    if nearest < COINCIDENT * bandwidth or nearest * duration < 1.5:
        warnings.append(f"near-coincident: the distance to another mode is only {1000 * nearest:.1f} mHz")
    if mode.lateral:
        warnings.append(
            "lateral: the sensors move laterally; the signal of the vertical channels is due to oblique mounting"
        )
    return tuple(warnings)


def find_ambient_share(power: float) -> float:
    """Share of ambient motion in the variance of a pole; `power` is that at resonance over the floor [-].

    It is the derivative of the logarithm of the variance by that of the power g. With x, the distance from resonance
    in half-bandwidths, the data weigh as 1 / (1 + x^2) / (1 + g + x^2), and the share at a line is g / (1 + g + x^2).
    """
    a = np.sqrt(1 + power)
    return float((a - 1) * (2 * a + 1) / (2 * a**2))


def _inflation(blocks: tuple[FittedBlock, ...], pole: complex) -> float:
    """Factor by which standard deviations are increased if the residual near a mode exceeds the noise.

    Process noise is estimated from this residual: the interval is that of Student's distribution instead. The floor is
    known from many lines, so that the degrees of freedom grow with its share in the variance (Satterthwaite 1946).
    """
    driven = [block.process for block in blocks if block.process is not None]
    if driven:
        nearest = [int(np.argmin(np.abs(noise.poles - pole))) for noise in driven]
        freedom = sum(PRIOR_FREEDOM + noise.freedom[k] for noise, k in zip(driven, nearest, strict=True))
        power = np.mean([noise.power[k] for noise, k in zip(driven, nearest, strict=True)])
        freedom /= find_ambient_share(max(float(power), 1e-3)) ** 2
        return float(scipy.special.stdtrit(freedom, 0.025) / scipy.special.ndtri(0.025))
    energy, count = 0.0, 0
    for block in blocks:
        reach = max(FREQUENCY_REACH * 2 * np.pi / block.data.duration, -2 * pole.real)
        near = np.abs(block.data.omega - pole.imag) < reach
        energy += float(np.sum(np.abs(block.white_residual[near]) ** 2))
        count += 2 * int(near.sum()) * block.noise.size
    return float(np.sqrt(max(1.0, energy / count))) if count else 1.0


def _shared_shape(repeats: list[RecordFit], best: RecordFit, j: int) -> tuple[ComplexArray, RealArray]:
    """Common residues of the repeats of a drop, in the scale of the best record, and their standard deviation.

    Residues are those at the first sample of a linear decay. Its time differs between repeats, and so does their scale.
    """
    table = np.array([record.residues[j] for record in repeats]).T
    left, values, right = np.linalg.svd(table, full_matrices=False)
    scale = right[0, next(i for i, record in enumerate(repeats) if record is best)]
    noise = [record.residue_std[j] for record in repeats]
    return left[:, 0] * values[0] * scale, np.asarray(np.mean(noise, axis=0) * np.abs(scale))


def _sensor_shape(
    record: RecordFit, residues: ComplexArray, spread: RealArray, scale: complex, errors: RealArray
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
            error=_finite(error),
        )
        for channel, value, deviation, error in zip(record.decay.channels, shape, std, errors, strict=True)
    )


def _sensor_errors(record: RecordFit, pole: complex) -> RealArray:
    """Residual over measured signal in the half-power band of a mode at each sensor of a record, (c,) [-]."""
    block = record.block
    near = _select_band(block, pole)
    residual, measured = (
        np.linalg.norm(spectrum[near][:, record.columns], axis=0)
        for spectrum in (block.fit.residual, block.data.spectrum)
    )
    return np.asarray(residual / np.maximum(measured, np.finfo(float).tiny))


def _select_band(block: FittedBlock, pole: complex) -> NDArray[np.bool_]:
    """Mask of the spectral lines in the half-power band of a pole, one line at least on each side."""
    return np.asarray(np.abs(block.data.omega - pole.imag) <= max(-pole.real, 2 * np.pi / block.data.duration))


def _band_error(blocks: tuple[FittedBlock, ...], pole: complex) -> float:
    """Residual over measured signal in the half-power band of a mode."""
    residual = measured = 0.0
    for block in blocks:
        near = _select_band(block, pole)
        residual += float(np.sum(np.abs(block.fit.residual[near] / block.noise) ** 2))
        measured += float(np.sum(np.abs(block.data.spectrum[near] / block.noise) ** 2))
    return float(np.sqrt(residual / measured)) if measured > 0 else 1.0


def _lateral_shares(fit: LineFit, record: RecordFit) -> RealArray | None:
    """Largest lateral over largest vertical amplitude of each pole, (m,); 0 if the lateral amplitude is noise."""
    decay = record.decay
    if decay.lateral.shape[1] == 0:
        return None
    data = build_block(decay.lateral, decay.linear.dt, fit.band.low, fit.band.fitted)
    lateral = solve_residues(fit.poles, data)
    noise = estimate_noise(lateral, fit.poles.size, data) * residue_deviation(fit.poles, data)[:, None]
    sideways = np.where(np.abs(lateral.residues) > 4 * noise, np.abs(lateral.residues), 0).max(axis=1)
    upward = np.abs(record.residues).max(axis=1)
    return np.asarray(sideways / np.maximum(upward, np.finfo(float).tiny))


def _finite(value: float) -> float:
    """The value, or 0 if the data do not determine it; a measured value is never 0."""
    return float(value) if np.isfinite(value) else 0.0

"""Modes and frequency responses from a record with a measured force, of a hammer or of a shaker.

The transform of a finite record of a driven line is exactly

    Y(w) = sum over the poles of (B F(w) + T) / (i w - lambda) + conj. part + smooth terms of F and of 1

at the spectral lines, where F is the transform of the force. T holds the motion at the start and at the end of the
record: with it, neither a window nor rest at both ends is needed. Residues and smooth terms are eliminated.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.decay_kernel import (
    FrequencyBand,
    far_pole_columns,
    join_conjugates,
    real_columns,
    stack_real_imaginary,
)
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.elimination import factor_columns, solve_factor
from pantocheck.conformance.drops.line_fit import UNCERTAIN, phase_collinearity
from pantocheck.conformance.drops.mode_groups import assign_groups
from pantocheck.conformance.drops.model_order import FALSE_ALARM
from pantocheck.conformance.drops.pole_refinement import NormalEquations, minimise_cost
from pantocheck.conformance.drops.start_poles import find_start_poles
from pantocheck.conformance.results.identified_modes import Mode, SensorShape
from pantocheck.model.description.one_thread import use_one_thread

RESPONSE_SHARE = 1 / 3
"""Length of the impulse response that gives the start poles, over that of the record [-]."""
SMOOTH_DEGREE = 3
"""Degree of the polynomials in frequency for modes outside the band."""
SEGMENTS = 8
"""Number of segments without overlap in the average of the coherence."""
REFINING_STEPS = 40
"""Largest number of steps of the refinement."""


@dataclass(frozen=True)
class ForcedBlock:
    """Spectra of a driven record in a band."""

    omega: RealArray
    """Angular frequencies of the lines, (k,) [rad/s]."""
    motion: ComplexArray
    """Transforms of the channels, (k, c)."""
    force: ComplexArray
    """Transform of the force over its RMS, (k,)."""


@dataclass(frozen=True)
class FrequencyResponses:
    """Measured frequency responses of the channels of a record, by averages over segments (H1)."""

    frequency: RealArray
    """(n,) [Hz]."""
    response: ComplexArray
    """Motion over force, (n, c) [unit of the record per N]."""
    coherence: RealArray
    """Coherence of motion and force, (n, c) [-]."""

    def tabulate(self, names: list[str]) -> tuple[list[str], RealArray]:
        """Names of the columns, and rows with magnitude, phase [rad] and coherence of each channel."""
        parts = {"abs": np.abs(self.response), "phase_rad": np.angle(self.response), "coherence": self.coherence}
        heads = ["frequency_Hz", *(f"{name} {part}" for part in parts for name in names)]
        return heads, np.column_stack([self.frequency, *parts.values()])

    def coherence_at(self, frequencies: list[float]) -> RealArray:
        """Highest coherence of a channel at frequencies [Hz], (m,) [-]."""
        channels = [np.interp(frequencies, self.frequency, channel) for channel in self.coherence.T]
        return np.asarray(np.max(channels, axis=0))


@dataclass(frozen=True)
class ForcedIdentification:
    """Modes of a driven line."""

    modes: tuple[Mode, ...]
    responses: FrequencyResponses
    misfit: float
    """Squared residual over its expectation for noise [-]."""


@use_one_thread
def identify_forced(record: DropRecord, highest: float = 10.0) -> ForcedIdentification:
    """Identify the modes of a line from one record with a measured force, up to a frequency [Hz].

    Raises:
        InputError: The record has no force or no vertical channel, or no pole is found.
    """
    vertical = list(record.along("z"))
    if record.force is None or not vertical:
        raise InputError(record.name, "has no force channel, or no vertical channel", "Give one channel in N or kN.")
    band, signals = FrequencyBand.up_to(highest, record.rate), record.signals[:, vertical]
    block = _transform(signals, record.force, record.rate, (band.low, band.fitted))
    poles = find_start_poles([_impulse_response(record.force, signals)], record.rate, band.low, band.fitted)
    noise = np.ones(block.motion.shape[1])
    for _ in range(3):
        poles = _remove_weak(poles, block, noise)
        if not poles.size:
            raise InputError(record.name, "no pole explains the motion", "Excite the line longer, or more strongly.")
        poles = _refine(poles, block, noise)
        noise = _estimate_noise(poles, block)
    fit = _linearise(poles, block, noise)
    rows = 2 * block.motion.size
    misfit = float(fit.cost / max(rows - fit.unknowns * block.motion.shape[1] - 2 * poles.size, 1))
    covariance = scipy.linalg.pinvh(fit.jacobian.T @ fit.jacobian) * max(misfit, 1.0)
    modes = [_build_mode(record, vertical, fit, covariance, j) for j in range(poles.size)]
    inside = [mode for mode in modes if band.low <= mode.frequency_Hz <= band.high]
    groups = assign_groups(inside, len(record.line.spans_m) or None)
    return ForcedIdentification(groups, compute_responses(record), misfit)


def compute_responses(record: DropRecord) -> FrequencyResponses:
    """Frequency responses of the vertical channels with their coherence."""
    assert record.force is not None
    signals = record.signals[:, list(record.along("z"))]
    options = {"fs": record.rate, "nperseg": record.signals.shape[0] // SEGMENTS}
    frequency, force = scipy.signal.welch(record.force, **options)
    cross = np.array([scipy.signal.csd(record.force, channel, **options)[1] for channel in signals.T]).T
    power = np.array([scipy.signal.welch(channel, **options)[1] for channel in signals.T]).T
    tiny = np.finfo(float).tiny
    coherence = np.abs(cross) ** 2 / np.maximum(power * force[:, None], tiny)
    return FrequencyResponses(frequency, np.asarray(cross / np.maximum(force[:, None], tiny)), coherence)


def _transform(signals: RealArray, force: RealArray, rate: float, edges: tuple[float, float]) -> ForcedBlock:
    n = force.size
    lines = np.arange(max(1, int(np.ceil(edges[0] * n / rate))), int(edges[1] * n / rate) + 1)
    spectrum = np.fft.rfft(force - force.mean())[lines]
    motion = np.fft.rfft(signals - signals.mean(axis=0), axis=0)[lines]
    return ForcedBlock(2 * np.pi * lines * rate / n, motion, spectrum / np.sqrt(np.mean(np.abs(spectrum) ** 2)))


def _impulse_response(force: RealArray, signals: RealArray) -> RealArray:
    """Response to a unit impulse, (n, c), each channel with unit variance: it decays with the poles of the line."""
    size = 2 * force.size
    drive, motion = np.fft.rfft(force - force.mean(), size), np.fft.rfft(signals - signals.mean(axis=0), size, axis=0)
    # Correlation with the force: a division by its spectrum would amplify the lines that it does not excite.
    response = np.fft.irfft(motion * drive.conj()[:, None], size, axis=0)[: int(RESPONSE_SHARE * force.size)]
    return np.asarray(response / response.std(axis=0))


@dataclass(frozen=True)
class _Linearised:
    """Fit with given poles: residues of the force, (m, c), residual, (2 k, c), and Jacobian of the poles."""

    poles: ComplexArray
    residues: ComplexArray
    residual: RealArray
    jacobian: RealArray
    """Derivatives by decay rates, then angular frequencies, in units of the noise, (2 k c, 2 m)."""
    unknowns: int
    """Number of linear unknowns of a channel."""

    @property
    def cost(self) -> float:
        """Squared residual in units of the noise."""
        return float(np.sum(self.residual**2))


def _build_columns(poles: ComplexArray, block: ForcedBlock) -> tuple[RealArray, RealArray]:
    """Columns of free and driven residues and of the smooth terms, (2 k, 4 m + s), and derivatives, (2 k, 4 m)."""
    kernel = 1 / (1j * block.omega[:, None] - join_conjugates(poles))
    drive = block.force[:, None]
    smooth = far_pole_columns(block.omega, SMOOTH_DEGREE)
    k = block.omega.size
    driven = (smooth[:k] + 1j * smooth[k:]) * drive
    columns = [real_columns(kernel), real_columns(kernel * drive), smooth, stack_real_imaginary(driven)]
    slopes = [real_columns(kernel**2), real_columns(kernel**2 * drive)]
    return np.hstack(columns), np.hstack(slopes)


def _linearise(poles: ComplexArray, block: ForcedBlock, noise: RealArray) -> _Linearised:
    """Solve for the residues of given poles, and differentiate the residual by the poles (Kaufman)."""
    columns, slopes = _build_columns(poles, block)
    m, x = poles.size, stack_real_imaginary(block.motion) / noise
    if columns.shape[0] <= columns.shape[1]:
        raise InputError("record", f"is too short for {m} poles", "Record longer, or lower the highest frequency.")
    q, r = factor_columns(columns)
    coefficients = solve_factor(r, q.T @ x)
    slopes = slopes - q @ (q.T @ slopes)
    free_re, free_im, re, im = (coefficients[i * m : (i + 1) * m] for i in range(4))
    d = [slopes[:, i * m : (i + 1) * m] for i in range(4)]
    decay = sum(a[:, None, :] * b.T[None] for a, b in zip(d, (free_re, free_im, re, im), strict=True))
    omega = sum(a[:, None, :] * b.T[None] for a, b in zip(d, (-free_im, free_re, -im, re), strict=True))
    jacobian = np.concatenate([decay, -np.asarray(omega)], axis=2).reshape(-1, 2 * m)
    residues = np.asarray((re + 1j * im) * noise, dtype=np.complex128)
    return _Linearised(poles, residues, x - q @ (q.T @ x), jacobian, columns.shape[1])


def _refine(poles: ComplexArray, block: ForcedBlock, noise: RealArray) -> ComplexArray:
    """Minimise the residual over the poles."""

    def build(trial: ComplexArray) -> NormalEquations:
        fit = _linearise(trial, block, noise)
        matrix, gradient = fit.jacobian.T @ fit.jacobian, -(fit.jacobian.T @ fit.residual.ravel())
        return NormalEquations(fit.cost, lambda: (matrix, gradient))

    return minimise_cost(poles, build, REFINING_STEPS, tolerance=1e-3).poles


def _remove_weak(poles: ComplexArray, block: ForcedBlock, noise: RealArray) -> ComplexArray:
    """Poles whose force residues reduce the residual by more than noise does."""
    k, channels = block.motion.shape
    least = float(scipy.special.chdtri(2 + 2 * channels, FALSE_ALARM / (4 * k)))
    while poles.size:
        columns, _ = _build_columns(poles, block)
        q, r = factor_columns(columns)
        inverse = solve_factor(r, np.eye(r.shape[0]))
        coefficients = inverse @ (q.T @ (stack_real_imaginary(block.motion) / noise))
        scale = np.sum((stack_real_imaginary(block.motion) / noise - columns @ coefficients) ** 2) / (2 * k * channels)
        gains = []
        for j in range(poles.size):
            pair = [2 * poles.size + j, 3 * poles.size + j]
            covariance = inverse[pair] @ inverse[pair].T
            gains.append(float(np.sum(coefficients[pair] * np.linalg.solve(covariance, coefficients[pair]))))
        weakest = int(np.argmin(gains))
        if gains[weakest] > least * scale:
            break
        poles = np.delete(poles, weakest)
    return poles


def _estimate_noise(poles: ComplexArray, block: ForcedBlock) -> RealArray:
    """Standard deviation of the real or imaginary part of a line, (c,), from the residual with the poles."""
    fit = _linearise(poles, block, np.ones(block.motion.shape[1]))
    left = max(2 * block.omega.size - fit.unknowns, 1)
    return np.asarray(np.sqrt(np.sum(fit.residual**2, axis=0) / left))


def _build_mode(record: DropRecord, vertical: list[int], fit: _Linearised, covariance: RealArray, j: int) -> Mode:
    pole, m, residues = fit.poles[j], fit.poles.size, fit.residues[j]
    shape = residues / residues[np.argmax(np.abs(residues))]
    ratio, std = float(-pole.real / abs(pole)), np.sqrt(np.diag(covariance)[[j, m + j]])
    return Mode(
        frequency_Hz=float(abs(pole)) / (2 * np.pi),
        frequency_std_Hz=float(std[1]) / (2 * np.pi),
        damping_ratio=ratio,
        damping_ratio_std=float(std[0] / abs(pole)),
        sensor_shape=tuple(
            SensorShape(sensor=c.sensor, wire=c.wire, position_m=c.position, re=float(v.real), im=float(v.imag))
            for c, v in zip((record.channels[i] for i in vertical), shape, strict=True)
        ),
        record=record.name,
        line=record.line,
        certain=bool(std[0] / abs(pole) < UNCERTAIN * ratio),
        phase_collinearity=phase_collinearity(residues),
        half_power_points=2 * ratio * float(abs(pole)) / (2 * np.pi) * record.duration,
    )

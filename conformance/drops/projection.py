"""Output error of a set of poles, with all linear parameters eliminated (variable projection).

For given poles the residues and the residual terms solve a linear least-squares problem. Its residual is
r = (I - Q Q') x, where Q is an orthonormal basis of the columns Phi of the model. With Kaufman's Jacobian,
-(I - Q Q') dPhi a, the Gauss-Newton matrix at the minimum is the Fisher information of the poles for unknown residues.

References:
    [1] G. H. Golub, V. Pereyra, Separable nonlinear least squares: the variable projection method and its applications,
        Inverse Problems 19 (2003) R1-R26. doi:10.1088/0266-5611/19/2/201
    [2] E. Balmes, Frequency domain identification of structural dynamics using the pole/residue parametrization, IMAC
        XIV (1996) 540-546.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
import scipy.linalg

from pantocheck.conformance.core.array_types import ComplexArray, IntegerArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.channel_columns import ChannelColumns
from pantocheck.conformance.drops.decay_kernel import (
    decay_kernel,
    drift_columns,
    far_pole_columns,
    join_conjugates,
    real_columns,
    stack_real_imaginary,
)
from pantocheck.conformance.drops.elimination import (
    REFINEMENTS,
    StoredColumns,
    prepare_elimination,
    solve_least_squares,
)

DRIFT_DEGREE = 4
"""Degree of the polynomial in time for the drift of the offset."""

FAR_DEGREE = 3
"""Degree of the polynomial in frequency for modes outside the band."""


@dataclass(frozen=True)
class DataBlock:
    """Channels with common sample times: those of one record, or of repeats with equal length."""

    lines: IntegerArray
    """Indices of the spectral lines that are used, (k,)."""
    spectrum: ComplexArray
    """Transforms of the channels at those lines, (k, c)."""
    dt: float
    """Sampling interval [s]."""
    n: int
    """Number of samples."""
    residual_terms: RealArray
    """Columns for the drift of the offset and for modes outside the band, (2 k, r)."""
    whitening: ComplexArray | None = None
    """Inverse of the triangular factor of the covariance of the channels at each line, (k, c, c); None: white noise."""

    @cached_property
    def omega(self) -> RealArray:
        """Angular frequency of the lines [rad/s]."""
        return np.asarray(2 * np.pi * self.lines / (self.n * self.dt))

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return self.n * self.dt

    @cached_property
    def signals(self) -> RealArray:
        """Signals of the least-squares problem in units of the noise: (2 k, c), or (2 k c, 1) with a whitening."""
        if self.whitening is None:
            return stack_real_imaginary(self.spectrum)
        return stack_real_imaginary(self.weigh(self.spectrum)).reshape(-1, 1)

    def weigh(self, values: ComplexArray) -> ComplexArray:
        """Values of the channels in units of the noise, (k, c)."""
        return self.weigh_directions(values[:, :, None])[:, :, 0]

    def weigh_directions(self, values: ComplexArray) -> ComplexArray:
        """Directions of the channels at each line, (k, c, v), in units of the noise."""
        return values if self.whitening is None else np.asarray(self.whitening @ values)

    def arrange(self, columns: RealArray) -> StoredColumns | ChannelColumns:
        """Columns of a channel, (2 k, p), for the signals of all channels."""
        return StoredColumns(columns) if self.whitening is None else ChannelColumns(columns, self.whitening)

    def weigh_slopes(self, derivative: RealArray, residues: RealArray) -> RealArray:
        """Derivatives of the signals by decay rates and angular frequencies, (2 k c, 2 m).

        Args:
            derivative: Derivatives of the columns of the residues, (2 k, 2 m).
            residues: Real, then imaginary parts of the residues, (2 m, c).
        """
        k, m = self.lines.size, residues.shape[0] // 2
        first, second = np.split(derivative[:k, None] + 1j * derivative[k:, None], 2, axis=2)
        p, s = residues[:m].T, residues[m:].T
        slopes = np.concatenate([-(first * p + second * s), second * p - first * s], axis=2)
        return stack_real_imaginary(self.weigh_directions(slopes)).reshape(2 * k * residues.shape[1], 2 * m)


@dataclass(frozen=True)
class ProjectionFit:
    """Least-squares solution of one block for known poles."""

    residues: ComplexArray
    """Residues A at the first sample of the block, (m, c) [unit of the spectrum]."""
    residual: ComplexArray
    """Spectrum minus the fitted poles and residual terms, (k, c)."""


def build_block(samples: RealArray, dt: float, low: float, high: float) -> DataBlock:
    """Transform channels, (n, c), at intervals dt [s] to the lines of a band [Hz], and build the residual terms."""
    n = samples.shape[0]
    lines = np.arange(max(1, int(np.ceil(low * n * dt))), min(n // 2, int(high * n * dt) + 1), dtype=np.int64)
    # The mean is line 0, which is not used; without it rounding errors are smaller.
    spectrum = np.fft.rfft(samples - samples.mean(axis=0), axis=0)[lines]
    omega = 2 * np.pi * lines / (n * dt)
    terms = np.hstack([drift_columns(DRIFT_DEGREE, n, lines), far_pole_columns(omega, FAR_DEGREE)])
    return DataBlock(lines, np.asarray(spectrum), dt, n, terms)


def pole_columns(poles: ComplexArray, data: DataBlock) -> RealArray:
    """Real columns for the residues of the poles at the lines of a block, (2 k, 2 m)."""
    return real_columns(decay_kernel(join_conjugates(poles), data.omega, data.dt, data.n))


def solve_residues(poles: ComplexArray, data: DataBlock) -> ProjectionFit:
    """Solve for the residues of known poles, (m,) [1/s], by least squares.

    Raises:
        InputError: The block has fewer equations than unknowns, so that the residues are not determined.
    """
    columns = np.hstack([pole_columns(poles, data), data.residual_terms])
    if columns.shape[0] < columns.shape[1]:
        raise InputError(
            f"record of {data.n * data.dt:.3g} s",
            f"has {data.lines.size} spectral lines in the band, too few for {poles.size} modes",
            "Record the whole decay, or lower the highest frequency.",
        )
    coefficients, residual = solve_least_squares(columns, stack_real_imaginary(data.spectrum))
    m, k = poles.size, data.lines.size
    return ProjectionFit(coefficients[:m] + 1j * coefficients[m : 2 * m], residual[:k] + 1j * residual[k:])


def solve_weighted_residues(poles: ComplexArray, data: DataBlock) -> tuple[ProjectionFit, RealArray]:
    """Residues of known poles [1/s] in a block with a whitening, and the standard deviation of their parts, (m, c)."""
    (k, c), m = data.spectrum.shape, poles.size
    columns = np.hstack([pole_columns(poles, data), data.residual_terms])
    elimination = prepare_elimination(data.arrange(columns))
    coefficients = elimination.solve(data.signals, 1 + REFINEMENTS)[0].reshape(-1, c)
    fitted = columns @ coefficients
    variance = elimination.inverse.diagonal().reshape(-1, c)
    deviation = np.sqrt((variance[:m] + variance[m : 2 * m]) / 2)
    residual = data.spectrum - fitted[:k] - 1j * fitted[k:]
    return ProjectionFit(coefficients[:m] + 1j * coefficients[m : 2 * m], residual), np.asarray(deviation)


def residue_deviation(poles: ComplexArray, data: DataBlock) -> RealArray:
    """Standard deviation of the real or imaginary part of a residue for unit noise and known poles, (m,)."""
    r = scipy.linalg.qr(np.hstack([pole_columns(poles, data), data.residual_terms]), mode="r", check_finite=False)[0]
    inverse = np.linalg.pinv(r[: r.shape[1]])
    variance = np.sum(inverse**2, axis=1)
    m = poles.size
    return np.asarray(np.sqrt((variance[:m] + variance[m : 2 * m]) / 2))


def estimate_noise(fit: ProjectionFit, poles: int, data: DataBlock) -> RealArray:
    """Estimate the standard deviation of the real or imaginary part of a spectral line, per channel, (c,).

    It follows from the median of the residual over the lines, which does not depend on a few peaks outside the model:
    |r|^2 / (2 sigma^2) of white noise has the median ln 2. A factor corrects for the number of fitted parameters.
    """
    rows, channels = 2 * data.lines.size, data.spectrum.shape[1]
    fitted = 2 * poles + data.residual_terms.shape[1] + 2 * poles / channels
    share_left = max(1 - fitted / rows, 0.1)
    median = np.median(np.abs(fit.residual) ** 2, axis=0)
    return np.asarray(np.sqrt(np.maximum(median, np.finfo(float).tiny) / (2 * np.log(2) * share_left)))


class LineNoise(Protocol):
    """Noise with a covariance of the channels at each line."""

    def whiten(self, data: DataBlock) -> DataBlock:
        """Block with the whitening of this noise."""


Noise = RealArray | LineNoise
"""Standard deviation of the real or imaginary part of a line of each channel, (c,), or a covariance at each line."""


def whiten(blocks: list[DataBlock], noise: Sequence[Noise]) -> list[DataBlock]:
    """Blocks in units of their noise."""
    return [
        replace(data, spectrum=data.spectrum / sigma) if isinstance(sigma, np.ndarray) else sigma.whiten(data)
        for data, sigma in zip(blocks, noise, strict=True)
    ]

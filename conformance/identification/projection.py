"""Output error of a set of poles, all linear parameters eliminated (variable projection).

For given poles the residues and the residual terms solve a linear least-squares problem. Its residual is
r = (I - Q Q') x, where Q is an orthonormal basis of the columns Phi of the model. With Kaufman's Jacobian,
-(I - Q Q') dPhi a, the Gauss-Newton matrix at the minimum is the Fisher information of the poles for unknown residues.

References
----------
.. [1] G. H. Golub, V. Pereyra, Separable nonlinear least squares: the variable projection method and its
   applications, Inverse Problems 19 (2003) R1-R26. doi:10.1088/0266-5611/19/2/201
.. [2] E. Balmes, Frequency domain identification of structural dynamics using the pole/residue parametrization,
   IMAC XIV (1996) 540-546.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from pantocheck.conformance.array_types import ComplexArray, IntegerArray, RealArray
from pantocheck.conformance.identification.decay_kernel import (
    decay_kernel,
    drift_columns,
    far_pole_columns,
    kernel_and_derivative,
    real_columns,
    stack_real_imaginary,
)


@dataclass(frozen=True)
class DataBlock:
    """Channels that share one time grid: the sensors of one record, or of repeats of one length.

    Parameters
    ----------
    lines : (k,) ndarray
        Indices of the spectral lines that are used.
    spectrum : (k, c) complex ndarray
        Transforms of the channels at those lines.
    dt : float
        Sampling interval [s].
    n : int
        Number of samples.
    residual_terms : (2 k, r) ndarray
        Columns for the drift and for modes outside the band.
    """

    lines: IntegerArray
    spectrum: ComplexArray
    dt: float
    n: int
    residual_terms: RealArray

    @property
    def omega(self) -> RealArray:
        """Angular frequency of the lines [rad/s]."""
        return np.asarray(2 * np.pi * self.lines / (self.n * self.dt))

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return self.n * self.dt


@dataclass(frozen=True)
class ProjectionFit:
    """Least-squares solution of one block for given poles.

    Parameters
    ----------
    residues : (m, c) complex ndarray
        Residues A at the first sample of the block [unit of the spectrum].
    residual : (k, c) complex ndarray
        Spectrum minus that of poles and residual terms.
    """

    residues: ComplexArray
    residual: ComplexArray


def build_block(
    samples: RealArray, dt: float, low: float, high: float, drift_degree: int = 4, far_degree: int = 3
) -> DataBlock:
    """Transform channels, and build the residual terms of a band.

    Parameters
    ----------
    samples : (n, c) ndarray
        Channels.
    dt : float
        Sampling interval [s].
    low, high : float
        Edges of the band [Hz].
    drift_degree : int
        Degree of the polynomial in time for the drift of the offset.
    far_degree : int
        Degree of the polynomial in frequency for modes outside the band.
    """
    n = samples.shape[0]
    lines = np.arange(max(1, int(np.ceil(low * n * dt))), min(n // 2, int(high * n * dt) + 1), dtype=np.int64)
    spectrum = np.fft.rfft(samples - samples.mean(axis=0), axis=0)[lines]
    omega = 2 * np.pi * lines / (n * dt)
    terms = np.hstack([drift_columns(drift_degree, n, lines), far_pole_columns(omega, far_degree)])
    return DataBlock(lines, np.asarray(spectrum), dt, n, terms)


def pole_columns(poles: ComplexArray, data: DataBlock) -> RealArray:
    """Real columns of the residues of the poles at the lines of a block, (2 k, 2 m)."""
    return real_columns(
        decay_kernel(poles, data.omega, data.dt, data.n), decay_kernel(poles.conj(), data.omega, data.dt, data.n)
    )


def solve_residues(poles: ComplexArray, data: DataBlock) -> ProjectionFit:
    """Solve for the residues of given poles, (m,) [1/s], by least squares."""
    columns = np.hstack([pole_columns(poles, data), data.residual_terms])
    q, r = scipy.linalg.qr(columns, mode="economic", check_finite=False)
    x = stack_real_imaginary(data.spectrum)
    projected = q.T @ x
    m = poles.size
    coefficients = np.linalg.lstsq(r, projected, rcond=1e-13)[0]
    residual = x - q @ projected
    k = data.lines.size
    return ProjectionFit(coefficients[:m] + 1j * coefficients[m : 2 * m], residual[:k] + 1j * residual[k:])


def residue_spread(poles: ComplexArray, data: DataBlock) -> RealArray:
    """Standard deviation of the real or imaginary part of a residue for unit noise and known poles, (m,)."""
    r = scipy.linalg.qr(np.hstack([pole_columns(poles, data), data.residual_terms]), mode="r", check_finite=False)[0]
    inverse = np.linalg.pinv(r[: r.shape[1]])
    variance = np.sum(inverse**2, axis=1)
    m = poles.size
    return np.asarray(np.sqrt((variance[:m] + variance[m : 2 * m]) / 2))


@dataclass(frozen=True)
class NormalEquations:
    """Gauss-Newton normal equations in (decay rate, angular frequency) of every pole.

    Parameters
    ----------
    cost : float
        Sum of squared residuals over all blocks.
    matrix : (2 m, 2 m) ndarray
        J'J of the Jacobian J; decay rates first, then angular frequencies.
    gradient : (2 m,) ndarray
        J'r of the residual r.
    """

    cost: float
    matrix: RealArray
    gradient: RealArray


def build_normal_equations(poles: ComplexArray, blocks: list[DataBlock]) -> NormalEquations:
    """Build the normal equations of the poles over all blocks; the residues are eliminated per channel.

    Parameters
    ----------
    poles : (m,) complex ndarray
        Poles lambda = -delta + i omega [1/s].
    blocks : list of DataBlock
        Data, each channel in units of its noise.
    """
    m = poles.size
    cost, matrix, gradient = 0.0, np.zeros((2 * m, 2 * m)), np.zeros(2 * m)
    for data in blocks:
        value, slope = kernel_and_derivative(poles, data.omega, data.dt, data.n)
        mirrored, mirrored_slope = kernel_and_derivative(poles.conj(), data.omega, data.dt, data.n)
        columns = np.hstack([real_columns(value, mirrored), data.residual_terms])
        q, r = scipy.linalg.qr(columns, mode="economic", check_finite=False)
        x = stack_real_imaginary(data.spectrum)
        projected = q.T @ x
        residual = x - q @ projected
        residues = np.linalg.lstsq(r, projected, rcond=1e-13)[0][: 2 * m]
        derivative = real_columns(slope, mirrored_slope)
        correlation = derivative.T @ residual
        derivative -= q @ (q.T @ derivative)
        cost += float(np.sum(residual**2))
        _accumulate(matrix, gradient, derivative.T @ derivative, correlation, residues)
    return NormalEquations(cost, matrix, gradient)


def _accumulate(
    matrix: RealArray, gradient: RealArray, gram: RealArray, correlation: RealArray, residues: RealArray
) -> None:
    """Add one block: with a = p + i s, d(model)/d(delta) = -(p D1 + s D2) and d(model)/d(omega) = -s D1 + p D2."""
    m = gram.shape[0] // 2
    p, s = residues[:m], residues[m:]
    pp, ps, ss = p @ p.T, p @ s.T, s @ s.T
    g11, g12, g21, g22 = gram[:m, :m], gram[:m, m:], gram[m:, :m], gram[m:, m:]
    matrix[:m, :m] += pp * g11 + ps * g12 + ps.T * g21 + ss * g22
    cross = ps * g11 - pp * g12 + ss * g21 - ps.T * g22
    matrix[:m, m:] += cross
    matrix[m:, :m] += cross.T
    matrix[m:, m:] += ss * g11 - ps.T * g12 - ps * g21 + pp * g22
    c1, c2 = correlation[:m], correlation[m:]
    gradient[:m] += -np.sum(p * c1 + s * c2, axis=1)
    gradient[m:] += np.sum(-s * c1 + p * c2, axis=1)

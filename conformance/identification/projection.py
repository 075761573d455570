"""Output error of a set of poles, with everything linear eliminated (variable projection).

For given poles the residues and the residual terms are the solution of a linear least-squares problem; what is left is
r = (I - Q Q') x with Q an orthonormal basis of the model's columns. Kaufman's Jacobian, -(I - Q Q') dPhi a, makes the
Gauss-Newton matrix at the minimum equal to the Fisher information of the poles with the residues unknown.

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
        Indices of the spectral lines used.
    spectrum : (k, c) complex ndarray
        Transforms of the channels at those lines, each in units of its noise.
    dt : float
        Sampling interval [s].
    n : int
        Number of samples.
    residual_terms : (2 k, r) ndarray
        Columns for drift and for what lies outside the band.
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
        """[s]"""
        return self.n * self.dt


@dataclass(frozen=True)
class ProjectionFit:
    """Least-squares solution of one block for given poles.

    Parameters
    ----------
    residues : (m, c) complex ndarray
        A at the block's first sample, in the unit of the spectrum.
    residual : (k, c) complex ndarray
        What the poles and residual terms leave.
    """

    residues: ComplexArray
    residual: ComplexArray


def build_block(
    samples: RealArray, dt: float, low: float, high: float, drift_degree: int = 4, far_degree: int = 3
) -> DataBlock:
    """Transform of channels and the residual terms that go with the band.

    Parameters
    ----------
    samples : ndarray
        (n, c).
    dt : float
        Sampling interval [s].
    low, high : float
        Edges of the band [Hz].
    drift_degree : int
        Highest polynomial of the offset drift in time.
    far_degree : int
        Highest polynomial over frequency, for modes outside the band.
    """
    n = samples.shape[0]
    lines = np.arange(max(1, int(np.ceil(low * n * dt))), min(n // 2, int(high * n * dt) + 1), dtype=np.int64)
    spectrum = np.fft.rfft(samples - samples.mean(axis=0), axis=0)[lines]
    omega = 2 * np.pi * lines / (n * dt)
    terms = np.hstack([drift_columns(drift_degree, n, lines), far_pole_columns(omega, far_degree)])
    return DataBlock(lines, np.asarray(spectrum), dt, n, terms)


def solve_residues(poles: ComplexArray, data: DataBlock) -> ProjectionFit:
    """Residues and residual of given poles, shape (m,) [1/s]."""
    columns = np.hstack([_pole_columns(poles, data), data.residual_terms])
    q, r = scipy.linalg.qr(columns, mode="economic", check_finite=False)
    x = stack_real_imaginary(data.spectrum)
    projected = q.T @ x
    m = poles.size
    coefficients = np.linalg.lstsq(r, projected, rcond=1e-13)[0]
    residual = x - q @ projected
    k = data.lines.size
    return ProjectionFit(coefficients[:m] + 1j * coefficients[m : 2 * m], residual[:k] + 1j * residual[k:])


def residue_spread(poles: ComplexArray, data: DataBlock) -> RealArray:
    """Standard deviation of a residue's real or imaginary part for unit noise in the lines, poles known, (m,)."""
    r = scipy.linalg.qr(np.hstack([_pole_columns(poles, data), data.residual_terms]), mode="r", check_finite=False)[0]
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
        Sum of squares over all blocks.
    matrix : (2 m, 2 m) ndarray
        J'J; decay rates first, then angular frequencies.
    gradient : (2 m,) ndarray
        J'r.
    """

    cost: float
    matrix: RealArray
    gradient: RealArray


def build_normal_equations(poles: ComplexArray, blocks: list[DataBlock]) -> NormalEquations:
    """Normal equations of the poles over all blocks, residues eliminated per channel.

    Parameters
    ----------
    poles : (m,) complex ndarray
        Lambda = -delta + i omega [1/s].
    blocks : list[DataBlock]
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


def _pole_columns(poles: ComplexArray, data: DataBlock) -> RealArray:
    return real_columns(
        decay_kernel(poles, data.omega, data.dt, data.n), decay_kernel(poles.conj(), data.omega, data.dt, data.n)
    )

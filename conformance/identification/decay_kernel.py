"""Discrete Fourier transform of a truncated free decay, exactly.

A decay x_n = A exp(lambda n dt) + conj., n = 0..N-1, has at the lines w_k = 2 pi k / (N dt) the transform

    X_k = A (1 - exp(lambda N dt)) / (1 - q_k) + conj. part,    q_k = exp((lambda - i w_k) dt)

because w_k N dt is a multiple of 2 pi. Leakage is thus part of the model: no window is needed, and the lines of white
noise stay uncorrelated.
"""

import numpy as np

from pantocheck.conformance.array_types import ComplexArray, IntegerArray, RealArray


def decay_kernel(poles: ComplexArray, omega: RealArray, dt: float, n: int) -> ComplexArray:
    """Transform of exp(lambda n dt), n = 0..N-1, at lines of the record's own grid.

    Parameters
    ----------
    poles : (m,) complex ndarray
        Poles lambda [1/s].
    omega : (k,) ndarray
        Angular frequencies, multiples of 2 pi / (n dt) [rad/s].
    dt : float
        Sampling interval [s].
    n : int
        Number of samples N.

    Returns
    -------
    (k, m) ndarray
        The finite geometric sum, without unit.
    """
    return np.asarray(-np.expm1(poles * (n * dt)) / _one_minus_q(poles, omega, dt))


def kernel_and_derivative(
    poles: ComplexArray, omega: RealArray, dt: float, n: int
) -> tuple[ComplexArray, ComplexArray]:
    """The kernel and its derivative with respect to lambda [s], each (k, m); parameters as in `decay_kernel`."""
    grown = np.exp(poles * (n * dt))
    one_minus_q = _one_minus_q(poles, omega, dt)
    value = (1 - grown) / one_minus_q
    slope = (-n * dt * grown + value * dt * (1 - one_minus_q)) / one_minus_q
    return np.asarray(value), np.asarray(slope)


def _one_minus_q(poles: ComplexArray, omega: RealArray, dt: float) -> ComplexArray:
    """1 - q, (k, m), by expm1: near a pole q is close to one."""
    return np.asarray(-np.expm1((poles[None, :] - 1j * omega[:, None]) * dt))


def real_columns(towards_pole: ComplexArray, towards_conjugate: ComplexArray) -> RealArray:
    """Real least-squares columns of A K(lambda) + conj(A) K(conj lambda).

    Parameters
    ----------
    towards_pole, towards_conjugate : (k, m) complex ndarray
        K (or its derivative) at lambda and at conj lambda.

    Returns
    -------
    (2 k, 2 m) ndarray
        Rows are real parts then imaginary parts; columns multiply Re A of every pole, then Im A of every pole.
    """
    with_real = towards_pole + towards_conjugate
    with_imaginary = 1j * (towards_pole - towards_conjugate)
    return stack_real_imaginary(np.hstack([with_real, with_imaginary]))


def stack_real_imaginary(spectrum: ComplexArray) -> RealArray:
    """(k, ...) complex lines as (2 k, ...) real rows."""
    return np.concatenate([spectrum.real, spectrum.imag])


def drift_columns(degree: int, n: int, lines: IntegerArray) -> RealArray:
    """Transforms of Legendre polynomials 1..degree in time, for a drift of the offset, (2 k, degree), of unit length.

    The offset itself contributes to line 0 only, which is not used.
    """
    t = np.linspace(-1.0, 1.0, n)
    polynomials = np.polynomial.legendre.legvander(t, degree)[:, 1:]
    columns = stack_real_imaginary(np.fft.rfft(polynomials, axis=0)[lines])
    return np.asarray(columns / np.linalg.norm(columns, axis=0))


def far_pole_columns(omega: RealArray, degree: int) -> RealArray:
    """Residual terms of modes outside the band: complex polynomials over it, (2 k, 2 (degree + 1))."""
    middle = (omega[0] + omega[-1]) / 2
    half = max((omega[-1] - omega[0]) / 2, 1e-12)
    polynomials = np.polynomial.legendre.legvander((omega - middle) / half, degree)
    zero = np.zeros_like(polynomials)
    columns = np.block([[polynomials, zero], [zero, polynomials]])
    return np.asarray(columns / np.linalg.norm(columns, axis=0))

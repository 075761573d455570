"""Process noise: ambient motion of the modes beside the noise of the sensors.

Wind drives each mode by a random force, also during the decay. The transform of a driven mode over a finite record is
exactly (T + F_k) / (1 - q_k) at the spectral lines: T holds the motion at both ends, F_k is the transform of the force.
With free T, this is the likelihood of the state-space form (Kalman filter) whose initial state is unknown [1, 2]. The
channels have at each line the covariance

    S_k = diag(floor_k^2) + sum over the modes of g_j |H_j(w_k)|^2 phi_j phi_j',    H_j = delta_j / (i w - lambda_j)

with the ambient power g_j of mode j. Powers and floors have the largest restricted likelihood, by multiplicative
updates [3]; residues, poles, drift and distant modes are projected out. A weak inverse-gamma prior keeps the power of a
mode with few lines near those of its neighbours.

References:
    [1] R. Pintelon, J. Schoukens, G. Vandersteen, Frequency domain system identification using arbitrary signals, IEEE
        Trans. Automatic Control 42 (1997) 1717-1720. doi:10.1109/9.650025
    [2] T. McKelvey, L. Ljung, Frequency domain maximum likelihood identification, IFAC Proc. 30-11 (1997) 725-730.
    [3] H. Zhou, L. Hu, J. Zhou, K. Lange, MM algorithms for variance components models, J. Comput. Graph. Stat. 28
        (2019) 350-361. doi:10.1080/10618600.2018.1529601
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.drops.channel_columns import ChannelColumns
from pantocheck.conformance.drops.decay_kernel import join_conjugates, kernel_and_derivative, real_columns
from pantocheck.conformance.drops.elimination import REFINEMENTS, factor_columns, prepare_elimination
from pantocheck.conformance.drops.projection import DataBlock, pole_columns

PRIOR_FREEDOM = 4.0
"""Degrees of freedom of the prior of a power: shapes at the sensors differ by a factor of about two [-]."""

NEIGHBOUR_REACH = 2 * np.pi * 0.7
"""Distance of the modes whose mean power is the prior [rad/s]."""


@dataclass(frozen=True)
class ProcessNoise:
    """Noise of the c channels of a block: ambient motion of m modes, and a floor."""

    poles: ComplexArray
    """Poles of the driven modes, (m,) [1/s]."""
    shapes: ComplexArray
    """Shapes of the modes at the channels, of unit length in units of the floor, (m, c) [unit of the spectrum]."""
    power: RealArray
    """Ambient power g of each mode at its resonance, over that of the floor, (m,) [-]."""
    freedom: RealArray
    """Effective number of degrees of freedom behind each power, (m,) [-]."""
    nodes: RealArray
    """Angular frequencies of the nodes of the floor, which is linear between them, (b,) [rad/s]."""
    floor: RealArray
    """Standard deviation of the real or imaginary part of a line at the nodes, (b, c) [unit of the spectrum]."""

    def floor_at(self, omega: RealArray) -> RealArray:
        """Floor at angular frequencies, (k, c) [unit of the spectrum]."""
        return np.stack([np.interp(omega, self.nodes, channel) for channel in self.floor.T], axis=1)

    def response(self, omega: RealArray) -> ComplexArray:
        """Responses H of the modes, (k, m) [-]."""
        return np.asarray(-self.poles.real / (1j * omega[:, None] - self.poles))

    def covariance(self, omega: RealArray) -> ComplexArray:
        """Covariance of the channels at each line, (k, c, c) [squared unit of the spectrum]."""
        power = self.power * np.abs(self.response(omega)) ** 2
        ambient = np.einsum("km,mc,md->kcd", power, self.shapes, self.shapes.conj(), optimize=True)
        return np.asarray(ambient + self.floor_at(omega)[:, :, None] ** 2 * np.eye(self.floor.shape[1]))

    def whiten(self, data: DataBlock) -> DataBlock:
        """Block with the whitening of this noise."""
        return replace(data, whitening=np.asarray(np.linalg.inv(np.linalg.cholesky(self.covariance(data.omega)))))

    def levels(self, data: DataBlock, low: float, high: float) -> tuple[RealArray, RealArray]:
        """RMS of ambient motion and of floor of each channel in a band [Hz], (c,) each [unit of the record]."""
        inside = data.omega[(data.omega >= 2 * np.pi * low) & (data.omega <= 2 * np.pi * high)]
        power = self.power * np.sum(np.abs(self.response(inside)) ** 2, axis=0)
        # Real and imaginary part of a line, and that of the negative frequency.
        scale = 2 / data.n
        floor = scale * np.sqrt(np.sum(self.floor_at(inside) ** 2, axis=0))
        return scale * np.sqrt(power @ np.abs(self.shapes) ** 2), floor

    @property
    def prior(self) -> RealArray:
        """Mean power of the neighbours of each mode, by its logarithm, for equal forces on the modes, (m,) [-]."""
        damping = (self.poles.real / self.poles.imag) ** 2
        near = np.abs(self.poles.imag[:, None] - self.poles.imag) < NEIGHBOUR_REACH
        weight = near * (self.freedom + 1e-3)
        level = np.log(np.maximum(self.power * damping, np.finfo(float).tiny))
        return np.asarray(np.maximum(np.exp(weight @ level / weight.sum(axis=1)) / damping, 1e-6))


def update_components(
    noise: ProcessNoise, data: DataBlock, poles: ComplexArray, prior: RealArray, updates: int
) -> ProcessNoise:
    """Increase the restricted likelihood of powers and floor in the lines of a block.

    Args:
        noise: Start values; modes and nodes beyond the lines stay as they are.
        data: Lines, which decays are fitted to.
        poles: Poles of these decays, (m,) [1/s].
        prior: Powers that the prior expects, one for each driven mode [-].
        updates: Number of updates.
    """
    value, slope = kernel_and_derivative(join_conjugates(poles), data.omega, data.dt, data.n)
    columns, derivative = np.hstack([real_columns(value), data.residual_terms]), real_columns(slope())
    inside = (noise.poles.imag >= data.omega[0]) & (noise.poles.imag <= data.omega[-1])
    spread = np.array([np.interp(data.omega, noise.nodes, unit) for unit in np.eye(noise.nodes.size)])
    moved = np.flatnonzero(spread.sum(axis=1) > 0.3 * spread.sum(axis=1).max())
    for _ in range(updates):
        white = noise.whiten(data)
        forms = _compare_forms(white, columns, derivative, poles.size)
        old = noise.power[inside]
        driven = white.weigh_directions(noise.shapes[inside].T * noise.response(data.omega)[:, None, inside])
        found, expected = forms(driven)
        gain = (found.sum(axis=0) + PRIOR_FREEDOM * prior[inside] / old**2) / (
            expected.sum(axis=0) + PRIOR_FREEDOM / old
        )
        power, freedom, floor = noise.power.copy(), noise.freedom.copy(), noise.floor.copy()
        power[inside] = old * np.clip(gain, 0.05, 20)
        freedom[inside] = 0.5 * np.sum((expected * old) ** 2, axis=0)
        own = noise.floor_at(data.omega)[:, :, None] * np.eye(floor.shape[1])
        found, expected = forms(white.weigh_directions(own.astype(np.complex128)))
        for b in moved:
            floor[b] *= np.sqrt(np.clip((spread[b] @ found) / (spread[b] @ expected), 0.1, 10))
        noise = replace(noise, power=power, freedom=freedom, floor=floor)
    return noise


def deviance(noise: ProcessNoise, data: DataBlock, poles: ComplexArray) -> float:
    """Minus twice the logarithm of the restricted likelihood of a noise in a block that decays are fitted to."""
    white = noise.whiten(data)
    assert white.whitening is not None
    elimination = prepare_elimination(white.arrange(np.hstack([pole_columns(poles, data), data.residual_terms])))
    left = elimination.solve(white.signals, 1 + REFINEMENTS)[1]
    of_noise = -4 * np.sum(np.log(np.diagonal(white.whitening, axis1=1, axis2=2).real))
    return float(np.sum(left**2) + of_noise + elimination.log_determinant)


def _compare_forms(
    white: DataBlock, columns: RealArray, derivative: RealArray, m: int
) -> Callable[[ComplexArray], tuple[RealArray, RealArray]]:
    """Function of directions, (k, c, v): quadratic forms of the residual, (k, v), and their expectations."""
    k, c = white.spectrum.shape
    assert white.whitening is not None
    arranged = ChannelColumns(columns, white.whitening)
    elimination = prepare_elimination(arranged)
    coefficients, rest = elimination.solve(white.signals, 1 + REFINEMENTS)
    slopes = white.weigh_slopes(derivative, coefficients.reshape(-1, c)[: 2 * m])
    # The poles are estimated, too: their tangents are projected out with the residues.
    tangents = factor_columns(elimination.solve(slopes, 1)[1])[0] if m else slopes
    residual, basis = (rows[0] + 1j * rows[1] for rows in (x.reshape(2, k, c, -1) for x in (rest, tangents)))
    taken = arranged.spread(elimination.inverse) + basis @ basis.conj().transpose(0, 2, 1)

    def compare(directions: ComplexArray) -> tuple[RealArray, RealArray]:
        found = np.abs((directions.conj().transpose(0, 2, 1) @ residual)[:, :, 0]) ** 2
        lost = np.sum(directions.conj() * (taken @ directions), axis=1).real
        return found, np.maximum(2 * np.sum(np.abs(directions) ** 2, axis=1) - lost, 1e-12)

    return compare
